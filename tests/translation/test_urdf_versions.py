"""URDF 1.1 and 1.2: quaternions, capsules, and limits of acceleration and jerk, read and written."""

import importlib.util
import re
from math import isfinite
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.describe import describe
from stepbot.engines.observation import EngineRefused, Request
from stepbot.engines.pybullet import observer as pybullet_observer
from stepbot.engines.urdf_versions import with_rpy
from stepbot.formats.rendering import render
from stepbot.formats.urdf.ros2.moveit import _further
from stepbot.geometry.spatial import Pose, quaternion_from_rotation, rotation_from_rpy
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options
from stepbot.robot.datasheet import accelerations, with_accelerations
from stepbot.robot.model import Capsule, Collision, FormatVersions, Limit, Robot
from tests.robots import two_link_arm

ARM = """<robot name="arm" version="1.2">
  <link name="base"/>
  <joint name="elbow" type="revolute">
    <origin xyz="0.1 0.2 0.3" {joint}/><parent link="base"/><child link="fore"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="5" velocity="3" acceleration="9" deceleration="12.5" jerk="100"/>
  </joint>
  <link name="fore">
    <inertial><origin xyz="0 0.01 0.1" {inertial}/><mass value="2"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.021" iyz="0.0005" izz="0.004"/></inertial>
    <visual><origin {visual}/><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
    <collision name="rod"><origin xyz="0 0 0.1" {collision}/>
      <geometry><capsule radius="0.03" length="0.2"/></geometry></collision>
  </link>
</robot>
"""
PLACES = ("joint", "inertial", "visual", "collision")
angles = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


def rpy(values: tuple[float, float, float]) -> str:
    """The attribute of URDF 1.0."""
    return 'rpy="{} {} {}"'.format(*map(repr, values))


def quaternion(values: tuple[float, float, float], scale: float) -> str:
    """The attribute of URDF 1.1; a quaternion of any length is a rotation."""
    w, x, y, z = (scale * part for part in quaternion_from_rotation(rotation_from_rpy(values)))
    return f'quat_xyzw="{x!r} {y!r} {z!r} {w!r}"'


@pytest.mark.slow
@given(turns=st.tuples(angles, angles, angles, angles), scale=st.sampled_from([1.0, -1.0, 3.0]))
def test_a_quaternion_is_the_rotation_that_it_states(
    tmp_path_factory: pytest.TempPathFactory, turns: tuple[tuple[float, float, float], ...], scale: float
) -> None:
    """A file with quaternions is the robot of the same file with roll, pitch and yaw, wherever a rotation may be."""
    folder = tmp_path_factory.mktemp("versions")
    read = []
    for name, texts in (("old", map(rpy, turns)), ("new", (quaternion(one, scale) for one in turns))):
        file = folder / f"{name}.urdf"
        file.write_text(ARM.format(**dict(zip(PLACES, texts, strict=True))), encoding="utf-8")
        read.append(describe(str(file), "urdf"))
    old, new = read
    assert not new.lost
    np.testing.assert_allclose(new.X_PC["fore"].matrix, old.X_PC["fore"].matrix, atol=1e-12)
    for ours, theirs in zip(new.shapes, old.shapes, strict=True):
        np.testing.assert_allclose(ours.X_LG.matrix, theirs.X_LG.matrix, atol=1e-12)
    inertias = [np.array(one.observation.links[1].inertia) for one in read]
    np.testing.assert_allclose(inertias[1], inertias[0], atol=1e-14)
    assert new.shapes[1].geometry == Capsule(0.03, 0.2)
    limit = new.observation.joints[0].limit
    assert limit == Limit(-1.0, 2.0, 3.0, 5.0, acceleration=9.0, deceleration=12.5, jerk=100.0)


@pytest.mark.parametrize(
    ("attribute", "message"),
    [
        ('rpy="0 0 1" quat_xyzw="0 0 0 1"', "line 4: <origin> has 'rpy' and 'quat_xyzw': remove one"),
        ('quat_xyzw="0 0 0 0"', "line 4: 'quat_xyzw' of <origin> is zero, and no rotation"),
        ('quat_xyzw="0 0 1"', "line 4: 'quat_xyzw' of <origin> is '0 0 1', not 4 numbers"),
    ],
)
def test_rotations_that_are_none(tmp_path: Path, attribute: str, message: str) -> None:
    """Two rotations in one place, and quaternions without a direction, are refused with their line."""
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(joint=attribute, inertial="", visual="", collision=""), encoding="utf-8")
    with pytest.raises(EngineRefused, match=re.escape(message)):
        describe(str(file), "urdf")


