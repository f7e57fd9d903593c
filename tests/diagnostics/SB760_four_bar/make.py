"""A crank-rocker linkage."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_four_bar"
    for name in ("four_bar.step", "four_bar.robot.yaml"):
        Path(name).write_bytes((folder / name).read_bytes())
