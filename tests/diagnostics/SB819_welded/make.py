"""A crank-rocker linkage closed by a weld in place of a pin."""

from pathlib import Path

import pytest

from tests.diagnostics.transcripts import ROOT


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    folder = ROOT / "robot_library" / "stepbot_four_bar"
    for name in ("four_bar.step", "four_bar.robot.yaml"):
        Path(name).write_bytes((folder / name).read_bytes())
    sidecar = Path("four_bar.robot.yaml")
    text = sidecar.read_text(encoding="utf-8")
    for old, new in (
        ("rocker_pin: {type: revolute", "rocker_pin: {type: fixed"),
        ("auto, axis: -z}", "auto}"),
        ("gains: auto", "kp: 5, kv: 0.05"),  # nothing moves that gains could be computed from
    ):
        assert old in text
        text = text.replace(old, new)
    sidecar.write_text(text, encoding="utf-8", newline="\n")
