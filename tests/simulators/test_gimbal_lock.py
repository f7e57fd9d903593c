"""The gimbal lock of three URDF hinges for a ball joint is no error, and hides no other divergence."""

from pathlib import Path

import pytest

from stepbot.engines.observation import Observation, Request
from tests.command_line import stepbot
from tests.parts import Assembly, Occurrence, box, draw, drawn
from tests.processes import call_isolated

pytestmark = pytest.mark.slow

SIDECAR = """version: 1
robot: pendulum
step: pendulum.step
defaults: {density: 1000 kg/m^3}
links: {base: {parts: [base]}, arm: {parts: [arm]}}
joints:
  shoulder: {type: ball, parent: base, child: arm, origin: {xyz: [30 mm, 0, 0]}}
"""
LIGHT = (
    "<link name='{name}'><inertial><mass value='0'/>"
    "<inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial></link>"
)
HEAVY = (
    "<link name='{name}'><inertial><origin xyz='0.1 0.02 0'/><mass value='0.1'/>"
    "<inertia ixx='1e-4' ixy='0' ixz='0' iyy='3e-4' iyz='0' izz='3e-4'/></inertial></link>"
)
HINGE = (
    "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/>{origin}"
    "<axis xyz='{axis}'/><dynamics damping='{damping}'/></joint>"
)


def _urdf(folder: Path, roll_damping: float = 0.0, wrist_damping: float = 0.0, between: str = LIGHT) -> Path:
    """A pendulum on three hinges that intersect in a point, with a second one below it."""
    at_wrist = "<origin xyz='0.2 0 0'/>"
    parts = [
        HEAVY.format(name="base"),
        *(between.format(name=name) for name in ("a", "b")),
        *(HEAVY.format(name=name) for name in ("arm", "hand")),
        HINGE.format(name="yaw", parent="base", child="a", axis="0 0 1", damping=0, origin=""),
        HINGE.format(name="pitch", parent="a", child="b", axis="0 1 0", damping=0, origin=""),
        HINGE.format(name="roll", parent="b", child="arm", axis="1 0 0", damping=roll_damping, origin=""),
        HINGE.format(name="wrist", parent="arm", child="hand", axis="0 1 0", damping=wrist_damping, origin=at_wrist),
    ]
    path = folder / "pendulum.urdf"
    path.write_text(f"<robot name='pendulum'>{''.join(parts)}</robot>", encoding="utf-8")
    return path


def _seen(path: Path) -> Observation:
    seen = call_isolated("stepbot.engines.mujoco.observer:observe", Request(str(path), "urdf"))
    assert isinstance(seen, Observation)
    return seen


def test_a_ball_joint_in_urdf_is_proven(tmp_path: Path) -> None:
    """A pendulum on a ball joint falls through gimbal lock; the conversion passes with a note."""
    arm = box(200, 20, 10).at(130, 0, 0) + box(20, 60, 10).at(130, 40, 0)
    children = [Occurrence(drawn("base", box(40, 40, 40)), "base:1"), Occurrence(drawn("arm", arm), "arm:1")]
    draw(tmp_path / "pendulum.step", Assembly("pendulum", children))
    (tmp_path / "pendulum.robot.yaml").write_text(SIDECAR, encoding="utf-8")
    run = stepbot("convert", "pendulum.robot.yaml", "-f", "urdf", "--json", cwd=tmp_path)
    assert run.code == 0, run.err + run.out
    assert "'shoulder_yaw', 'shoulder_pitch', 'shoulder_roll' approach gimbal lock" in run.out


def test_hinges_in_a_file_of_others(tmp_path: Path) -> None:
    """A fall through gimbal lock stays finite, and a note describes the reversal."""
    seen = _seen(_urdf(tmp_path))
    assert seen.simulation_finite
    assert any("hinges 'yaw', 'pitch', 'roll' approach gimbal lock" in note for note in seen.notes)
    assert seen.warnings == ()


@pytest.mark.parametrize("joint", ["roll_damping", "wrist_damping"])
def test_what_diverges_is_reported(joint: str, tmp_path: Path) -> None:
    """A joint with negative damping is reported as diverged, within the hinges and below them."""
    path = _urdf(tmp_path, roll_damping=-5.0) if joint == "roll_damping" else _urdf(tmp_path, wrist_damping=-5.0)
    assert _seen(path).simulation_finite is False


def test_hinges_with_mass_between_are_left_alone(tmp_path: Path) -> None:
    """A wrist with massive links between its hinges has a regular mass matrix and no note."""
    seen = _seen(_urdf(tmp_path, between=HEAVY))
    assert seen.simulation_finite
    assert not any("gimbal" in note for note in seen.notes)
