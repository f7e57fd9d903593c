"""An arm drawn straight, whose elbow has no pin."""

from pathlib import Path

import pytest

from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_straight_arm(STEP, pin=False)
