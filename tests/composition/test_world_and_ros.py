"""Several robots in one world, and what ROS gets of each module."""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.compose import joining
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Base, JointKind, Link, Robot
from tests.command_line import stepbot

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]
ARM = """
    <mujoco model="arm"><worldbody><body name="base">
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <body name="upper" pos="0 0 0.2"><joint name="lift" axis="0 1 0" range="-1 1" limited="true"/>
        <geom type="capsule" size="0.02 0.1" pos="0 0 0.15" mass="1"/></body>
    </body></worldbody><actuator><position name="lift" joint="lift" kp="10" kv="1"/></actuator></mujoco>
    """
BALL = """
    <mujoco model="ball"><worldbody><body name="ball" pos="0 0 3"><freejoint/>
      <geom type="box" size="0.1 0.2 0.3" mass="4"/></body></worldbody></mujoco>
    """
CELL = """
    version: 1
    robot: cell
    modules:
      left: {file: arm.xml, at: world}
      right: {file: arm.xml, at: world, offset: {xyz: [0, 1, 0], rpy: [0, 0, 90 deg]}}
      box: {file: box.xml, at: world, offset: {xyz: [2, 0, 0.5]}}
    """
FILES = {"cell.robot.yaml": CELL, "arm.xml": ARM, "box.xml": BALL}


@pytest.mark.slow
def test_parts_stand_in_the_world(composed: Compose) -> None:
    """Fixed robots are welded to one root without mass; a floating one is free, its lowest point where `offset` is."""
    robot = composed(FILES, Diagnostics())
    assert (robot.root.name, robot.root.mass_properties.mass, robot.base) == ("cell", 0.0, Base.FIXED)
    mounts = {joint.child: joint for joint in robot.joints if joint.parent == "cell"}
    assert {child: joint.kind for child, joint in mounts.items()} == {
        "left_base": JointKind.FIXED,
        "right_base": JointKind.FIXED,
        "box_ball": JointKind.FLOATING,
    }
    assert mounts["box_ball"].X_PC.position == pytest.approx((2.0, 0.0, 0.8))


@pytest.mark.slow
@pytest.mark.parametrize("other", ["", "base: fixed"])
def test_a_fixed_root_is_in_the_world_itself(composed: Compose, other: str) -> None:
    """Beside an arm without `at`, no further root is made; a floating one without `at` is free in the world."""
    text = CELL.replace("left: {file: arm.xml, at: world}", "left: {file: arm.xml}").replace(
        "robot: cell", f"robot: cell\n    {other}"
    )
    assert composed({**FILES, "cell.robot.yaml": text}, Diagnostics()).root.name == "left_base"
    text = CELL.replace("box.xml, at: world, offset: {xyz: [2, 0, 0.5]}", "box.xml")
    robot = composed({**FILES, "cell.robot.yaml": text}, Diagnostics())
    assert robot.root.name == "cell"
    assert robot.joint_by_name["box_free"].X_PC.position == pytest.approx((0.0, 0.0, 0.3))


