"""UTF-8 declared as cp1252."""

from pathlib import Path

import pytest

from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.draw(STEP, parts.drawn("TO BE NAMED", solids.box(10, 20, 30)))
    STEP.write_bytes(STEP.read_bytes().replace(b"TO BE NAMED", "é".encode()))
