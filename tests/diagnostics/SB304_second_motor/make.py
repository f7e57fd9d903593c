"""A part was added to a subassembly whose parts are listed one by one."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    sidecar = LEVER.replace("motor", "'motor:1'")
    write_locked_lever(sidecar=sidecar).copy("motor:1", "spare:1", pose((0, -40, 0))).write(Path("lever.step"))
