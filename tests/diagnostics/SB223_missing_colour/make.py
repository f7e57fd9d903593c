"""A missing colour."""

from pathlib import Path

import pytest

from tests import parts
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP)
    edited(STEP, (r"#\d+ ?= ?COLOUR_RGB\([^;]*;\n", ""))
