"""A part with a Russian name in Windows' code page."""

from pathlib import Path

import pytest

from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.draw(STEP, parts.drawn("TO BE NAMED", solids.box(10, 20, 30)))
    STEP.write_bytes(STEP.read_bytes().replace(b"TO BE NAMED", "Корпус №1".encode("cp1251")))
