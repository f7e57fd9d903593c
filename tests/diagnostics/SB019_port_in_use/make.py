"""A port that is in use, whether it is on this machine or not."""

import errno
import os

import pytest

from stepbot.serving import local_server


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise OSError(errno.EADDRINUSE, os.strerror(errno.EADDRINUSE))

    patch.setattr(local_server, "_Server", fail)
