"""What ROS, Gazebo and Drake get of two arms with one gripper each: names, blocks and groups of each module."""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from textwrap import dedent
from xml.etree import ElementTree as ET

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.stages import convert
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache
from tests.command_line import stepbot

from .described import composing, joint, link, urdf

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]

TWO = """
    version: 1
    robot: two
    modules:
      left: {file: "library:arm2"}
      right: {file: "library:arm2", at: left/base, offset: {xyz: [0, 400 mm, 0]}}
      grip: {file: "library:2f85", at: right/tool0}
    """


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, cache: Cache) -> Path:
    """The robot, with a ROS 2 package."""
    folder = tmp_path_factory.mktemp("programs")
    (folder / "two.robot.yaml").write_text(dedent(TWO), encoding="utf-8")
    options = ("--ros2", "two_description", "--no-verify", "-f", "urdf,sdf", "--cache", str(cache.folder))
    run = stepbot("convert", "two.robot.yaml", "-o", "out", *options, cwd=folder)
    assert run.code in (0, 1), run.err
    return folder / "out"


@pytest.mark.slow
def test_plugins_of_gazebo_name_joints_that_exist(folder: Path) -> None:
    """Each drive has one plugin, on a joint of its own and with a topic of its own."""
    top = ET.parse(folder / "two.sdf").getroot()
    joints = {joint.get("name") for joint in top.iter("joint")}
    named = [one.text for plugin in top.iter("plugin") for one in plugin.iter("joint_name")]
    assert len(named) > 4
    assert set(named) <= joints
    topics = [one.text for one in top.iter("topic")]
    assert len(topics) == len(set(topics))


@pytest.mark.slow
def test_loops_for_drake_have_the_names_of_the_module(folder: Path) -> None:
    """The closures of the gripper are between links of this instance."""
    top = ET.parse(folder / "two.drake.sdf").getroot()
    links = {link.get("name") for link in top.iter("link")}
    ends = [one.text for one in top.iter() if one.tag.endswith(("_body_A", "_body_B"))]
    assert any(name and name.startswith("grip_") for name in links)
    assert ends
    assert all(name in links and name.startswith("grip_") for name in ends if name is not None)


@pytest.mark.slow
def test_the_macro_can_be_used_twice(folder: Path, tmp_path: Path) -> None:
    """Two instances in one file have no link, joint, material or system of the same name."""
    macro = folder / "urdf/two.macro.xacro"
    name = ET.parse(macro).getroot().find("{http://www.ros.org/wiki/xacro}macro")
    assert name is not None
    text = macro.read_text(encoding="utf-8")
    calls = "".join(f'<xacro:{name.get("name")} prefix="{prefix}"/>' for prefix in ("a_", "b_"))
    both = tmp_path / "both.xacro"
    both.write_text(text.rpartition("</robot>")[0] + f'<link name="world"/>{calls}</robot>', encoding="utf-8")
    program = "import xml.parsers.expat, xacro; xacro.main()"
    run = subprocess.run([sys.executable, "-c", program, str(both)], capture_output=True, check=False)
    assert run.returncode == 0, run.stderr.decode()
    top = ET.fromstring(run.stdout)
    for tag in ("link", "joint", "ros2_control"):
        names = [one.get("name") for one in top.findall(tag)]
        assert len(names) == len(set(names)), tag
    assert len(top.findall("ros2_control")) == 6


def test_groups_are_the_modules(folder: Path) -> None:
    """An arm with a gripper at its end is the parent group of the gripper, whose joints are its own."""
    top = ET.parse(folder / "two.srdf").getroot()
    links = {link.get("name") for link in ET.parse(folder / "two.urdf").getroot().iter("link")}
    joints = {joint.get("name") for joint in ET.parse(folder / "two.urdf").getroot().iter("joint")}
    groups = {group.get("name") for group in top.findall("group")}
    ends = {end.get("group"): end.get("parent_group") for end in top.findall("end_effector")}
    assert "grip" in groups
    assert set(ends) <= groups
    assert set(ends.values()) <= groups
    assert all(one.get("base_link") in links and one.get("tip_link") in links for one in top.iter("chain"))
    assert all(one.get("name") in joints for one in top.iter("joint"))


@pytest.mark.skipif(find_spec("pinocchio") is None, reason="Pinocchio is not installed")
def test_pinocchio_reads_the_groups(folder: Path, tmp_path: Path) -> None:
    """Its own parser takes the disabled pairs, and states of groups; of several with one name it keeps the last."""
    import pinocchio

    (tmp_path / "two_description").symlink_to(folder)  # the package, in a folder of its name
    urdf_file, srdf_file = str(folder / "two.urdf"), str(folder / "two.srdf")
    model = pinocchio.buildModelFromUrdf(urdf_file)
    shapes = pinocchio.buildGeomFromUrdf(
        model, urdf_file, pinocchio.GeometryType.COLLISION, package_dirs=[str(tmp_path)]
    )
    shapes.addAllCollisionPairs()
    pairs = len(shapes.collisionPairs)
    pinocchio.removeCollisionPairs(model, shapes, srdf_file)
    assert 0 < len(shapes.collisionPairs) < pairs
    pinocchio.loadReferenceConfigurations(model, srdf_file)
    assert len(model.referenceConfigurations["home"]) == model.nq


