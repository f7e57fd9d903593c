"""A system without the library that the kernel links to."""

from pathlib import Path

import pytest

from stepbot.runtime.worker import RemoteError
from stepbot.step import reader
from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise RemoteError("ImportError", "libGL.so.1: cannot open shared object file: No such file or directory", "")

    parts.write_box(STEP)
    patch.setattr(reader.Reading, "_result", fail)
    patch.setattr(reader, "_loads", lambda library: True)