@pytest.mark.parametrize("text", ["0 0 1", "0 0 0 0", "0 0 0 nan", "0 0 0 inf", "0 0 0 continuous"])
def test_engines_refuse_rotations_that_are_none(text: str) -> None:
    """A copy for engines is not made of a quaternion without a direction; blocks of programs are not read."""
    robot = etree.fromstring(ARM.format(joint=f'quat_xyzw="{text}"', inertial="", visual="", collision=""))
    with pytest.raises(EngineRefused, match=f"line 4: 'quat_xyzw' of <origin> is '{text}', not a rotation"):
        with_rpy(robot)
    block = etree.fromstring(f'<robot><gazebo><origin quat_xyzw="{text}"/></gazebo></robot>')
    assert not with_rpy(block)


@pytest.mark.pybullet
def test_pybullet_refuses_them_with_their_line(tmp_path: Path) -> None:
    """The message of its observer is the same."""
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(joint='quat_xyzw="0 0 1"', inertial="", visual="", collision=""), encoding="utf-8")
    with pytest.raises(EngineRefused, match="line 4: 'quat_xyzw' of <origin> is '0 0 1', not a rotation"):
        pybullet_observer.observe(Request(str(file), "urdf"))


@pytest.mark.slow
def test_engines_confirm_what_was_read(tmp_path: Path) -> None:
    """MuJoCo, PyBullet and yourdfpy read a source of URDF 1.2 as the files that it is converted to."""
    texts = {place: quaternion((0.3, -0.4, 1.1 + i), 1.0) for i, place in enumerate(PLACES)}
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(**texts), encoding="utf-8")
    conversion = convert(file, Options(tmp_path / "out", formats=("urdf", "mjcf", "sdf"), base="fixed"))
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    assert {one.code for one in conversion.diagnostics if one.severity == "warning"} >= {"SB760:acceleration"}
    assert conversion.report is not None
    seen = [one for one in conversion.report.checks if one.against.startswith("arm.urdf (") and one.quantity == "poses"]
    assert {one.file for one in seen if one.status == "passed"} == {"arm.urdf", "arm.xml", "arm.sdf"}


def newest() -> Robot:
    """An arm with a turned capsule, in URDF 1.2."""
    arm = two_link_arm()
    last, limit = arm.links[-1], Limit(-1.0, 1.0, 2.0, 30.0, acceleration=8.0, deceleration=9.0, jerk=70.0)
    bare = (replace(one, visuals=(), collisions=()) for one in arm.links[:-1])
    rod = Collision("rod", Capsule(0.02, 0.1), Pose.from_xyz_rpy((0.1, 0.0, 0.0), (0.4, 0.5, -0.6)))
    return replace(
        arm,
        links=(*bare, replace(last, visuals=(), collisions=(rod,))),
        joints=(*arm.joints[:-1], replace(arm.joints[-1], limit=limit, X_PC=rod.X_LG)),
        versions=FormatVersions(urdf=1.2),
    )


