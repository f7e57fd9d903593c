"""A box of 240 cm^3 with a stated volume of 250 cm^3."""

from pathlib import Path

import pytest

from stepbot.step.assembly import Quantity
from tests import parts
from tests.step_editor import StepEditor

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP, (100.0, 60.0, 40.0))
    file = StepEditor(STEP)
    file.measure(file.definition("block"), Quantity.VOLUME, 250_000.0)
    file.write()
