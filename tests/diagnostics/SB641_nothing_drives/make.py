"""An arm whose sidecar states no actuators."""

import re
from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_arm2"
    Path("arm2.step").write_bytes((folder / "arm2.step").read_bytes())
    text = (folder / "arm2.robot.yaml").read_text(encoding="utf-8")
    passive = re.sub(r"\nactuators:\n(?:  .*\n)+", "\n", text)
    assert passive != text
    Path("arm2.robot.yaml").write_text(passive, encoding="utf-8", newline="\n")
