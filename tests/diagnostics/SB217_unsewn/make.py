"""A solid whose faces share no edges."""

from pathlib import Path

import pytest

from robot_library.step_file import Part, write_step
from tests import solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_step(STEP, Part("block", solids.unsewn(solids.box(30, 30, 20).shape)))
