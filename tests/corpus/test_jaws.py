"""Single jaws of real arms grip a cube in both engines; with an effort of 0.01 N m they do not."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from stepbot_cli import main

pytestmark = [pytest.mark.slow, pytest.mark.long, pytest.mark.mujoco, pytest.mark.pybullet]
HERE = Path(__file__).parent
SERVO = "dynamics: {damping: 0.02, armature: %s}"


def follower(corpus: Path, folder: Path, effort: str) -> str:
    """The sidecar made by hand, with fitted shapes: hulls of the parts fill its hollow jaws."""
    text = (HERE / "low_cost_robot_follower.robot.yaml").read_text(encoding="utf-8")
    text = text.replace("step: ", f"step: {corpus.as_posix()}/", 1)
    text = text.replace("defaults: {material: pla}", "defaults: {material: pla, collision: auto}", 1)
    limits = "limits: {lower: -3 deg, upper: 100 deg"
    assert text.count(f"{limits}}}") == 1
    return text.replace(f"{limits}}}", f"{limits}, effort: {effort}}}")


def so101(corpus: Path, folder: Path, effort: str) -> str:
    """The corpus's sidecar, with the range of the gripper by the makers' URDF and the servos' data sheet."""
    text = (corpus / "joints" / "so101.robot.yaml").read_text(encoding="utf-8")
    text = text.replace("../so101_assembly.step", (corpus / "so101_assembly.step").as_posix())
    text = text.replace("defaults: {density: 1000}", "defaults: {density: 1000, collision: auto}")
    text = text.replace("joints:", f'joint_defaults: {{"*": {{{SERVO % 0.02}}}}}\njoints:', 1)
    joints = re.findall(r"^  (\w+): \{type", text, re.MULTILINE)
    for joint in joints:
        own = joint == "gripper"
        lower, upper = (-0.174533, 1.74533) if own else (-1.65, 1.65)
        limits = f"limits: {{lower: {lower}, upper: {upper}, effort: {effort if own else '2.94'}, velocity: 4.7}}"
        text = re.sub(rf"(^  {joint}: .*?)limits: \{{.*?\}}", rf"\g<1>{limits}", text, flags=re.MULTILINE)
    return (
        text
        + "actuators:\n"
        + "".join(f"  {j}_servo: {{joint: {j}, kind: position, kp: 17, kv: 0.9}}\n" for j in joints)
    )


def koch(corpus: Path, folder: Path, effort: str) -> str:
    """The draft, with motors, ranges in which the jaw closes, and the servos' effort by their data sheet."""
    step = corpus / "koch_v1_1_external_references" / "Follower_Arm.STEP"
    assert main(["init", str(step), "-o", str(folder / "draft.robot.yaml"), "--force", "--quiet"]) == 0
    text = (folder / "draft.robot.yaml").read_text(encoding="utf-8")
    text = re.sub(r"^step: .*", f'step: "{step.as_posix()}"', text, flags=re.MULTILINE)
    arm, jaw = text.split("  Follower_Gripper_Moving_Part_joint:\n")
    arm = arm.replace("limits: todo", "limits: {lower: -1.6, upper: 1.6, effort: 0.5, velocity: 5}")
    jaw = jaw.replace("limits: todo", f"limits: {{lower: -0.4, upper: 1.6, effort: {effort}, velocity: 5}}")
    text = f"{arm}  Follower_Gripper_Moving_Part_joint:\n{jaw}"
    text = text.replace("\njoints:\n", f'\njoint_defaults: {{"*": {{{SERVO % 0.003}}}}}\njoints:\n', 1)
    joints = re.findall(r"^  (\w+_joint):\n    type: (?!fixed)", text, re.MULTILINE)
    motors = "".join(f"  {j}_motor: {{joint: {j}, kind: position, kp: 6, kv: 0.3}}\n" for j in joints)
    return f"{text.rstrip()}\nactuators:\n{motors}"


def driven(sidecar: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The grip test of a sidecar."""
    path = folder / "arm.robot.yaml"
    path.write_text(sidecar, encoding="utf-8")
    capsys.readouterr()
    main(["drive", str(path), "--test", "grip", "--json"])
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    return document


@pytest.mark.parametrize("sidecar", [follower, so101, koch])
def test_jaw_holds_a_cube(
    sidecar: Callable[[Path, Path, str], str], corpus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """200 g slip by less than 2 mm with the servo's effort; with 0.01 N m, 0.15 N at the tip, they fall."""
    strong = driven(sidecar(corpus, tmp_path, "2.94" if sidecar is so101 else "0.5"), tmp_path, capsys)
    assert [(one["engine"], one["status"]) for one in strong["tests"]] == [("mujoco", "passed"), ("pybullet", "passed")]
    slipping = driven(sidecar(corpus, tmp_path, "0.01"), tmp_path, capsys)
    assert [(one["engine"], one["status"]) for one in slipping["tests"]] == [
        ("mujoco", "failed"),
        ("pybullet", "failed"),
    ]
    failed = [one for one in slipping["diagnostics"] if one["severity"] == "error"]
    assert {one["code"] for one in failed} == {"SB830"}
    assert all("slip of" in one["message"] or "the cube of" in one["message"] for one in failed)
