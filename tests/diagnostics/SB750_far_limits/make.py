"""A robot of the library whose shoulder turns further than a hinge's stops."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_arm2"
    Path("arm2.step").write_bytes((folder / "arm2.step").read_bytes())
    sidecar = (folder / "arm2.robot.yaml").read_text(encoding="utf-8")
    assert "lower: -170 deg, upper: 170 deg" in sidecar
    Path("arm2.robot.yaml").write_text(
        sidecar.replace("lower: -170 deg, upper: 170 deg", "lower: -200 deg, upper: 200 deg"), encoding="utf-8"
    )
