"""A hinge, and the MJCF of an earlier conversion."""

from pathlib import Path

import pytest

from stepbot.runtime.output import write_atomically
from tests import parts


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_hinge(Path("robot.step"))
    write_atomically({"hinge.xml": b"<mujoco/>"}, Path("out"))
