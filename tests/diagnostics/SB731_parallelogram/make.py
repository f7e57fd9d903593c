"""A gripper of two parallelograms."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "robotiq_2f85"
    for name in ("2f85.step", "2f85.robot.yaml"):
        Path(name).write_bytes((folder / name).read_bytes())
