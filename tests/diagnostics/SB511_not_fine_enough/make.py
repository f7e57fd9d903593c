"""A sphere, and a limit of faces below that of the requested mesh."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import ReadOptions
from stepbot.step.shapes import exact
from tests import parts
from tests.unit.step.in_process import read_here

STEP = Path("robot.step")


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    parts.write_sphere(STEP)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exact, "MAX_MEASURING_FACES", 5000)
        read_here(STEP, diagnostics, ReadOptions(refine_mass_to=1e-6))
