"""Motors of the catalogue in a sidecar: the figures reach files and reports, with their sources; `stepbot motors`."""

import json
import re
from math import pi
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.parts import write_hinge

from .conftest import Stepbot

SIDECAR = """version: 1
robot: hinge
step: hinge.step
step_density: ignore
defaults: {{density: 1000}}
root: {{up: x}}
links:
  plate: {{parts: [plate]}}
  arm: {{parts: [arm]}}
joints:
  hinge: {{type: revolute, parent: plate, child: arm, limits: {{lower: -1, upper: 1}}}}
actuators:
  hinge: {actuator}
"""


@pytest.fixture
def hinge(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the drawing of a hinge."""
    write_hinge(tmp_path / "hinge.step")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "hinge.robot.yaml"


@pytest.mark.slow
def test_mujoco_gets_the_figures_of_the_motor(hinge: Path, stepbot: Stepbot) -> None:
    """MuJoCo compiles the numbers that the maker's simulation files of SO-101 have for this servo, within 2 %."""
    mujoco = pytest.importorskip("mujoco")
    hinge.write_text(SIDECAR.format(actuator="{motor: STS3215-7.4V}"), encoding="utf-8")
    run = stepbot("convert", hinge.name, "--no-verify", "-v")
    assert run.code == 0
    assert "damping 0.60769 N*m*s/rad: derived: viscous_damping + back_emf_damping; identified: Rhoban" in run.out
    model = mujoco.MjModel.from_xml_path("hinge/hinge.xml")
    joint = model.joint("hinge")
    assert float(joint.damping[0]) == pytest.approx(0.60, rel=0.02)
    assert float(joint.frictionloss[0]) == pytest.approx(0.052, rel=0.02)
    assert float(joint.armature[0]) == pytest.approx(0.028, rel=0.02)
    assert float(model.actuator("hinge").gainprm[0]) == pytest.approx(17.8)
    assert 1.9 < float(model.jnt_actfrcrange[0][1]) < 3.36
    (actuator,) = json.loads(Path("hinge/report.json").read_text(encoding="utf-8"))["robot"]["actuators"]
    sources = {one["quantity"]: one["source"] for one in actuator["motor"]["figures"]}
    assert sources.keys() == {"effort", "velocity", "armature", "friction", "damping", "kp"}
    assert all(sources.values())
    *_, slow = actuator["motor"]["doubts"]
    assert len(actuator["motor"]["doubts"]) == 4
    # MuJoCo's hinge with the whole effort, without gravity, stops and load, turns no faster than the stated speed.
    stated = float(re.search(r"at (\S+) rad/s, 56 % of the velocity limit of 5.454 rad/s", slow)[1])  # type: ignore[index]
    model.opt.gravity[:], model.jnt_limited[:] = 0.0, 0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION | mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    for _ in range(int(2.0 / model.opt.timestep)):
        data.qfrc_applied[0] = 1.912
        mujoco.mj_step(model, data)
    assert data.qvel[0] == pytest.approx(stated, rel=2e-3)
    assert 'effort="1.912" velocity="5.454"' in Path("hinge/hinge.urdf").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "mass"),
    [("", 0.0572), ("parts: {plate: {mass: 60 g}}\n", 0.06), ("parts: {plate: {density: 300}}\n", None)],
)
def test_the_part_of_a_motor_has_its_mass_if_nothing_else_gives_one(
    hinge: Path, stepbot: Stepbot, more: str, mass: float | None
) -> None:
    """The catalogue's mass takes the place of a default density, and of nothing else."""
    hinge.write_text(SIDECAR.format(actuator="{motor: XL430-W250, part: plate}") + more, encoding="utf-8")
    assert "warning[SB524]" in stepbot("check", hinge.name, "--step").out
    assert stepbot("convert", hinge.name, "--no-verify").code == 0
    plate = json.loads(Path("hinge/report.json").read_text(encoding="utf-8"))["robot"]["links"][0]
    assert plate["mass"] == pytest.approx(
        mass if mass is not None else 300 * (80 * 80 * 10 + pi * 2000) * 1e-9, rel=1e-3
    )


@pytest.mark.slow
def test_a_change_of_the_users_motors_is_a_change(hinge: Path, stepbot: Stepbot) -> None:
    """No cached result of an earlier file of motors is taken."""
    own = "motors:\n  mine: {{kind: servo, source: measured, stall_torque: {}, no_load_speed: 6}}\n"
    hinge.write_text(SIDECAR.format(actuator="{motor: mine}") + "motors: own.yaml\n", encoding="utf-8")
    for torque in ("1.5", "2.5"):
        Path("own.yaml").write_text(own.format(torque), encoding="utf-8")
        assert stepbot("convert", hinge.name, "--no-verify").code == 0
        assert f'effort="{torque}"' in Path("hinge/hinge.urdf").read_text(encoding="utf-8")


