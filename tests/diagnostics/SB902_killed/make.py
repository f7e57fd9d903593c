"""A kernel process killed by the system, as when memory runs out."""

from pathlib import Path

import pytest

from stepbot.runtime.worker import WorkerDied
from stepbot.step import reader
from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise WorkerDied("killed by SIGKILL", ())

    parts.write_box(STEP)
    patch.setattr(reader.Reading, "_result", fail)
