"""A part moved and rotated."""

from math import radians
from pathlib import Path

import pytest

from robot_library.moments import pose, turn
from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    revision = write_locked_lever().move(
        "motor:1", pose((0, 5, 0)) @ pose((0, 60, 26), turn("z", radians(2.0))) @ pose((0, -60, -26))
    )
    revision.write(Path("lever.step"))
