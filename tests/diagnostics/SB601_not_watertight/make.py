"""A sphere with an open mesh, injected: no known drawing causes it."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.shapes import bodies
from tests import parts
from tests.unit.step.in_process import read_here

STEP = Path("robot.step")


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    parts.write_sphere(STEP)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bodies, "is_watertight", lambda faces: False)
        read_here(STEP, diagnostics)
