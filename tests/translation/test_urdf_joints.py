"""URDFs with joints and links that engines represent differently: floating and planar joints, links without mass."""

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.jobs.incremental import convert
from stepbot.pipeline import writing
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.report.robot import Status
from stepbot.robot.model import Base, Joint, JointKind, Link, Robot
from stepbot.robot.multi_dof import split
from stepbot.verification.files import verify_files

pytestmark = pytest.mark.xdist_group("joints of others")

_BODY = """<inertial><origin xyz="{0} 0.02 -0.01"/><mass value="1.5"/>
  <inertia ixx="0.02" ixy="0.001" ixz="-0.002" iyy="0.021" iyz="0.0005" izz="0.024"/></inertial>"""


def _link(name: str, x: float = 0.1) -> str:
    return f'<link name="{name}">{_BODY.format(x)}</link>'


def _joint(name: str, kind: str, parent: str, child: str, more: str = "") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.2 0.7"/>{more}</joint>'
    )


HINGE = '<axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="10" velocity="2"/>'
STAGE = (
    '<robot name="stage"><link name="base_footprint"/>'
    + _link("base_link")
    + _link("table")
    + _link("arm")
    + _link("drone")
    + '<link name="tool0"/>'
    + _joint("base", "fixed", "base_footprint", "base_link")
    + _joint("table", "planar", "base_link", "table", '<axis xyz="2 -1 2"/><limit effort="1" velocity="1"/>')
    + _joint("hinge", "revolute", "table", "arm", HINGE)
    + _joint("free", "floating", "base_link", "drone")
    + _joint("tool", "fixed", "arm", "tool0", '<axis xyz="0 0 0"/>')
    + "</robot>"
)
"""A stage with a planar joint and a free body, and links without mass as ROS has them at both ends."""
DRONE = (
    '<robot name="drone"><link name="world"/>'
    + _link("body")
    + _link("arm")
    + _joint("free", "floating", "world", "body")
    + _joint("hinge", "revolute", "body", "arm", HINGE)
    + "</robot>"
)


def _converted(folder: Path, text: str, *formats: str) -> Conversion:
    path = folder / "source.urdf"
    path.write_text(text, encoding="utf-8")
    return convert(path, Options(folder / "out", formats=formats))


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Conversion]:
    """The stage in all formats that have kinematics."""
    pytest.importorskip("pxr")
    folder = tmp_path_factory.mktemp("stage")
    return folder, _converted(folder, STAGE, "urdf", "sdf", "mjcf", "usd")


@pytest.mark.slow
def test_planar_and_floating_joints_convert_with_proof(stage: tuple[Path, Conversion]) -> None:
    """Every written file has the joints of the source, which engines read with single joints in their place."""
    folder, conversion = stage
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    checks = [check for check in conversion.report.checks if check.against == "source.urdf (mujoco)"]
    passed = {(check.file, check.quantity) for check in checks if check.status is Status.PASSED}
    for file in ("stage.urdf", "stage.sdf", "stage.xml", "stage.usda"):
        assert {(file, "joints"), (file, "axes"), (file, "mass"), (file, "poses")} <= passed
    for file in ("stage.urdf", "stage.sdf", "stage.xml"):
        assert {(file, "mass matrix"), (file, "gravity forces"), (file, "inverse dynamics")} <= passed
    report = json.loads((folder / "out" / "report.json").read_text(encoding="utf-8"))
    assert {one["name"]: one["kind"] for one in report["robot"]["joints"]} == {
        "base": "fixed",
        "table": "planar",
        "hinge": "revolute",
        "free": "floating",
        "tool": "fixed",
    }


@pytest.mark.slow
def test_joints_that_engines_do_not_read_are_reported(stage: tuple[Path, Conversion]) -> None:
    """The warning names them; bounds of the planar joint, which URDF does not define, are declared as lost."""
    _, conversion = stage
    (unconfirmed,) = [one for one in conversion.diagnostics if one.code == "SB867"]
    assert "'table' (planar), 'free' (floating)" in unconfirmed.message
    lost = [one.message for one in conversion.diagnostics if one.code == "SB860"]
    assert lost == ["<limit> in <joint>: not converted"]


def test_masses_for_openusd_are_a_declared_difference(stage: tuple[Path, Conversion]) -> None:
    """OpenUSD's stand-in masses change the mass matrix: it is compared with the model, not with the source."""
    _, conversion = stage
    assert conversion.report is not None
    of_usd = [check for check in conversion.report.checks if check.file == "stage.usda"]
    matrices = {check.against: check for check in of_usd if check.quantity == "mass matrix"}
    assert matrices["source.urdf (mujoco)"].status is Status.NOT_RUN
    assert "SB761:massless" in matrices["source.urdf (mujoco)"].why
    assert Status.PASSED in {check.status for check in matrices.values()}


