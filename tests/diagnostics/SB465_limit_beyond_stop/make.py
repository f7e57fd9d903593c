"""A block on a rail, 20 mm from a wall."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    sizes = {"rail": (200, 10, 10), "wall": (10, 10, 30), "block": (20, 10, 10)}
    places = {"rail": (0, 0, 0), "wall": (35, 0, 20), "block": (0, 0, 10.5)}
    children = [
        Occurrence(parts.drawn(name, solids.box(*size)), f"{name}:1", pose(places[name]))
        for name, size in sizes.items()
    ]
    parts.write_step(STEP, Assembly("gate", children))
