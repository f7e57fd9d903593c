"""A hinge, and a process that dies while it searches for overlaps."""

from pathlib import Path

import pytest

from stepbot.runtime.worker import WorkerDied
from stepbot.verification.self_collision.worker import Collider
from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise WorkerDied("killed by SIGKILL", ())

    parts.write_hinge(STEP)
    patch.setattr(Collider, "result", fail)
