"""A sphere, and a limit of faces that it exceeds."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import MeshTolerance, ReadOptions
from stepbot.step.shapes import tessellation
from tests import parts
from tests.unit.step.in_process import read_here

STEP = Path("robot.step")


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    parts.write_sphere(STEP)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tessellation, "MAX_FACES", 2000)
        read_here(STEP, diagnostics, ReadOptions(tolerance=MeshTolerance(1e-5, angle=0.02)))
