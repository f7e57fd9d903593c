"""A pin in a bore that is 1 mm wider; both parts touch on the plate."""

from pathlib import Path

import pytest

from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    plate = solids.box(80, 80, 10) + solids.cylinder(10, 20).at(0, 0, 5)
    arm = solids.box(40, 120, 10).at(0, 45, 10) - solids.cylinder(10.5, 10).at(0, 0, 5)
    children = [
        Occurrence(parts.drawn("plate", plate, density=7850.0), "plate:1"),
        Occurrence(parts.drawn("arm", arm, density=2700.0), "arm:1"),
    ]
    parts.write_step(STEP, Assembly("hinge", children))
