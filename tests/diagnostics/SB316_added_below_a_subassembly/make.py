"""A part added to a subassembly that a link has as a whole."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever(sidecar=LEVER.replace("[beam, motor]", "[arm]")).copy(
        "motor:1", "spare:1", pose((0, -40, 0))
    ).write(Path("lever.step"))
