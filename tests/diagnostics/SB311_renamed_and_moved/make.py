"""A part renamed and moved."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever().rename({"motor": "XL430", "motor:1": "XL430:1"}).move("XL430:1", pose((0, 5, 0))).write(
        Path("lever.step")
    )