@pytest.mark.slow
def test_robot_that_floats_in_the_world(tmp_path: Path) -> None:
    """A floating joint below the link `world` is a floating base."""
    conversion = _converted(tmp_path, DRONE, "urdf", "sdf", "mjcf")
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert not {"SB867", "SB874:base"} & {one.code for one in conversion.diagnostics}
    (lost,) = [one.message for one in conversion.diagnostics if one.code == "SB860"]
    assert lost.endswith("the robot starts upright")
    assert conversion.robot is not None
    assert conversion.robot.base is Base.FLOATING
    assert [link.name for link in conversion.robot.links] == ["body", "arm"]
    assert b"<freejoint" in conversion.files["drone.xml"]


@pytest.mark.slow
def test_misread_plane_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Were the normal of the plane misread, the files would differ from the source."""
    described = writing.rendered

    def misread(robot: Robot, *rest: object) -> writing.Rendered:
        joints = tuple(replace(one, axis=(0.0, 0.0, 1.0)) if one.kind == "planar" else one for one in robot.joints)
        return described(replace(robot, joints=joints), *rest)  # type: ignore[arg-type]

    monkeypatch.setattr("stepbot.pipeline.translating.rendered", misread)
    conversion = _converted(tmp_path, STAGE, "mjcf")
    assert "SB803" in {one.code for one in conversion.diagnostics if one.severity == "error"}


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (2 / 3, -1 / 3, 2 / 3)])
def test_plane_is_that_of_mujoco(axis: tuple[float, float, float]) -> None:
    """MuJoCo's own reading of a planar joint moves in the same plane and turns about the same axis."""
    text = f'<robot name="r">{_link("a")}{_link("b")}' + _joint(
        "plane", "planar", "a", "b", f'<axis xyz="{axis[0]!r} {axis[1]!r} {axis[2]!r}"/>'
    )
    model = mujoco.MjModel.from_xml_string(f"{text}</robot>")
    joint = Joint("plane", JointKind.PLANAR, "a", "b", axis=axis)
    ours = [one.axis for one in split(Robot("r", (Link("a"), Link("b")), (joint,)), JointKind.PLANAR).joints]
    assert model.jnt_type.tolist() == [2, 2, 3]
    assert np.cross(model.jnt_axis[0], model.jnt_axis[1]) == pytest.approx(np.cross(ours[0], ours[1]))
    assert model.jnt_axis[2] == pytest.approx(np.array(ours[2]))


@pytest.mark.slow
def test_vertices_without_faces_are_no_difference(tmp_path: Path) -> None:
    """MuJoCo's size of a visual counts them, so it is not compared."""
    corners = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nv 5 5 5\n"
    (tmp_path / "tip.obj").write_text(f"{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", encoding="utf-8")
    shape = '<visual><geometry><mesh filename="tip.obj"/></geometry></visual>'
    conversion = _converted(
        tmp_path, f'<robot name="tip"><link name="tip">{_BODY.format(0)}{shape}</link></robot>', "mjcf"
    )
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed


@pytest.mark.slow
def test_engines_that_do_not_move_a_joint_are_not_compared(tmp_path: Path) -> None:
    """`verify` of a planar joint, which PyBullet and yourdfpy leave at 0, finds no difference, and says so."""
    table = _joint("table", "planar", "base", "table", '<axis xyz="0 1 0"/>')
    path = tmp_path / "table.urdf"
    path.write_text(f'<robot name="r">{_link("base")}{_link("table")}{table}</robot>', encoding="utf-8")
    diagnostics = Diagnostics()
    report = verify_files([path], diagnostics)
    assert diagnostics.exit_code == 0, list(map(str, diagnostics))
    reasons = {check.engine: check.why for check in report.checks if check.quantity in ("load", "poses")}
    assert reasons["pybullet"] == "PyBullet does not move these joints: 'table' (planar)"
    assert reasons["yourdfpy"] == "yourdfpy does not move these joints: 'table' (planar)"


@pytest.mark.slow
def test_declared_losses_of_a_format_are_no_differences(tmp_path: Path) -> None:
    """Sensors and mixed mimics that OpenUSD and Webots lack, and limits without a motor, are not compared."""
    slide = HINGE.replace("0 1 0", "0 0 1") + '<mimic joint="hinge" multiplier="0.1"/>'
    view = "<horizontal_fov>1</horizontal_fov><image><width>64</width><height>48</height></image>"
    eye = f'<gazebo reference="arm"><sensor name="eye" type="camera"><camera>{view}</camera></sensor></gazebo>'
    joints = _joint("hinge", "revolute", "base", "arm", HINGE) + _joint("slide", "prismatic", "base", "pin", slide)
    links = "".join(map(_link, ("base", "arm", "pin")))
    conversion = _converted(tmp_path, f'<robot name="r">{links}{joints}{eye}</robot>', "usd", "webots")
    assert {"SB760:mixed-mimic", "SB760:camera", "SB760:passive-limit"} <= {one.code for one in conversion.diagnostics}
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))


