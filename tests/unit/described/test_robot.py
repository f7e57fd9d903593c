"""Robots of URDF, SDFormat and MJCF files, as files describe them."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from stepbot.described.robot import robot_of_description
from stepbot.diagnostics import Diagnostics
from stepbot.engines.describe import describe
from stepbot.engines.observation import Quantity
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import show
from stepbot.robot.kinematics import independent_joints, initial_configuration, link_poses, moving_joints
from stepbot.robot.model import ActuatorKind, JointKind, Robot
from stepbot.viewing.scene import scene_document
from tests.robots import ROBOTS

AWKWARD = """<mujoco><worldbody>
  <body name="base" pos="0.1 0 0.3"><geom type="box" size="0.1 0.1 0.02"/>
    <body name="arm" pos="0 0 0.1" euler="10 20 30">
      <joint name="swing" type="hinge" axis="0 1 0" pos="0.05 0.01 -0.02" range="-60 60"/>
      <joint name="push" type="slide" axis="1 0 0" pos="0 0.03 0" range="-0.1 0.1"/>
      <joint name="roll" type="hinge" axis="1 0 0" pos="-0.01 0 0.02"/>
      <geom type="capsule" size="0.02 0.1"/>
      <body name="tip" pos="0.2 0 0">
        <joint name="nod" axis="0 0 1" pos="0.01 0 0"/><geom type="ellipsoid" size="0.02 0.03 0.01"/>
      </body>
    </body>
  </body>
  <body name="beside" pos="1 0 0"><geom type="sphere" size="0.05"/></body>
</worldbody></mujoco>"""


def robot_of(path: Path, written_in: str) -> Robot:
    """The robot that a page shows of a file."""
    described = robot_of_description(describe(str(path), written_in), path.stem, path.name, drawn=True)
    assert described.missing == ()
    return described.robot


def test_anchors_and_several_joints_in_one_body(tmp_path: Path) -> None:
    """Every body is where MuJoCo puts it, for joints beside the body's origin and three in one body."""
    path = tmp_path / "awkward.xml"
    path.write_text(AWKWARD, encoding="utf-8")
    robot = robot_of(path, "mjcf")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    q = {"swing": 0.7, "push": -0.06, "roll": 1.9, "nod": -0.4}
    for name, value in q.items():
        data.joint(name).qpos[0] = value
    mujoco.mj_kinematics(model, data)
    poses = link_poses(robot, q)
    X_WR = np.eye(4)
    X_WR[:3, :3], X_WR[:3, 3] = data.body("base").xmat.reshape(3, 3), data.body("base").xpos
    for name in ("base", "arm", "tip", "beside"):
        X_WL = X_WR @ poses[name].matrix
        assert X_WL[:3, 3] == pytest.approx(data.body(name).xpos, abs=1e-12)
        assert X_WL[:3, :3].ravel() == pytest.approx(data.body(name).xmat, abs=1e-12)
    assert [joint.limit.upper for joint in robot.joints if joint.name == "push"] == [0.1]


@pytest.mark.parametrize("format_", ["urdf", "sdf", "mjcf"])
@pytest.mark.parametrize("name", ["four_bar", "gripper_with_mimic", "primitives", "tree", "two_link_arm"])
def test_a_written_file_shows_the_robot_that_was_written(name: str, format_: str, tmp_path: Path) -> None:
    """Links, joints, poses in a moved configuration, masses, and boxes of shapes survive writing and reading."""
    robot = ROBOTS[name]()
    for path, content in render(robot, format_, Diagnostics()).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_bytes(content)
    written = lower(robot, FORMATS[format_], Diagnostics())
    read = robot_of(tmp_path / f"{robot.name}{FORMATS[format_].suffix}", format_)
    names = [joint.name for joint in moving_joints(written)]
    assert sorted(joint.name for joint in moving_joints(read)) == sorted(names)
    q = {joint.name: 0.3 * (i + 1) for i, joint in enumerate(independent_joints(written))}
    q = {key: value for key, value in q.items() if written.joint_by_name[key].kind is not JointKind.PRISMATIC}
    expected, found = link_poses(written, q), link_poses(read, q)
    for link in written.links:
        assert found[link.name].distance_to(expected[link.name]) == pytest.approx((0.0, 0.0), abs=1e-6)
        assert read.link_by_name[link.name].mass_properties.mass == pytest.approx(link.mass_properties.mass, rel=1e-6)
        assert bool(read.link_by_name[link.name].visuals) == bool(link.visuals or link.collisions)
    assert scene_document(read)["name"] == robot.name
    if format_ == "mjcf":
        assert len(read.closures) == len(written.closures)
        assert initial_configuration(read) == pytest.approx(initial_configuration(written), abs=1e-9)


