"""A part with a line beside its solid."""

from pathlib import Path

import pytest

from robot_library.step_file import Part, write_step
from tests import solids
from tests.unit.step.shapes.test_bodies import edge

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_step(STEP, Part("both", solids.compound(edge(), solids.box(10, 10, 10).shape)))
