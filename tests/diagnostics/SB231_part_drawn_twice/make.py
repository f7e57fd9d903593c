"""A part with a shape that also refers to another file."""

from pathlib import Path

import pytest

from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_needless_reference(Path("robot.step"))
    parts.write_box(Path("elsewhere.step"))
