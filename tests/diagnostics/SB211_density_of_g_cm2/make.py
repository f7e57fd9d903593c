"""A density in the invalid unit that Open CASCADE writes."""

from pathlib import Path

import pytest

from tests import parts
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP, density=7850.0)
    edited(STEP, (r",-3\.\)", ",2.)"))
