"""A part whose shape is in the file, and which refers to another file nevertheless."""

from pathlib import Path

import pytest

from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_needless_reference(Path("robot.step"))
    parts.write_box(Path("elsewhere.step"))
