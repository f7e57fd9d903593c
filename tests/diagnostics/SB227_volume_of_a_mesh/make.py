"""A mesh whose file states a volume."""

from pathlib import Path

import pytest

from stepbot.step.assembly import Quantity
from tests import parts
from tests.stating import Stating

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_tessellated(STEP)
    file = Stating(STEP)
    file.measure(file.definition("scan"), Quantity.VOLUME, 60_000.0)
    file.write()