def test_motors_are_listed_and_shown(tmp_path: Path, stepbot: Stepbot) -> None:
    """All are listed; one has its figures with sources, other sources and doubts; a family has all its members."""
    listed = stepbot("motors").out
    assert len(listed.splitlines()) >= 144
    shown = stepbot("motors", "sts3215-7.4v").out
    assert "never filled in" in shown
    assert "doubt: armature" in shown
    family = json.loads(stepbot("motors", "STS3215", "--json").out)["motors"]
    assert list(family) == ["STS3215-7.4V", "STS3215-12V", "STS3215-C044", "STS3215-C046"]
    run = stepbot("motors", "XL43O-W250")
    assert run.code == 2
    assert "XL430-W250" in run.err
    own = tmp_path / "own.yaml"
    own.write_text("motors: {mine: {kind: servo, source: bench, mass: 12 g}}\n", encoding="utf-8")
    assert "bench" in stepbot("motors", "mine", "--own", str(own)).out
    own.write_text("motors: {mine: {kind: servo, mass: 12 g}}\n", encoding="utf-8")
    assert stepbot("motors", "mine", "--own", str(own)).code == 1


@pytest.mark.long
def test_a_draft_proposes_the_servos_of_so101(tmp_path: Path, corpus: Path, stepbot: Stepbot) -> None:
    """Each of the six joints has its servo, named by the family, since the drawing does not say which member it is."""
    sidecar = tmp_path / "so101.robot.yaml"
    assert stepbot("init", str(corpus / "so101_assembly.step"), "-o", str(sidecar)).code == 0
    lines = [line for line in sidecar.read_text(encoding="utf-8").splitlines() if "motor: STS3215" in line]
    assert len(lines) == 6
    assert all("REVIEW" in line and 'part: "STS3215_03a:' in line for line in lines)
    assert "STS3215-12V" in lines[0]

    # With a member of the family, six joints have the figures of the maker's simulation files: 17.8 and 998 N m/rad
    # there, 2.94 and 3.35 N m.
    draft = re.sub(r"(?m)^# ( *)(?=actuators:|.*motor: STS3215)", r"\1", sidecar.read_text(encoding="utf-8"))
    for member, gains, efforts in (("7.4V", (17.4, 18.2), (1.9, 1.95)), ("12V", (500.0, 2000.0), (2.93, 2.95))):
        sidecar.write_text(draft.replace("motor: STS3215,", f"motor: STS3215-{member},"), encoding="utf-8")
        out = tmp_path / member
        assert stepbot("convert", str(sidecar), "-f", "mjcf", "-o", str(out), "--no-verify").code in (0, 1)
        model = ET.parse(out / "so101.xml").getroot()
        driven = {one.get("joint"): one for one in model.iterfind("actuator/position")}
        joints = [one for one in model.iter("joint") if one.get("name") in driven]
        assert len(joints) == len(driven) == 6
        for joint in joints:
            servo = driven[joint.get("name")]
            friction, armature, damping = (float(joint.get(key)) for key in ("frictionloss", "armature", "damping"))
            assert (friction, armature) == pytest.approx((0.052, 0.028), rel=0.02)
            assert damping == pytest.approx(0.60, rel=0.05)
            assert gains[0] < float(servo.get("kp")) < gains[1]
            assert efforts[0] < float(servo.get("forcerange").split()[1]) < efforts[1]


@pytest.mark.parametrize(
    ("file", "remedy"),
    [
        ("arm.urdf", "`set: {actuators: {a: {joint: j1, motor: STS3215-7.4V}}}` of module 'arm'"),
        ("arm.robot.yaml", "name the motor in the module's own file"),
    ],
)
def test_a_motor_for_a_joint_of_a_module_has_a_remedy(file: str, remedy: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """A description has no motors, so that `set` adds one; a sidecar states them itself."""
    sidecar = tmp_path / "whole.robot.yaml"
    actuators = "{a: {joint: arm/j1, motor: STS3215-7.4V}}"
    sidecar.write_text(f"version: 1\nrobot: r\nmodules: {{arm: {{file: {file}}}}}\nactuators: {actuators}\n", "utf-8")
    run = stepbot("check", str(sidecar))
    assert run.code == 1
    assert "SB148" in run.err + run.out
    assert remedy in run.err + run.out


def test_play_of_a_linear_drive_is_a_length(stepbot: Stepbot) -> None:
    """The backlash of a linear drive is in metres, that of a servo in radians."""
    assert re.search(r"^backlash +0\.00025 m  ", stepbot("motors", "L16-35").out, re.MULTILINE)
    assert re.search(r"^backlash +\S+ rad  ", stepbot("motors", "XM430-W350").out, re.MULTILINE)
