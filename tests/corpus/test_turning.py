"""A base that `init` drafts drives and turns as its wheels say, once it has motors."""

import json
from pathlib import Path

import pytest

from stepbot_cli import main

MOTORS = """
actuators:
  wheel_joint: {kind: velocity, gains: auto, limits: {effort: 0.2 N*m, velocity: 20 rad/s}}
  wheel_2_joint: {kind: velocity, gains: auto, limits: {effort: 0.2 N*m, velocity: 20 rad/s}}
"""


@pytest.mark.long
@pytest.mark.pybullet
def test_a_drafted_base_drives_straight_and_turns(
    corpus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two wheels and a body that leans on its lowest part: 2 m within 1 %, 360 degrees within 2 %, in both engines."""
    sidecar = tmp_path / "pimouse.robot.yaml"
    assert main(["init", str(corpus / "assemblies" / "pimouse.step"), "-o", str(sidecar)]) == 0
    sidecar.write_text(sidecar.read_text(encoding="utf-8") + MOTORS, encoding="utf-8")
    capsys.readouterr()
    assert main(["drive", str(sidecar), "--test", "roll,turn", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    seen = {(one["test"], one["engine"], one["status"]) for one in document["tests"]}
    assert seen == {(test, engine, "passed") for test in ("roll", "turn") for engine in ("mujoco", "pybullet")}
