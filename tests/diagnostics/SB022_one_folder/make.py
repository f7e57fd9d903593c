"""A hinge, and a folder into which another robot was converted."""

from pathlib import Path

import pytest

from stepbot.runtime.output import write_atomically
from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_hinge(Path("robot.step"))
    write_atomically({"lever.urdf": b"<robot/>", "report.json": b"{}"}, Path("out"))
