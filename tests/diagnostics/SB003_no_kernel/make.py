"""An installation without the geometry kernel."""

from pathlib import Path

import pytest

from stepbot.runtime.worker import RemoteError
from stepbot.step import reader
from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise RemoteError("ModuleNotFoundError", "No module named 'OCP'", "")

    parts.write_box(STEP)
    patch.setattr(reader.Reading, "_result", fail)
