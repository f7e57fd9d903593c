"""The first of equal nameless parts was removed, so the numbers of the others have changed."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    sidecar = LEVER.replace("[beam, motor]", '[beam, motor, "M3#4"]')
    write_locked_lever(sidecar=sidecar).remove_number("M3", 1).write(Path("lever.step"))
