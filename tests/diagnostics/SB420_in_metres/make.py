"""A box of 100 m in a file that declares metres instead of millimetres."""

from pathlib import Path

import pytest

from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP, unit="m", size=(100000.0, 60000.0, 40000.0))
