"""An arm with one finger, which closes on the palm."""

import re
from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_arm2"
    Path("arm2.step").write_bytes((folder / "arm2.step").read_bytes())
    text = (folder / "arm2.robot.yaml").read_text(encoding="utf-8")
    one_jaw = re.sub(r"\n  right_finger: .*|\n  finger_mirror:\n(?:    .*\n)+", "", text)
    assert one_jaw != text
    Path("arm2.robot.yaml").write_text(one_jaw, encoding="utf-8", newline="\n")
