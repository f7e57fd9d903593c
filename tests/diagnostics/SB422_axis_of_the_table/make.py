"""An arm whose shaft is along y of the STEP, and so along z of the joint's frame."""

from math import pi
from pathlib import Path

import pytest

from robot_library.moments import pose, turn
from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_turntable(Path("robot.step"), pose((0, 0, 0), turn("x", -pi / 2)))