@pytest.mark.slow
@pytest.mark.parametrize(
    "tamper",
    [
        lambda link: replace(
            link, mass_properties=replace(link.mass_properties, mass=link.mass_properties.mass * 1.001)
        ),
        lambda link: replace(link, mass_properties=link.mass_properties.moved(Pose.from_xyz_rpy((0.0, 1e-6, 0.0)))),
    ],
)
def test_a_module_that_is_composed_wrongly_is_an_error(
    tamper: Callable[[Link], Link], composed: Compose, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A link's mass or centre of mass that differs from that in the module's file stops the conversion."""

    def tampered(*arguments: Any) -> Robot | None:
        robot = joining.composed(*arguments)
        assert robot is not None
        links = tuple(tamper(link) if link.name == "right_upper" else link for link in robot.links)
        return replace(robot, links=links)

    monkeypatch.setattr("stepbot.pipeline.composing.composed", tampered)
    with pytest.raises(StepbotError, match=r"SB803.*module 'right'"):
        composed(FILES, Diagnostics())


@pytest.mark.slow
def test_a_turned_part_of_a_module_is_an_error(composed: Compose, monkeypatch: pytest.MonkeyPatch) -> None:
    """So does a joint whose axis is reversed without its positions."""
    forearm = """<body name="hand" pos="0 0 0.3"><joint name="grip" axis="1 0 0" range="-1 1" limited="true"/>
        <geom type="box" size="0.02 0.03 0.04" mass="0.2"/></body></body>
    </body></worldbody>"""
    arm = ARM.replace("</body>\n    </body></worldbody>", forearm)
    assert "grip" in arm

    def tampered(*arguments: Any) -> Robot | None:
        robot = joining.composed(*arguments)
        assert robot is not None
        return replace(
            robot,
            joints=tuple(
                replace(one, axis=(-one.axis[0], 0.0, 0.0)) if one.name == "left_grip" else one for one in robot.joints
            ),
        )

    composed({**FILES, "arm.xml": arm}, Diagnostics())
    monkeypatch.setattr("stepbot.pipeline.composing.composed", tampered)
    with pytest.raises(StepbotError, match=r"SB803.*module 'left'"):
        composed({**FILES, "arm.xml": arm}, Diagnostics())


@pytest.mark.slow
def test_a_mirror_image_stands_at_the_image_of_the_place(composed: Compose) -> None:
    """Through the plane y = 0 of the world, fixed or free."""
    modules = """
      right: {mirror_of: left}
      other: {mirror_of: box}
    """
    text = CELL.replace("right: {file: arm.xml, at: world, offset: {xyz: [0, 1, 0], rpy: [0, 0, 90 deg]}}", "")
    text = text.replace(
        "left: {file: arm.xml, at: world}", "left: {file: arm.xml, at: world, offset: {xyz: [0, 1, 0]}}"
    )
    text = text.replace("xyz: [2, 0, 0.5]", "xyz: [2, 3, 0.5]").rstrip() + modules
    joints = composed({**FILES, "cell.robot.yaml": text}, Diagnostics()).joint_by_name
    assert joints["right_mount"].X_PC.position == pytest.approx((0.0, -1.0, 0.0))
    assert joints["other_free"].X_PC.position == pytest.approx((2.0, -3.0, 0.8))


@pytest.mark.parametrize(
    ("place", "xyz"),
    [
        ("offset: {xyz: [2, 0, 0.5], rpy: [90 deg, 0, 0]}", (2.0, 0.0, 0.7)),
        ("offset: {xyz: [2, 0, 0.5]}, by: top", (1.9, -0.2, 0.8)),
        ("offset: {xyz: [2, 0, 0.5], rpy: [0, 90 deg, 0]}, by: top", (1.7, -0.2, 0.6)),
    ],
)
def test_a_free_module_lies_on_its_lowest_point(place: str, xyz: tuple[float, ...], composed: Compose) -> None:
    """However it is turned, and whichever of its ports is above the stated place: a box of 0.2 x 0.4 x 0.6 m."""
    ball = BALL.replace("<geom", '<site name="top" pos="0.1 0.2 0.3"/><geom')
    text = CELL.replace("offset: {xyz: [2, 0, 0.5]}", place)
    robot = composed({**FILES, "cell.robot.yaml": text, "box.xml": ball}, Diagnostics())
    assert robot.joint_by_name["box_free"].X_PC.position == pytest.approx(xyz)


@pytest.mark.slow
def test_one_falls_and_the_others_stay(tmp_path: Path, write: Callable[[Mapping[str, str]], None]) -> None:
    """MuJoCo: qpos is that of all robots, the mass matrix has no entries between them, and free fall is free."""
    write(FILES)
    made = stepbot("convert", "cell.robot.yaml", "-o", "out", "-f", "mjcf,urdf", "--no-cache", cwd=tmp_path)
    assert made.code == 0, made.out + made.err
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/cell.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert (model.nq, model.nv) == (2 + 7, 2 + 6)
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    owner = [model.body(model.dof_bodyid[i]).name.partition("_")[0] for i in range(model.nv)]
    assert all(matrix[i, j] == 0.0 for i in range(model.nv) for j in range(model.nv) if owner[i] != owner[j])
    before = data.xpos.copy()
    while data.time < 0.1:
        mujoco.mj_step(model, data)
    excluded = {model.body(i).name for signature in model.exclude_signature for i in divmod(int(signature), 1 << 16)}
    assert "left_upper" in excluded
    assert "box_ball" not in excluded, "a free object collides with what is fixed to the world"
    fallen = model.body("box_ball").id
    assert data.xpos[fallen][2] - before[fallen][2] == pytest.approx(-0.5 * 9.81 * data.time**2, rel=0.1)
    bases = [model.body(f"{side}_base").id for side in ("left", "right")]
    assert (data.xpos[bases] == before[bases]).all()
    assert before[bases[1]] == pytest.approx((0.0, 1.0, 0.0))


@pytest.mark.slow
def test_ros_gets_a_system_and_a_controller_for_each_module(
    tmp_path: Path, write: Callable[[Mapping[str, str]], None]
) -> None:
    """`<ros2_control>` blocks have names of their own and list each joint once; the hardware of one can be chosen."""
    write(FILES)
    options = ("--ros2", "cell_description", "--no-verify", "--no-cache", "-f", "urdf")
    assert stepbot("convert", "cell.robot.yaml", "-o", "out", *options, cwd=tmp_path).code == 0
    file = tmp_path / "out/urdf/cell.urdf.xacro"
    program = "import xml.parsers.expat, xacro; xacro.main()"
    arguments = [sys.executable, "-c", program, str(file), "prefix:=a_", "right_hardware:=my/Driver"]
    urdf = ET.fromstring(subprocess.run(arguments, check=True, capture_output=True).stdout)
    systems = {system.get("name"): system for system in urdf.iterfind("ros2_control")}
    assert {name: system.findtext("hardware/plugin") for name, system in systems.items()} == {
        "a_cell_left": "mock_components/GenericSystem",
        "a_cell_right": "my/Driver",
    }
    stated = [joint.get("name") for joint in urdf.iterfind("ros2_control/joint")]
    assert len(set(stated)) == len(stated)
    assert {"a_box_free_x", "a_box_free_turn_yaw"} < set(stated), "RViz shows the box where its joints are"
    joints = [joint.get("name") for joint in urdf.iterfind("ros2_control/joint[command_interface]")]
    assert sorted(joints) == ["a_left_lift", "a_right_lift"]
    # KDL ignores the mass of a root link: that of a cell has none, and Gazebo fixes it to the world.
    mass = urdf.find("link[@name='a_cell']/inertial/mass")
    assert mass is not None
    assert mass.get("value") == "0"
    in_world = subprocess.run([*arguments, "parent:=world"], check=True, capture_output=True).stdout
    mounts = ET.fromstring(in_world).findall("joint/parent[@link='world']/..")
    assert [joint.get("type") for joint in mounts] == ["fixed"]
    assert mounts[0].find("child[@link='a_cell']") is not None
    settings = (tmp_path / "out/config/ros2_controllers.yaml").read_text(encoding="utf-8")
    assert "left_position_controller:" in settings
    groups = ET.parse(tmp_path / "out/cell.srdf").getroot().findall("group")
    assert {group.get("name") for group in groups} == {"left", "right"}, "a free object is not planned for"
    pairs = [
        {one.get("link1"), one.get("link2")} for one in ET.parse(tmp_path / "out/cell.srdf").iter("disable_collisions")
    ]
    assert not any("box_ball" in pair for pair in pairs), "it can be anywhere"
    report = json.loads((tmp_path / "out/report.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in report["robot"]["modules"]] == ["left", "right", "box"]
