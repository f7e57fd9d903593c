"""A sphere on whose volume two integrations differ, injected: no small drawing causes it."""

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
        estimate = bodies.estimated
        patch.setattr(bodies, "estimated", lambda *given, **more: replace(estimate(*given, **more), error=0.04))
        read_here(STEP, diagnostics)
