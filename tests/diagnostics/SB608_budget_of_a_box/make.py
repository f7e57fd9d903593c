"""A hinge."""

from pathlib import Path

import pytest

from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_hinge(Path("robot.step"))
