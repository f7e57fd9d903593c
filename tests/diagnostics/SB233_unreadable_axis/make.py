"""A part whose axes the kernel fails to find."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from tests import parts
from tests.unit.step.in_process import read_here

STEP = Path("part.step")


def find(diagnostics: Diagnostics) -> None:
    """Read a part while the search for axes fails."""

    def fail(*_: object) -> None:
        raise ValueError("on purpose")

    parts.write_box(STEP)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("stepbot.step.shapes.bodies.axis_faces", fail)
        read_here(STEP, diagnostics)
