"""Two coaxial square plates on a base, which turn on their own, and overlap by 2 mm at any angle."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    pieces = [
        (parts.drawn("base", solids.box(10, 10, 10)), (-100, 0, 0)),
        (parts.drawn("lower", solids.box(40, 40, 8)), (0, 0, 0)),
        (parts.drawn("upper", solids.box(40, 40, 8)), (0, 0, 6)),
    ]
    children = [Occurrence(piece, f"{piece.name}:1", pose(place)) for piece, place in pieces]
    parts.write_step(STEP, Assembly("plates", children))