DRIVEN = urdf(
    "arm",
    link("base"),
    link("tip"),
    joint("lift", "base", "tip", axis="0 1 0"),
    "<transmission name='t' type='SimpleTransmission'><joint name='lift'>"
    "<hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>"
    "<actuator name='m'/></transmission>",
)


def test_gains_that_a_description_lacks_are_those_of_the_whole(tmp_path: Path, cache: Cache) -> None:
    """SB874:gains states what is written, for each instance, and not what the module alone would have.

    A file of the same name in another folder is not reported where `set` asks for computed gains.
    """
    (tmp_path / "other").mkdir()
    for folder in (tmp_path, tmp_path / "other"):
        (folder / "arm.urdf").write_text(DRIVEN, encoding="utf-8")
    (tmp_path / "arm.robot.yaml").write_text(composing("arm: {file: arm.urdf, prefix: ''}"), encoding="utf-8")
    asked = "set: {actuators: {t: {joint: lift, kind: position, gains: auto}}}"
    modules = (
        "a: {file: arm.urdf}",
        "b: {file: arm.robot.yaml, at: a/tip, offset: {xyz: [0.3, 0, 0]}}",
        f"c: {{file: other/arm.urdf, at: b/arm/tip, {asked}}}",
    )
    (tmp_path / "r.robot.yaml").write_text(composing(*modules), encoding="utf-8")
    made = convert(tmp_path / "r.robot.yaml", Options(tmp_path / "out", ("mjcf",), verify=False, cache=cache))
    assert made.robot is not None
    expected = [
        f"actuator '{one.name}' on '{one.joint}': no gains in the file: kp = {one.kp:g}, kv = {one.kv:g} computed"
        for one in made.robot.actuators
    ]
    found = [(one.message, one.span.line) for one in made.diagnostics if one.code == "SB874:gains"]
    assert found == [(expected[0], 5), (expected[1], 6)]
    assert made.robot.actuators[0].kp > made.robot.actuators[1].kp > made.robot.actuators[2].kp


@pytest.mark.slow
def test_computed_gains_follow_the_load(tmp_path: Path, cache: Cache) -> None:
    """`gains: auto` of the last joints grow with the gripper on them; its own given numbers stay bit for bit."""
    arm, hand = 'arm: {file: "library:ur5e", prefix: ""}', 'hand: {file: "library:2f85", prefix: "", at: arm/tool0}'
    gains, alone_in_report = [], []
    for modules in ((arm,), (arm, hand), (hand.replace(", at: arm/tool0", ""),)):
        (tmp_path / "r.robot.yaml").write_text(composing(*modules), encoding="utf-8")
        made = convert(tmp_path / "r.robot.yaml", Options(tmp_path / "out", ("mjcf",), verify=False, cache=cache))
        assert made.robot is not None
        gains.append({one.name: (one.kp, one.kv) for one in made.robot.actuators})
        reported = json.loads(made.files["report.json"])["robot"]["modules"][0]["gains_alone"]
        alone_in_report.append({one["actuator"]: (one["kp"], one["kv"]) for one in reported})
    alone, together, gripper = gains
    for drive in ("elbow_drive", "wrist_1_drive", "wrist_2_drive", "wrist_3_drive"):
        assert together[drive] > alone[drive], drive
    assert gripper.items() <= together.items()
    assert alone_in_report[1] == alone == alone_in_report[0]


def test_a_module_that_is_too_weak_is_reported_where_it_is_named(composed: Compose) -> None:
    """SB464 of the whole, whose actuator no line of the composing file states."""
    arm = urdf("arm", link("base"), link("tip"), joint("lift", "base", "tip", axis="0 1 0"))
    own = composing("arm: {file: arm.urdf}", more="actuators: {m: {joint: arm/lift, kind: position, gains: auto}}")
    load = urdf("load", link("load", 2000.0))
    modules = ("a: {file: a.robot.yaml}", "load: {file: load.urdf, at: a/arm/tip}")
    files = {"r.robot.yaml": composing(*modules), "a.robot.yaml": own, "arm.urdf": arm, "load.urdf": load}
    diagnostics = Diagnostics()
    composed(files, diagnostics)
    (weak,) = [one for one in diagnostics if one.code == "SB464"]
    assert weak.message.startswith("actuator 'a_m': its effort limit of 10 N m does not hold the joint")
    assert (weak.span.file[-12:], weak.span.line) == ("r.robot.yaml", 5)


def test_excluded_contacts_of_each_module_stay_excluded(composed: Compose) -> None:
    """Under the names that their links have in the whole, beside those of the composing file."""
    links = [link(name) for name in ("base", "one", "two")]
    arm = urdf("arm", *links, joint("a", "base", "one"), joint("b", "one", "two"))
    own = composing("arm: {file: arm.urdf, prefix: ''}", more="excluded_contacts: [[arm/base, arm/two]]")
    more = "excluded_contacts: [[x/arm/one, y/arm/two]]"
    whole = composing("x: {file: x.robot.yaml}", "y: {file: x.robot.yaml, at: x/arm/two}", more=more)
    robot = composed({"r.robot.yaml": whole, "x.robot.yaml": own, "arm.urdf": arm}, Diagnostics())
    assert robot.excluded_contacts == (("x_base", "x_two"), ("x_one", "y_two"), ("y_base", "y_two"))
