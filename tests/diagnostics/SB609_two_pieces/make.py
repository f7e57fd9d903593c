"""An arm whose parts are one link."""

from pathlib import Path

import pytest

from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_straight_arm(Path("robot.step"))
