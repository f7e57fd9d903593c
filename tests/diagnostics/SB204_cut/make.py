"""Half of a file."""

from pathlib import Path

import pytest

from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP)
    STEP.write_bytes(STEP.read_bytes()[: STEP.stat().st_size // 2])