_TABLE = "<{0}><geometry><box size='1 1 0.1'/></geometry></{0}>"


@pytest.mark.parametrize("content", ["", _BODY.format(0.0), _TABLE.format("visual"), _TABLE.format("collision")])
@pytest.mark.parametrize("bases", [1, 2])
def test_bases_on_a_link_world_stay_where_they_are(tmp_path: Path, bases: int, content: str) -> None:
    """A cell has several bases on ``world``, or a table in it: MuJoCo alone leaves out the joints that hold them."""
    text = f'<robot name="cell"><link name="world">{content}</link>'
    for n in range(bases):
        text += _link(f"base_{n}") + _link(f"arm_{n}") + _joint(f"held_{n}", "fixed", "world", f"base_{n}")
        text += _joint(f"turn_{n}", "revolute", f"base_{n}", f"arm_{n}", HINGE)
    conversion = _converted(tmp_path, text + "</robot>", "urdf", "sdf", "mjcf")
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    of_source = [check for check in conversion.report.checks if check.against == "source.urdf (mujoco)"]
    passed = {(check.file, check.quantity) for check in of_source if check.status is Status.PASSED}
    assert {(f"cell.{end}", what) for end in ("urdf", "sdf", "xml") for what in ("links", "joints", "poses")} <= passed
    source = tmp_path / "source.urdf"
    moved = tmp_path / "moved.urdf"
    moved.write_text(source.read_text().replace('xyz="0.1 0.2 0.3"', 'xyz="0.1 0.2 0.31"', 1))
    diagnostics = Diagnostics()
    verify_files([source, moved], diagnostics, workers=Options(tmp_path).workers)
    is_place = bases == 1 and not content  # of the one base in the world
    assert any("poses" in one.message for one in diagnostics) != is_place


@pytest.mark.parametrize("q", [0.0, 0.7])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_locked_joints_become_fixed(tmp_path: Path, kind: str, q: float) -> None:
    """A joint whose limits are one position stays there, and so does what follows it; ROS moves neither.

    By hand: the child is turned about the axis, or moved along it, by the position, in a frame that stays.
    """
    limit = f'<axis xyz="0 0 1"/><limit lower="{q}" upper="{q}" effort="1" velocity="1"/>'
    follows = f'<axis xyz="0 0 1"/><mimic joint="lock" multiplier="2"/>{HINGE.partition("/>")[2]}'
    text = (
        f'<robot name="robot"><link name="world"/>{"".join(map(_link, ("base", "arm", "hand", "tip")))}'
        + _joint("mount", "fixed", "world", "base")
        + _joint("lock", kind, "base", "arm", limit)
        + _joint("after", "revolute", "arm", "hand", follows)
        + _joint("free", "revolute", "hand", "tip", HINGE)
        + "</robot>"
    )
    conversion = _converted(tmp_path, text, "urdf", "sdf", "mjcf")
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    found = [one.message for one in conversion.diagnostics if one.code == "SB874:limit"]
    assert found == [
        f"joint 'lock': lower and upper limit are both {q:g}: converted to a fixed joint",
        "joint 'after' mimics 'lock', which cannot move: converted to a fixed joint",
    ]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.njnt == 1
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    to_arm = _X(q, 0.0) if kind == "revolute" else _X(0.0, q)
    to_hand = to_arm @ _X(2.0 * q, 0.0)
    np.testing.assert_allclose(data.body("tip").xpos, (to_hand @ _X(0.0, 0.0))[:3, 3], atol=1e-12)


def _X(angle: float, along: float) -> np.ndarray:
    """The origin that all joints of these robots have, then a rotation about z and a translation along it."""

    def turn(axis: int, by: float) -> np.ndarray:
        i, j = (axis + 1) % 3, (axis + 2) % 3
        R = np.eye(4)
        R[i, i] = R[j, j] = np.cos(by)
        R[i, j], R[j, i] = -np.sin(by), np.sin(by)
        return R

    def move(*by: float) -> np.ndarray:
        X = np.eye(4)
        X[:3, 3] = by
        return X

    origin = move(0.1, 0.2, 0.3) @ turn(2, 0.7) @ turn(1, -0.2) @ turn(0, 0.3)
    return np.asarray(origin @ turn(2, angle) @ move(0.0, 0.0, along))
