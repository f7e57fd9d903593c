"""A mesh with a stated volume."""

from pathlib import Path

import pytest

from stepbot.step.assembly import Quantity
from tests import parts
from tests.step_editor import StepEditor

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_tessellated(STEP)
    file = StepEditor(STEP)
    file.measure(file.definition("scan"), Quantity.VOLUME, 60_000.0)
    file.write()
