"""An arm under a licence whose text stepbot does not have."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_arm2"
    Path("arm2.step").write_bytes((folder / "arm2.step").read_bytes())
    text = (folder / "arm2.robot.yaml").read_text(encoding="utf-8")
    other = text.replace("license: Apache-2.0", "license: CC-BY-4.0")
    assert other != text
    Path("arm2.robot.yaml").write_text(other, encoding="utf-8", newline="\n")
