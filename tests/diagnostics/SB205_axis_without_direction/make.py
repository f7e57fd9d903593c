"""A shape with a transformation whose axis is zero."""

from pathlib import Path

import pytest

from tests.unit.step.exchange.test_operators import X, Y, write_mapped

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_mapped(STEP, (X, Y, "(0.,0.,0.)"), "1.")
