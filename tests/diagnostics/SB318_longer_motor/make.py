"""A part with another shape."""

from pathlib import Path

import pytest

from tests.revisions import write_locked_lever
from tests.solids import box


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever().reshape("motor", box(20, 30, 22).shape).write(Path("lever.step"))
