"""Pin and bore moved together."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    revision = write_locked_lever().move("base:1", pose((5, 0, 0))).move("beam:1", pose((5, 0, 0)))
    revision.write(Path("lever.step"))
