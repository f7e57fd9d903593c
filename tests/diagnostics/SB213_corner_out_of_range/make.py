"""A mesh whose triangles refer to a missing corner."""

from pathlib import Path

import pytest

from tests import parts
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_tessellated(STEP)
    edited(STEP, (r"(TRIANGULATED_FACE\(.*?\(\()\d+,", r"\g<1>2147483647,"))
