"""A robot of the library."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_arm2"
    for name in ("arm2.step", "arm2.robot.yaml"):
        Path(name).write_bytes((folder / name).read_bytes())
