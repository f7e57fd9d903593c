"""A solid of two intersecting blocks."""

from pathlib import Path

import pytest

from robot_library.step_file import Part, write_step
from tests import solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    blocks = (solids.box(20, 20, 20), solids.box(10, 10, 10).at(14, 3, 2))
    write_step(STEP, Part("crossing", solids.solid_of(*(solids.faces(block.shape) for block in blocks))))