def test_writing_what_the_versions_have() -> None:
    """Version 1.2 is written with quaternions, a capsule and all limits; 1.1 without its limits; 1.0 as ever."""
    robot = newest()
    diagnostics = Diagnostics()
    top = ET.fromstring(render(robot, "urdf", diagnostics)[f"{robot.name}.urdf"])
    assert not {one.code for one in diagnostics} & {"SB763:capsule", "SB760:acceleration"}
    assert top.get("version") == "1.2"
    assert top.find(".//capsule") is not None
    assert not top.findall(".//origin[@rpy]")
    limits = top.findall("joint/limit")[-1].attrib
    assert [limits[name] for name in ("acceleration", "deceleration", "jerk")] == ["8", "9", "70"]
    for version, codes in ((1.1, {"SB760:acceleration"}), (1.0, {"SB760:acceleration", "SB763:capsule"})):
        diagnostics = Diagnostics()
        older = replace(robot, versions=FormatVersions(urdf=version))
        text = render(older, "urdf", diagnostics)[f"{robot.name}.urdf"].decode()
        assert {one.code for one in diagnostics} & {"SB763:capsule", "SB760:acceleration"} == codes
        assert ("quat_xyzw" in text, "<capsule" in text, "jerk" in text) == (version > 1.0, version > 1.0, False)


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    """Poses, shape and limits of version 1.2 are the robot's."""
    robot = newest()
    file = tmp_path / "arm.urdf"
    file.write_bytes(render(robot, "urdf", Diagnostics())[f"{robot.name}.urdf"])
    read = describe(str(file), "urdf")
    for joint in robot.joints:
        np.testing.assert_allclose(read.X_PC[joint.child].matrix, joint.X_PC.matrix, atol=1e-15)
    rod = next(shape for shape in read.shapes if shape.name == "rod")
    assert rod.geometry == Capsule(0.02, 0.1)
    np.testing.assert_allclose(rod.X_LG.matrix, robot.links[-1].collisions[0].X_LG.matrix, atol=1e-15)
    seen = {joint.name: joint.limit for joint in read.observation.joints}
    for joint in with_accelerations(robot).joints:
        smooth = (joint.limit.acceleration, joint.limit.deceleration, joint.limit.jerk)
        limit = seen[joint.name] or Limit()
        assert (limit.acceleration, limit.deceleration, limit.jerk) == smooth
    assert any(isfinite(joint.limit.jerk) for joint in robot.joints)


def test_joints_without_an_acceleration_have_that_which_their_efforts_allow() -> None:
    """In version 1.2, with a note; what the robot states is kept, and a joint without effort has none."""
    robot = two_link_arm()
    first, second = robot.joints[-2:]
    stated = replace(second, limit=replace(second.limit, acceleration=8.0, effort=5.0))
    driven = replace(first, limit=replace(first.limit, effort=200.0))
    robot = replace(robot, joints=(*robot.joints[:-2], driven, stated), versions=FormatVersions(urdf=1.2))
    expected = accelerations(robot)
    diagnostics = Diagnostics()
    top = ET.fromstring(render(robot, "urdf", diagnostics)[f"{robot.name}.urdf"])
    written = {joint.get("name"): joint.find("limit") for joint in top.findall("joint")}
    assert float(written[first.name].get("acceleration")) == expected[first.name] > 0.0
    assert written[second.name].get("acceleration") == "8"
    (note,) = [one for one in diagnostics if one.code == "SB763:acceleration"]
    assert f"'{first.name}'" in note.message
    assert second.name not in note.message
    older = Diagnostics()
    text = render(replace(robot, versions=FormatVersions()), "urdf", older)[f"{robot.name}.urdf"].decode()
    assert "acceleration=" not in text
    assert "SB763:acceleration" not in {one.code for one in older}


@pytest.mark.skipif(importlib.util.find_spec("pinocchio") is None, reason="Pinocchio, with urdfdom, is not installed")
def test_urdfdom_reads_what_is_written(tmp_path: Path) -> None:
    """The parser of ROS, in Pinocchio, has the pose of the quaternion and the capsule."""
    import pinocchio

    robot = newest()
    file = tmp_path / "arm.urdf"
    file.write_bytes(render(robot, "urdf", Diagnostics())[f"{robot.name}.urdf"])
    model = pinocchio.buildModelFromUrdf(str(file))
    placement = model.jointPlacements[model.getJointId(robot.joints[-1].name)]
    np.testing.assert_allclose(placement.homogeneous, robot.joints[-1].X_PC.matrix, atol=1e-12)
    shapes = pinocchio.buildGeomFromUrdf(model, str(file), pinocchio.GeometryType.COLLISION)
    assert type(shapes.geometryObjects[-1].geometry).__name__ == "Capsule"


def test_moveit_has_the_limits_that_a_file_states() -> None:
    """Each limit beyond velocity and acceleration comes with the flag that makes MoveIt use it."""
    assert _further(Limit(jerk=100.0)) == {"has_jerk_limits": True, "max_jerk": 100.0}
    assert _further(Limit()) == {}
