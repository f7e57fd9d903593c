"""A file system without locks."""

import errno
import fcntl
import os
from pathlib import Path

import pytest

from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    parts.write_hinge(STEP)
    patch.setattr(fcntl, "flock", fail)