def test_joint_beside_the_origin_of_its_link_in_sdformat(tmp_path: Path) -> None:
    """A link turns about the joint's own pose: half a turn about a point at 0.1 m moves the origin by 0.2 m."""
    path = tmp_path / "beside.sdf"
    path.write_text(
        """<sdf version="1.9"><model name="beside"><link name="base"/><link name="arm"><pose>0.3 0 0 0 0 0</pose></link>
        <joint name="hinge" type="revolute"><parent>base</parent><child>arm</child><pose>0.1 0 0 0 0 0</pose>
        <axis><xyz>0 0 1</xyz></axis></joint></model></sdf>""",
        encoding="utf-8",
    )
    robot = robot_of(path, "sdf")
    assert link_poses(robot, {})["arm"].position == pytest.approx((0.3, 0, 0))
    assert link_poses(robot, {"hinge": np.pi})["arm"].position == pytest.approx((0.5, 0, 0))


def test_a_file_without_links_is_reported(tmp_path: Path) -> None:
    """An MJCF whose world is empty has nothing to show."""
    path = tmp_path / "empty.xml"
    path.write_text("<mujoco><worldbody/></mujoco>", encoding="utf-8")
    shown = show(path, Options(output=Path()))
    assert [one.code for one in shown.diagnostics] == ["SB823"]
    assert shown.scene is None


def test_further_lines_of_a_reader_are_notes(tmp_path: Path) -> None:
    """MuJoCo gives the place of a fault in a second line."""
    path = tmp_path / "wrong.xml"
    path.write_text("<mujoco><worldbody><body><inertial mass='1'/></body></worldbody></mujoco>", encoding="utf-8")
    (fault,) = show(path, Options(output=Path())).diagnostics
    assert fault.message == "XML Error: required attribute missing: 'pos'"
    assert fault.notes == ("Element 'inertial', line 1",)


def test_shapes_without_volume_are_declared(tmp_path: Path) -> None:
    """Boxes of size 0 or less, which engines reject, are left out, and listed."""
    path = tmp_path / "flat.urdf"
    box = "<{0}><geometry><box size='{1} 1 1'/></geometry></{0}>"
    shapes = box.format("visual", 0) + box.format("collision", -1) + box.format("collision", 1)
    path.write_text(f"<robot name='flat'><link name='base'>{shapes}</link></robot>", encoding="utf-8")
    described = robot_of_description(describe(str(path), "urdf"), "flat", path.name)
    (link,) = described.robot.links
    assert (len(link.visuals), len(link.collisions)) == (0, 1)
    assert [(one.code, one.text) for one in described.findings] == [
        ("SB860", "link 'base': visual with a box without volume: not converted"),
        ("SB860", "link 'base': collision with a box without volume: not converted"),
    ]


MOUNTED = """<robot name="mounted"><link name="world"/><link name="base"/><link name="a"/><link name="b"/>
<joint name="mount" type="fixed"><origin xyz="0 0 2" rpy="3.14159 0 0"/>
<parent link="world"/><child link="base"/></joint>
<joint name="lead" type="continuous"><parent link="base"/><child link="a"/></joint>
<joint name="follow" type="continuous"><parent link="base"/><child link="b"/><mimic joint="lead" offset="0.3"/></joint>
</robot>"""


