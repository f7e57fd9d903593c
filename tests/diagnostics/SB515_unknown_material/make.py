"""A block of PLA with a density of zero, which some programs write by default."""

from pathlib import Path

import pytest

from robot_library.step_file import Part, write_step
from tests import solids
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_step(STEP, Part("block", solids.box(10, 20, 30).shape, "", (), "PLA", 1240.0))
    edited(STEP, (r"POSITIVE_RATIO_MEASURE\(1\.24\)", "POSITIVE_RATIO_MEASURE(0.)"))
