"""A sphere whose mesh lacks a face, injected: the mesher fails on no known drawing."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.step.shapes import bodies
from tests import parts
from tests.unit.step.in_process import read_here

STEP = Path("robot.step")


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    parts.write_sphere(STEP)
    with pytest.MonkeyPatch.context() as patch:
        mesh = bodies.fitted
        patch.setattr(bodies, "fitted", lambda *arguments: replace(mesh(*arguments), missing=(1,)))
        read_here(STEP, diagnostics)