def test_a_tilted_mount_is_a_loss_and_followers_start_with_their_leader(tmp_path: Path) -> None:
    """Gravity acts otherwise on a robot that hung from the ceiling, which is a warning; a mimic's offset counts."""
    path = tmp_path / "mounted.urdf"
    path.write_text(MOUNTED, encoding="utf-8")
    described = robot_of_description(describe(str(path), "urdf"), "mounted", path.name)
    (tilted,) = described.findings
    assert tilted.code == "SB860"
    assert tilted.text.endswith("turned by (3.14159, 0, 0) rad; gravity acts in another direction of the robot")
    assert tilted.differs == (Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS)
    assert described.robot.joint_by_name["follow"].drawn_position == 0.3


def test_a_gear_of_zero_moves_nothing(tmp_path: Path) -> None:
    """An actuator with a reduction of 0 in `<ros2_control>` is left out and reported."""
    path = tmp_path / "geared.urdf"
    path.write_text(
        """<robot name="geared"><link name="base"/><link name="arm"/>
        <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/></joint>
        <ros2_control name="drives" type="system"><hardware><plugin>any</plugin></hardware>
        <joint name="hinge"><command_interface name="effort"><param name="min">-1</param></command_interface></joint>
        <transmission name="gear"><plugin>transmission_interface/SimpleTransmission</plugin>
        <actuator name="motor" role="actuator1"/>
        <joint name="hinge" role="joint1"><mechanical_reduction>0</mechanical_reduction></joint></transmission>
        </ros2_control></robot>""",
        encoding="utf-8",
    )
    made = robot_of_description(describe(str(path), "urdf"), "geared", path.name)
    assert not made.robot.actuators
    lost = "actuator 'motor' of type 'motor' on 'hinge' with a gear of 0: not converted"
    assert ("SB863", lost) in [(one.code, one.text) for one in made.findings]


def test_command_interfaces_of_a_joint_are_alternatives(tmp_path: Path) -> None:
    """ros2_control claims one at a time: the position input stays, and unlimited inputs are beyond no limits."""
    path = tmp_path / "three.urdf"
    path.write_text(
        """<robot name="three"><link name="base"/><link name="arm"/>
        <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/>
        <limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
        <ros2_control name="drives" type="system"><hardware><plugin>any</plugin></hardware><joint name="hinge">
        <command_interface name="effort"/><command_interface name="velocity"/><command_interface name="position"/>
        <state_interface name="position"><param name="initial_value">0.7</param></state_interface>
        </joint></ros2_control></robot>""",
        encoding="utf-8",
    )
    made = robot_of_description(describe(str(path), "urdf"), "three", path.name)
    assert [(one.joint, one.kind) for one in made.robot.actuators] == [("hinge", ActuatorKind.POSITION)]
    assert made.robot.joint_by_name["hinge"].drawn_position == 0.7
    texts = [one.text for one in made.findings if one.code == "SB863"]
    kinds = ("motor", "velocity")
    assert texts == [
        f"command interface of type '{kind}' on 'hinge': not converted, as that of type 'position' is" for kind in kinds
    ]


@pytest.mark.parametrize(("text", "start"), [("", 0.0), ("0.5", 0.5), ("-7", -2.0)])
def test_the_start_of_a_placeholder_is_the_drawn_pose(text: str, start: float, tmp_path: Path) -> None:
    """An empty start is none, and one beyond the limits is moved to them and reported."""
    path = tmp_path / "start.urdf"
    path.write_text(
        f"""<robot name="start"><link name="base"/><link name="arm"/>
        <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/>
        <limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
        <ros2_control name="drives" type="system"><hardware><plugin>any</plugin></hardware><joint name="hinge">
        <command_interface name="position"/>
        <state_interface name="position"><param name="initial_value">{text}</param></state_interface>
        </joint></ros2_control></robot>""",
        encoding="utf-8",
    )
    made = robot_of_description(describe(str(path), "urdf"), "start", path.name)
    assert made.robot.joint_by_name["hinge"].drawn_position == start
    assert any("initial position" in one.text for one in made.findings) == (text == "-7")
