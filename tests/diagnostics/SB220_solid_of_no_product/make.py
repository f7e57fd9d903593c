"""A file with a solid that is not part of a product."""

from pathlib import Path

import pytest

from robot_library.step_file import Part, write_step
from tests import solids
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    pair = solids.compound(solids.box(10, 20, 30).shape, solids.box(5, 5, 5).at(40, 0, 0).shape)
    write_step(STEP, Part("pair", pair))
    edited(STEP, (r"(SHAPE_REPRESENTATION\('',\(#\d+,#\d+),#\d+", r"\1"))
