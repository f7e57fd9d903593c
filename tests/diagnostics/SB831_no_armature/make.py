"""A motor that is far too stiff for its joint."""

from pathlib import Path

import pytest

from tests.unit.driving.workbench import VERTICAL, one_joint, written

OUT = Path("out")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    written(one_joint(VERTICAL, 1e14, 1.0, 1e30), OUT)
