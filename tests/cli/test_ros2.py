"""``stepbot convert --ros2``: a ROS 2 package, read by xacro, by the URDF parser of ROS and by engines."""

import importlib.util
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import yourdfpy
from msgspec.structs import replace
from ruamel.yaml import YAML

from stepbot.described.robot import robot_of_description
from stepbot.diagnostics import Diagnostics
from stepbot.engines.describe import describe
from stepbot.engines.observation import Request
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import main_file
from stepbot.formats.urdf.chains import chains
from stepbot.formats.urdf.grippers import groups
from stepbot.formats.urdf.ros2.launch import gazebo_launch
from stepbot.formats.urdf.ros2.moveit import yaml_text
from stepbot.formats.urdf.ros2.package import ros2_package
from stepbot.formats.urdf.ros2.xacro import GAZEBO_HARDWARE
from stepbot.formats.urdf.writer import render
from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.datasheet import accelerations
from stepbot.robot.kinematics import MOVING
from stepbot.robot.metadata import Metadata
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Limit, Link, Mimic, Robot
from stepbot.runtime.programs import sdf_programs
from stepbot.runtime.robot_library import library_robot
from stepbot_cli import main
from tests.devices import equipped
from tests.robots import floating_biped, gripper_with_mimic, odd_names, pendulum, tree, two_link_arm
from tests.simulators.conftest import look

from .conftest import Stepbot

PACKAGE = "arm2_description"
LAUNCHED = ("demo", "gazebo", "view")
URDF = format_named("urdf")
KINDS = ("visual", "collision")
MADE = (two_link_arm, gripper_with_mimic, tree, equipped, odd_names, floating_biped)


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of the arm, converted once."""
    folder = tmp_path_factory.mktemp("workspace") / "src" / PACKAGE
    sidecar = str(library_robot("arm2").sidecar)
    assert main(["convert", sidecar, "-o", str(folder), "--ros2", "arm2", "-f", "urdf", "--no-verify"]) == 0
    return folder


@pytest.fixture
def package(converted: Path, tmp_path: Path) -> Path:
    """A copy of the package, in a workspace."""
    return Path(shutil.copytree(converted, tmp_path / "src" / PACKAGE))


def test_the_manifest_names_all_that_launch_files_need(package: Path) -> None:
    """The packages that they import and whose nodes they start, and those of the plugins in their settings."""
    needed = set()
    for file in (package / "launch").glob("*.py"):
        text = file.read_text(encoding="utf-8")
        needed |= set(re.findall(r"^(?:from|import) (\w+)", text, re.MULTILINE)) - sys.stdlib_module_names
        needed |= set(re.findall(r'(?:package=|share_directory\()"(\w+)"', text))
    manifest = ET.parse(package / "package.xml")
    assert needed <= {one.text for one in manifest.iter("exec_depend")}
    assert {"launch_ros", "controller_manager", "ros_gz_sim", "moveit_configs_utils"} <= needed


def xacro(file: Path, **arguments: str) -> ET.Element:
    """The URDF that xacro makes of a file."""
    program = "import xml.parsers.expat, xacro; xacro.main()"  # 2.1.1 forgets to import what it catches
    command = [sys.executable, "-c", program, str(file), *(f"{name}:={value}" for name, value in arguments.items())]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert run.returncode == 0, run.stderr
    return ET.fromstring(run.stdout)


def plain(element: ET.Element) -> Any:
    """Tag, attributes, text and children of an element; a start is a number of YAML, whatever its digits."""
    text = (element.text or "").strip()
    text = str(float(text)) if element.get("name") == "initial_value" else text
    return element.tag, element.attrib, text, [plain(child) for child in element]


def written(robot: Robot, folder: Path) -> tuple[Robot, ET.Element]:
    """The robot as URDF has it, and its URDF; the files of the package are in the folder."""
    lowered = lower(robot, URDF, Diagnostics())
    for path, data in ros2_package(lowered, "the_package", accelerations(robot)).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(data)
    urdf = render(lowered).decode().replace('filename="meshes/', 'filename="package://the_package/meshes/')
    return lowered, ET.fromstring(urdf)


@pytest.mark.parametrize("make", MADE, ids=lambda make: make.__name__)
def test_xacro_without_arguments_is_the_urdf(make: Any, tmp_path: Path) -> None:
    """Without arguments xacro gives the URDF itself, element by element, whatever the names are."""
    robot, urdf = written(make(), tmp_path)
    made = xacro(tmp_path / "urdf" / f"{robot.name}.urdf.xacro")
    assert made.attrib["name"] == robot.name
    assert [plain(child) for child in made] == [plain(child) for child in urdf]


def test_names_that_xacro_would_evaluate(tmp_path: Path) -> None:
    """Names with `${` and `$(` are written as they are."""
    robot = pendulum()
    names = {"bob": "a ${1 + 1} $(arg x) $$ b"}
    links = tuple(replace(link, name=names.get(link.name, link.name)) for link in robot.links)
    joints = tuple(replace(joint, child=names.get(joint.child, joint.child)) for joint in robot.joints)
    _, urdf = written(replace(robot, links=links, joints=joints), tmp_path)
    made = xacro(tmp_path / "urdf" / f"{robot.name}.urdf.xacro")
    assert [plain(child) for child in made] == [plain(child) for child in urdf]


def test_a_name_with_a_digit_first(tmp_path: Path) -> None:
    """The macro of a robot `2f85` is `_2f85`: an element of XML cannot begin with a digit."""
    _, urdf = written(replace(pendulum(), name="2f85"), tmp_path)
    made = xacro(tmp_path / "urdf" / "2f85.urdf.xacro")
    assert made.attrib["name"] == "2f85"
    assert [plain(child) for child in made] == [plain(child) for child in urdf]


def test_two_robots_with_prefixes_on_one_stand(package: Path) -> None:
    """The macro twice, with prefixes, on one link: one tree with all names once, and the links where they belong."""
    both = package / "urdf" / "both.xacro"
    both.write_text(
        '<robot name="both" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="arm2.macro.xacro"/><link name="stand"/>'
        '<xacro:arm2 prefix="left_" parent="stand" xyz="0 0.5 1" rpy="0 0 1.5"/>'
        '<xacro:arm2 prefix="right_" parent="stand" xyz="0 -0.5 1"/></robot>',
        encoding="utf-8",
    )
    urdf = xacro(both)
    one = ET.parse(package / "arm2.urdf").getroot()
    names = {link.attrib["name"] for link in one.iter("link")}
    made = [link.attrib["name"] for link in urdf.iter("link")]
    assert sorted(made) == sorted(["stand", *(f"{side}{name}" for side in ("left_", "right_") for name in names)])
    file = package / "both.urdf"
    file.write_bytes(ET.tostring(urdf))
    robots = [yourdfpy.URDF.load(str(path), load_meshes=False) for path in (package / "arm2.urdf", file)]
    for side, y, yaw in (("left_", 0.5, 1.5), ("right_", -0.5, 0.0)):
        X_WB = Pose.from_xyz_rpy((0, y, 1), (0, 0, yaw)).matrix
        for name in names:
            np.testing.assert_allclose(
                robots[1].get_transform(f"{side}{name}", "stand"),
                X_WB @ robots[0].get_transform(name, robots[0].base_link),
                atol=1e-12,
            )
    if shutil.which("check_urdf") is not None:
        run = subprocess.run(["check_urdf", str(file)], capture_output=True, text=True, check=False, timeout=60)
        assert run.returncode == 0, run.stderr
        assert "root Link: stand has 2 child(ren)" in run.stdout


def test_mounted_on_the_world(package: Path) -> None:
    """With the arguments of the file, the robot has a prefix and stands on the link `world`."""
    urdf = xacro(package / "urdf" / "arm2.urdf.xacro", prefix="a_", parent="world", xyz="1 2 3")
    (mount,) = [joint for joint in urdf.iter("joint") if joint.attrib["name"] == "a_mount"]
    ends = [mount.find(tag) for tag in ("parent", "child", "origin")]
    assert [dict(end.attrib) for end in ends if end is not None] == [
        {"link": "world"},
        {"link": "a_base"},
        {"xyz": "1 2 3", "rpy": "0 0 0"},
    ]


def test_the_package_is_complete(package: Path) -> None:
    """The manifest names the package, CMake installs folders that exist, and YAML files name joints of the URDF."""
    manifest = ET.parse(package / "package.xml").getroot()
    assert (manifest.findtext("name"), manifest.findtext("export/build_type")) == (PACKAGE, "ament_cmake")
    lines = (package / "CMakeLists.txt").read_text(encoding="utf-8").splitlines()
    installed = [line.partition("(")[2].split(" DESTINATION")[0].split()[1:] for line in lines if "install(" in line]
    names = [name.strip('"') for group in installed for name in group]
    assert {"arm2.urdf", "arm2.srdf", "meshes", "urdf", "launch"} <= set(names)
    assert all((package / name).exists() for name in names)
    urdf = ET.parse(package / "arm2.urdf").getroot()
    moving = {one.attrib["name"] for one in urdf.findall("joint") if one.attrib["type"] != "fixed"}
    settings = {path.name: YAML(typ="safe").load(path) for path in (package / "config").glob("*.yaml")}
    manager = settings["ros2_controllers.yaml"]["controller_manager"]["ros__parameters"]
    controller = settings["ros2_controllers.yaml"]["position_controller"]["ros__parameters"]
    assert manager["position_controller"]["type"] == "joint_trajectory_controller/JointTrajectoryController"
    assert set(controller["joints"]) <= moving
    assert set(settings["joint_limits.yaml"]["joint_limits"]) <= moving
    limits = {one.attrib["name"]: one.find("limit") for one in urdf.findall("joint")}
    for name, limit in settings["joint_limits.yaml"]["joint_limits"].items():
        element = limits[name]
        assert element is not None
        assert limit["max_velocity"] == float(element.attrib["velocity"])


def test_moveit_groups_are_chains_of_the_urdf(package: Path) -> None:
    """Each group is a chain from its base to its tip, has a solver and the drawn pose, and pairs are links."""
    urdf = ET.parse(package / "arm2.urdf").getroot()
    links = {link.attrib["name"] for link in urdf.iter("link")}
    above = {j.find("child").attrib["link"]: j for j in urdf.findall("joint")}  # type: ignore[union-attr]
    srdf = ET.parse(package / "arm2.srdf").getroot()
    solvers = YAML(typ="safe").load(package / "config" / "kinematics.yaml")
    states = {state.attrib["group"]: state for state in srdf.findall("group_state[@name='home']")}
    named = srdf.findall("group")
    assert {group.attrib["name"] for group in named} == set(states)
    chained = [group for group in named if group[0].tag == "chain"]
    assert {group.attrib["name"] for group in chained} == set(solvers)
    for group in chained:
        (chain,) = group
        at, joints = chain.attrib["tip_link"], []
        while at != chain.attrib["base_link"]:
            joints.append(above[at].attrib["name"])
            at = above[at].find("parent").attrib["link"]  # type: ignore[union-attr]
        drawn = {one.attrib["name"]: float(one.attrib["value"]) for one in states[group.attrib["name"]]}
        assert drawn
        assert set(drawn) <= set(joints)
        if "elbow" in drawn:
            assert drawn["elbow"] == pytest.approx(np.pi / 6)
    for pair in srdf.findall("disable_collisions"):
        assert {pair.attrib["link1"], pair.attrib["link2"]} <= links


def test_chains_of_trees() -> None:
    """Chains end where the tree branches; links fixed to each other are one; followers alone are no chain."""
    lowered = lower(tree(), URDF, Diagnostics())
    found = {chain.name: (chain.base, [joint.name for joint in chain.joints]) for chain in chains(lowered)}
    joints = [joint for _, names in found.values() for joint in names]
    independent = [j.name for j in lowered.joints if j.kind.value != "fixed" and j.mimic is None]
    assert sorted(joints) == sorted(independent)
    assert len(found) >= 2
    jaws = lower(gripper_with_mimic(), URDF, Diagnostics())
    assert all(joint.mimic is None for chain in chains(jaws) for joint in chain.joints)


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [
        ((1, 6, 1), [7, 1]),  # as a Sawyer, whose first joint turns its head, too
        ((1, 7, 7, 2), [1, 7, 7, 2]),  # a torso with two arms and a head
        ((6, 2, 1), [6, 2, 1]),  # an arm whose hand has fingers of different lengths
        ((1, 4, 3), [1, 4, 3]),
        ((3, 6, 1), [3, 6, 1]),
    ],
)
def test_an_arm_has_the_joints_before_it(lengths: tuple[int, ...], expected: list[int]) -> None:
    """One that shares them with short chains alone; a frame on the last link changes nothing."""
    links, joints = [Link("root")], list[Joint]()
    before, *after = lengths

    def chain(name: str, on: str, count: int) -> str:
        for number in range(count):
            links.append(Link(f"{name}_{number}"))
            joints.append(Joint(f"{name}_{number}_joint", JointKind.CONTINUOUS, on, links[-1].name))
            on = links[-1].name
        return on

    end = chain("before", "root", before)
    links.append(Link("plate"))
    joints.append(Joint("plate_joint", JointKind.FIXED, end, "plate"))
    for number, count in enumerate(after):
        chain(f"after_{number}", "plate", count)
    found = chains(Robot("robot", tuple(links), tuple(joints)))
    assert [len(one.joints) for one in found] == expected


def launched(package: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What a launch file starts, with stand-ins for ROS: nodes are mappings, other actions tuples."""
    share = {"get_package_share_directory": lambda name: str(package if name == PACKAGE else package.parent / name)}
    modules = {
        "ament_index_python.packages": share,
        "launch": {"LaunchDescription": list},
        "launch.actions": {
            "AppendEnvironmentVariable": lambda name, value: (name, value),
            "DeclareLaunchArgument": lambda name, default_value: (name, default_value),
            "IncludeLaunchDescription": lambda source, launch_arguments: (source, dict(launch_arguments)),
        },
        "launch.launch_description_sources": {"PythonLaunchDescriptionSource": str},
        "launch.substitutions": {"Command": list, "LaunchConfiguration": lambda name: f"<{name}>"},
        "launch_ros.actions": {"Node": dict},
        "launch_ros.parameter_descriptions": {"ParameterValue": lambda value, value_type: value},
    }
    for module, content in modules.items():
        for part in (module.partition(".")[0], module):
            monkeypatch.setitem(sys.modules, part, sys.modules.get(part) or types.ModuleType(part))
        vars(sys.modules[module]).update(content)
    return list(runpy.run_path(str(package / "launch" / name))["generate_launch_description"]())


def test_the_launch_file_starts_three_nodes(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With stand-ins for ROS, the launch file runs xacro on the installed file and shows it in RViz."""
    nodes = [one for one in launched(package, "view.launch.py", monkeypatch) if isinstance(one, dict)]
    assert [node["package"] for node in nodes] == ["robot_state_publisher", "joint_state_publisher_gui", "rviz2"]
    command = "".join(nodes[0]["parameters"][0]["robot_description"])
    file = package / "urdf" / "arm2.urdf.xacro"
    assert command == f"xacro '{file}' prefix:='<prefix>' parent:='<parent>' xyz:='<xyz>' rpy:='<rpy>'"
    assert file.is_file()
    assert Path(nodes[2]["arguments"][1]).is_file()
    view = YAML(typ="safe").load(Path(nodes[2]["arguments"][1]))
    assert view["Visualization Manager"]["Global Options"]["Fixed Frame"] == "base"


def test_the_launch_file_for_gazebo_starts_controllers(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its xacro command gives a robot fixed to the world, with Gazebo's hardware; each spawner has a controller."""
    actions = launched(package, "gazebo.launch.py", monkeypatch)
    assert ("GZ_SIM_RESOURCE_PATH", str(package.parent)) in actions
    nodes = [one for one in actions if isinstance(one, dict)]
    described = next(node for node in nodes if node["package"] == "robot_state_publisher")
    program, file, *arguments = shlex.split("".join(described["parameters"][0]["robot_description"]))
    assert program == "xacro"
    given = dict(argument.split(":=") for argument in arguments)
    urdf = xacro(Path(file), **given)
    assert [joint.find("child").attrib for joint in urdf.iter("joint") if joint.attrib["name"] == "mount"] == [  # type: ignore[union-attr]
        {"link": "base"}
    ]
    assert [plugin.text for plugin in urdf.iterfind("ros2_control/hardware/plugin")] == [GAZEBO_HARDWARE]
    (settings,) = (plugin.findtext("parameters") or "" for plugin in urdf.iterfind("gazebo/plugin"))
    manager = YAML(typ="safe").load(Path(settings))["controller_manager"]["ros__parameters"]
    spawned = [node["arguments"][0] for node in nodes if node["executable"] == "spawner"]
    assert set(spawned) == {name for name, value in manager.items() if isinstance(value, dict)}
    (created,) = (node for node in nodes if node["executable"] == "create")
    assert created["arguments"] == ["-topic", "robot_description", "-name", "arm2", "-z", "0.0"]


def builder_of_moveit(share: Path) -> dict[str, Any]:
    """What MoveIt's ``MoveItConfigsBuilder`` takes from a package without being given a file, as its sources state."""
    load = YAML(typ="safe", pure=True).load
    found = load(share / ".setup_assistant")["moveit_setup_assistant_config"]
    assert found["urdf"]["package"] == PACKAGE
    assert not list((share / "config").glob("*.urdf.xacro")), "it would be taken in place of the stated one"
    names = {path.name.removesuffix("_controllers.yaml") for path in (share / "config").glob("*_controllers.yaml")}
    assert "moveit" in names, "of several files it takes this one"
    settings = ("kinematics", "joint_limits", "pilz_cartesian_limits", "moveit_controllers")
    return {
        "urdf": xacro(share / found["urdf"]["relative_path"]),
        "srdf": ET.parse(share / found["srdf"]["relative_path"]).getroot(),
        **{name: load(share / "config" / f"{name}.yaml") for name in settings},
    }


def test_moveit_finds_all_it_loads(package: Path) -> None:
    """The builder finds a URDF, groups with solvers, controllers of driven joints and limits that are no integers."""
    found = builder_of_moveit(package)
    joints = {joint.attrib["name"] for joint in found["urdf"].iter("joint") if "type" in joint.attrib}
    manager = found["moveit_controllers"]["moveit_simple_controller_manager"]
    controllers = YAML(typ="safe").load(package / "config" / "ros2_controllers.yaml")
    for name in manager["controller_names"]:
        assert manager[name]["joints"] == controllers[name]["ros__parameters"]["joints"]
        assert set(manager[name]["joints"]) <= joints
    groups = {group.attrib["name"]: group for group in found["srdf"].iter("group")}
    assert set(found["kinematics"]) == {name for name, group in groups.items() if group.find("chain") is not None}
    for end in found["srdf"].iter("end_effector"):
        assert {end.attrib["group"], end.attrib["parent_group"]} <= set(groups)
    (virtual,) = found["srdf"].iter("virtual_joint")
    assert virtual.attrib["child_link"] == "base"
    for limits in (found["pilz_cartesian_limits"]["cartesian_limits"], *found["joint_limits"]["joint_limits"].values()):
        assert all(isinstance(value, float | bool) for value in limits.values()), "ROS rejects integers there"


def test_the_demo_starts_all_controllers(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With stand-ins for ROS and MoveIt the demo starts the controllers of its settings, with the written package."""
    asked = []

    class Builder:
        package_path = package

        def __init__(self, robot: str, package_name: str) -> None:
            asked.append((robot, package_name))

        def to_moveit_configs(self) -> "Builder":
            return self

    names = ("move_group", "moveit_rviz", "rsp", "static_virtual_joint_tfs")
    makers = {f"generate_{name}_launch": lambda _, name=name: types.SimpleNamespace(entities=[name]) for name in names}
    for name, content in {"": {"MoveItConfigsBuilder": Builder}, ".launches": makers}.items():
        module = types.ModuleType(f"moveit_configs_utils{name}")
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, module.__name__, module)
    actions = launched(package, "demo.launch.py", monkeypatch)
    assert asked == [("arm2", PACKAGE)]
    assert sorted(one for one in actions if isinstance(one, str)) == sorted(names)
    nodes = [one for one in actions if isinstance(one, dict)]
    (settings,) = (node["parameters"][0] for node in nodes if node["executable"] == "ros2_control_node")
    manager = YAML(typ="safe").load(Path(settings))["controller_manager"]["ros__parameters"]
    spawned = {node["arguments"][0] for node in nodes if node["executable"] == "spawner"}
    assert spawned == {name for name, value in manager.items() if isinstance(value, dict)}


def test_placeholders_start_in_the_drawn_pose(package: Path, tmp_path: Path) -> None:
    """The drawn pose is in the URDF, in YAML, and in the xacro, where other positions can be given; it is read back."""
    urdf = package / "arm2.urdf"
    read = robot_of_description(describe(str(urdf), "urdf", (package.parent,)), "arm2", urdf.name).robot
    stated = YAML(typ="safe").load(package / "config" / "initial_positions.yaml")["initial_positions"]
    assert stated["elbow"] == pytest.approx(np.pi / 6)
    assert {name: read.joint_by_name[name].drawn_position for name in stated} == stated
    other = tmp_path / "other.yaml"
    other.write_text("initial_positions: {elbow: 0.25}\n", encoding="utf-8")
    made = xacro(package / "urdf" / "arm2.urdf.xacro", initial_positions_file=str(other))
    path = "ros2_control/joint[@name='{}']/state_interface/param[@name='initial_value']"
    assert float(made.findtext(path.format("elbow")) or "nan") == 0.25
    assert float(made.findtext(path.format("shoulder")) or "nan") == stated["shoulder"], "the drawn pose elsewhere"


@pytest.mark.slow
@pytest.mark.parametrize("make", [tree, gripper_with_mimic, floating_biped], ids=lambda make: make.__name__)
def test_all_links_have_a_place_in_rviz(make: Any, tmp_path: Path) -> None:
    """Where one joint is driven, the placeholder and Gazebo state all others but mimics; other hardware has its own."""
    robot = make()
    moving = [one for one in robot.joints if one.kind in MOVING and one.mimic is None]
    leader = moving[0]
    motor = Actuator("motor", leader.name, ActuatorKind.POSITION, kp=1.0)
    lowered, _ = written(replace(robot, actuators=(motor,)), tmp_path)
    expected = [one for one in lowered.joints if one.kind in MOVING and one.mimic is None and one.name != leader.name]
    file = tmp_path / "urdf" / f"{robot.name}.urdf.xacro"
    for arguments in ({}, {"hardware": GAZEBO_HARDWARE}, {"hardware": "makers/Driver"}):
        joints = {one.get("name"): one for one in xacro(file, **arguments).iterfind("ros2_control/joint")}
        assert joints.pop(leader.name).find("command_interface") is not None
        assert list(joints) == ([] if "makers/Driver" in arguments.values() else [one.name for one in expected])
        for one in expected if joints else ():
            assert joints[one.name].find("command_interface") is None
            start = joints[one.name].findtext("state_interface/param[@name='initial_value']")
            assert float(start or "nan") == one.drawn_position
            stated = [interface.get("name") for interface in joints[one.name].iterfind("state_interface")]
            assert stated == ["position", "velocity", "effort"]


def test_numbers_are_numbers_in_yaml_1_1() -> None:
    """Python's launch files read YAML 1.1, in which `1e-05` is a text: it has a point, as ROS wants of a double."""
    texts = yaml_text({"a": 1e-05, "b": 1e16, "c": 3.0, "d": 0.25, "e": 100}).split()[1::2]
    assert texts == ["1.0e-05", "1.0e+16", "3.0", "0.25", "100"]
    assert [float(text) for text in texts] == [1e-05, 1e16, 3.0, 0.25, 100.0]


@pytest.mark.parametrize("kinds", [("position", "effort"), ("effort", "position")])
def test_inputs_of_two_actuators_on_one_joint_are_read_back(kinds: tuple[str, str], tmp_path: Path) -> None:
    """No tag of ROS 1 is needed: the first transmission of a joint has its first command interface, with its gear."""
    robot = equipped()
    words = {"position": ActuatorKind.POSITION, "effort": ActuatorKind.MOTOR}
    gears = (5.0, 7.0)
    actuators = tuple(
        Actuator(f"{kind}_drive", "shoulder", words[kind], 10.0 * (kind == "position"), 0.0, gear)
        for kind, gear in zip(kinds, gears, strict=True)
    )
    lowered = lower(replace(robot, actuators=actuators), URDF, Diagnostics())
    file = tmp_path / "two.urdf"
    file.write_bytes(render(lowered))
    text = file.read_text(encoding="utf-8")
    assert "hardwareInterface" not in text
    assert "mechanicalReduction" not in text
    seen = {one.name: (one.kind, one.gear) for one in look("extensions", Request(str(file), "urdf")).actuators or ()}
    assert seen == {one.name: (one.kind.value, one.gear) for one in actuators}


def test_a_floating_robot_stands_on_the_floor_of_gazebo() -> None:
    """It is not mounted on the world; the height is the report's."""
    robot = lower(floating_biped(), URDF, Diagnostics())
    text = gazebo_launch(robot, "the_package")
    assert "parent:=world" not in text
    (height,) = re.findall(r"^HEIGHT = '(.*)'$", text, re.MULTILINE)
    assert float(height) == standing_height(robot, {}) > 0.0


def test_grippers_are_end_effectors(package: Path) -> None:
    """The fingers are one group without a solver, at the end of the arm; its link is in the arm's chain."""
    srdf = ET.parse(package / "arm2.srdf").getroot()
    (end,) = srdf.findall("end_effector")
    assert end.attrib == {
        "name": "forearm_gripper",
        "parent_link": "forearm",
        "group": "forearm_gripper",
        "parent_group": "tool0",
    }
    (group,) = (one for one in srdf.findall("group") if one.attrib["name"] == "forearm_gripper")
    assert [(one.tag, one.attrib["name"]) for one in group] == [("joint", "finger"), ("joint", "finger_mirror")]
    states = [state for state in srdf.findall("group_state") if state.attrib["group"] == "forearm_gripper"]
    assert [[joint.attrib["name"] for joint in state] for state in states] == [["finger"]] * len(states)
    assert set(YAML(typ="safe").load(package / "config" / "kinematics.yaml")) == {"tool0"}


def hand(*fingers: Joint) -> Robot:
    """A hand at the end of an arm of one joint, with a flange between."""
    turned = Pose.from_xyz_rpy((0.0, 0.0, 0.1), (0.3, 0.2, 1.0))
    arm = (
        Joint("wrist", JointKind.REVOLUTE, "base", "forearm", limit=Limit(-1.0, 1.0)),
        Joint("flange", JointKind.FIXED, "forearm", "palm", turned),
    )
    links = tuple(Link(name) for name in ("base", "forearm", "palm", *(finger.child for finger in fingers)))
    return Robot("hand", links, (*arm, *fingers))


def finger(name: str, axis: tuple[float, float, float], kind: JointKind, mimic: Mimic | None = None) -> Joint:
    """A finger on the palm."""
    return Joint(name, kind, "palm", f"{name}_link", Pose.of(position=(0.0, 0.02, 0.0)), axis, mimic=mimic)


SLIDE, TURN = JointKind.PRISMATIC, JointKind.REVOLUTE


@pytest.mark.parametrize(
    ("fingers", "grips"),
    [
        ((finger("a", (0, 1, 0), SLIDE), finger("b", (0, -1, 0), SLIDE)), True),
        ((finger("a", (0, 1, 0), SLIDE), finger("b", (0, 1, 0), SLIDE, Mimic("a", -1.0))), True),
        ((finger("a", (1, 0, 0), TURN), finger("b", (1, 0, 0), TURN, Mimic("a", -1.0))), True),
        ((finger("a", (0, 1, 0), SLIDE), finger("b", (0, 1, 0), SLIDE)), False),  # side by side
        ((finger("a", (1, 0, 0), TURN), finger("b", (-1, 0, 0), TURN)), False),  # two wheels
        ((finger("a", (1, 0, 0), TURN), finger("b", (1, 0, 0), TURN, Mimic("a", 1.0))), False),  # a parallelogram
        ((finger("a", (1, 0, 0), TURN, Mimic("wrist")), finger("b", (-1, 0, 0), TURN, Mimic("wrist"))), False),
        ((finger("a", (1, 0, 0), TURN),), False),
    ],
)
def test_what_is_a_gripper(fingers: tuple[Joint, ...], grips: bool) -> None:
    """Fingers that move in opposite directions, by one joint or each by a slide of its own."""
    robot = hand(*fingers)
    chains_left, grippers = groups(robot)
    found = [(one.name, one.arm, one.link, [joint.name for joint in one.joints]) for one in grippers]
    assert found == ([("palm_gripper", "palm", "palm", [joint.name for joint in fingers])] if grips else [])
    assert len(chains_left) == (1 if grips else len(chains(robot)))


@pytest.mark.parametrize(
    ("name", "link", "upper", "kind", "is_jaw"),
    [
        ("Moving_Jaw_SO101_joint", "link_6", 1.7, TURN, True),
        ("j6", "gripper", 1.7, TURN, True),
        ("finger1", "f", 0.04, SLIDE, True),
        ("gripper", "tool", 6.0, TURN, False),  # the roll of a gripper without fingers
        ("gripper", "tool", np.inf, JointKind.CONTINUOUS, False),
        ("jawbone_pan", "head", 1.7, TURN, False),
        ("wrist_roll", "link_6", 1.7, TURN, False),
    ],
)
def test_a_single_jaw_is_known_by_its_name(name: str, link: str, upper: float, kind: JointKind, is_jaw: bool) -> None:
    """The last joint of an arm is an end effector if it is named like a jaw and opens like one."""
    lower_limit = -upper if np.isinf(upper) else 0.0
    joint = replace(finger(name, (1, 0, 0), kind), child=link, limit=Limit(lower_limit, upper))
    robot = hand(joint)
    (arm,), grippers = groups(robot)
    assert [one.is_by_name for one in grippers] == [True] * is_jaw
    assert [one.name for one in arm.joints] == (["wrist"] if is_jaw else ["wrist", name])
    assert arm.tip == ("palm" if is_jaw else link)
    if is_jaw:
        (gripper,) = grippers
        assert (gripper.name, gripper.arm, gripper.link) == ("palm_gripper", "palm", "palm")


def test_parallel_fingers_on_the_root_have_no_arm() -> None:
    """A gripper on its own keeps its chains: MoveIt's end effectors have a parent group."""
    left, right = finger("a", (0, 1, 0), SLIDE), finger("b", (0, -1, 0), SLIDE)
    robot = Robot("gripper", (Link("palm"), Link("a_link"), Link("b_link")), (left, right))
    assert groups(robot) == (chains(robot), ())


def test_pinocchio_reads_the_srdf(package: Path) -> None:
    """Pinocchio's parser finds the states, and removes the pairs that need no check."""
    if importlib.util.find_spec("pinocchio") is None:
        pytest.skip("pinocchio is not installed")
    program = """
import sys
import pinocchio
urdf, srdf = sys.argv[1:]
model = pinocchio.buildModelFromUrdf(urdf)
shapes = pinocchio.GeometryModel()
pinocchio.loadReferenceConfigurations(model, srdf)
found = model.referenceConfigurations
home = dict(zip(model.names.tolist()[1:], found["home"].tolist()))
print(sorted(one.key() for one in found), *(repr(home[name]) for name in ("shoulder", "elbow")))
"""
    command = [sys.executable, "-c", program, str(package / "arm2.urdf"), str(package / "arm2.srdf")]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert run.returncode == 0, run.stderr
    srdf = ET.parse(package / "arm2.srdf").getroot()
    drawn = {one.attrib["name"]: one.attrib["value"] for one in srdf.iterfind("group_state[@name='home']/joint")}
    states, shoulder, elbow = run.stdout.rsplit(maxsplit=2)
    assert states == str(sorted({state.attrib["name"] for state in srdf.iter("group_state")}))
    assert (float(shoulder), float(elbow)) == (float(drawn["shoulder"]), float(drawn["elbow"]))


def installed_by_hand(package: Path, install: Path) -> Path:
    """The folder that ROS reads, with what the rules of CMake name."""
    share = install / "share" / PACKAGE
    share.mkdir(parents=True)
    lines = (package / "CMakeLists.txt").read_text(encoding="utf-8").splitlines()
    for what, names in re.findall(r"^install\((FILES|DIRECTORY) (.*) DESTINATION", "\n".join(lines), re.MULTILINE):
        for name in names.replace('"', "").split():
            (shutil.copytree if what == "DIRECTORY" else shutil.copy)(package / name, share / name)
    return share


def built_by_colcon(package: Path, install: Path) -> Path:
    """The folder that ROS finds by its index after a build, as in any workspace, with Debian's programs of ROS 2."""
    if shutil.which("colcon", path="/usr/bin") is None or not Path("/usr/share/ament_cmake").is_dir():
        pytest.skip("apt-get install colcon python3-colcon-ros python3-colcon-cmake ament-cmake python3-ament-index")
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(install.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    find = f"from ament_index_python.packages import *; print(get_package_share_directory('{PACKAGE}'))"
    script = (
        f"colcon build --base-paths '{package}' --install-base '{install}' >&2\n"
        f". '{install}/setup.sh'\n/usr/bin/python3 -c \"{find}\"\n"
    )
    run = subprocess.run(
        ["sh", "-e", "-c", script], cwd=install.parent, env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "warning" not in run.stderr.lower()
    return Path(run.stdout.strip())


@pytest.mark.parametrize("installed", [installed_by_hand, pytest.param(built_by_colcon, marks=pytest.mark.slow)])
def test_a_fresh_tree_has_all_that_ros_reads(
    package: Path, tmp_path: Path, installed: Callable[[Path, Path], Path]
) -> None:
    """What CMake installs is enough: xacro, check_urdf and the paths of all meshes, in a tree with nothing else."""
    share = installed(package, tmp_path / "install")
    assert share.name == PACKAGE
    shutil.rmtree(package)
    urdf = xacro(share / "urdf" / "arm2.urdf.xacro", parent="world")
    meshes = [mesh.attrib["filename"] for mesh in urdf.iter("mesh")]
    assert meshes
    assert all((share.parent / mesh.removeprefix("package://")).is_file() for mesh in meshes)
    assert {path.name for path in (share / "launch").iterdir()} == {f"{name}.launch.py" for name in LAUNCHED}
    file = tmp_path / "robot.urdf"
    file.write_bytes(ET.tostring(urdf))
    if shutil.which("check_urdf") is None:
        pytest.skip("check_urdf of liburdfdom-tools is not installed")
    run = subprocess.run(["check_urdf", str(file)], capture_output=True, text=True, check=False, timeout=60)
    assert run.returncode == 0, run.stderr
    assert "root Link: world has 1 child(ren)" in run.stdout


def test_the_manifest_states_what_the_sidecar_does(stepbot: Stepbot, arm: Path) -> None:
    """Maintainer, licence and version are the sidecar's; without them there is a warning with what to write."""
    command = ("convert", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf", "--no-verify")
    sidecar = arm / "arm2.robot.yaml"
    bare = sidecar.read_text(encoding="utf-8").partition("\nmetadata:")[0]
    sidecar.write_text(bare, encoding="utf-8")
    run = stepbot(*command)
    assert run.code == 0
    (remedy,) = re.findall(r"metadata: \{.*\}", run.err.replace("ada@example.com", "ada@lovelace.org"))
    sidecar.write_text(f"{bare}\n{remedy.strip('`')[:-1]}, version: '2.0.1'}}\n", encoding="utf-8")
    run = stepbot(*command)
    assert "SB640" not in run.err
    manifest = ET.parse(arm / "out" / "package.xml").getroot()
    (maintainer,) = manifest.findall("maintainer")
    assert (maintainer.text, maintainer.attrib) == ("Ada Lovelace", {"email": "ada@lovelace.org"})
    assert [manifest.findtext(name) for name in ("license", "version")] == ["Apache-2.0", "2.0.1"]


def test_a_placeholder_as_maintainer_is_reported(stepbot: Stepbot, arm: Path) -> None:
    """The library's sidecars have an address that nobody reads: packages of users state their own."""
    command = ["convert", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf", "--no-verify"]
    run = stepbot(*command)
    assert run.code == 0
    placeholder = "stepbot robot library <stepbot@example.com>"
    assert f"warning[SB640]: the package has a placeholder as maintainer: {placeholder}" in run.err
    assert "no license" not in run.err
    (remedy,) = re.findall(r"`(--maintainer '.*')`", run.err.replace("ada@example.com", "ada@lovelace.org"))
    run = stepbot(*command, *shlex.split(remedy), "--license", "MIT")
    assert "SB640" not in run.err
    manifest = ET.parse(arm / "out" / "package.xml").getroot()
    (maintainer,) = manifest.findall("maintainer")
    assert (maintainer.text, maintainer.attrib) == ("Ada Lovelace", {"email": "ada@lovelace.org"})
    assert manifest.findtext("license") == "MIT"
    uptodate = ["uptodate", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf"]
    assert stepbot(*uptodate, *shlex.split(remedy), "--license", "MIT").code == 0
    assert "package.xml" in stepbot(*uptodate).out


@pytest.mark.parametrize(
    ("stated", "suffix"), [("", "stl"), ("mesh: {format: obj}", "obj"), ("mesh: {visual: dae}", "dae")]
)
def test_visual_meshes_have_the_colours_of_the_urdf_in_rviz(
    stepbot: Stepbot, arm: Path, stated: str, suffix: str
) -> None:
    """They are STL where the sidecar states no format: RViz shows OBJ files grey, whatever the URDF says."""
    sidecar = arm / "arm2.robot.yaml"
    sidecar.write_text(f"{sidecar.read_text(encoding='utf-8')}\n{stated}\n", encoding="utf-8")
    command = ["convert", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf,sdf", "--no-verify"]
    assert stepbot(*command).code == 0
    urdf = ET.parse(arm / "out" / "arm2.urdf").getroot()
    names = {kind: {one.attrib["filename"] for one in urdf.iterfind(f"link/{kind}/geometry/mesh")} for kind in KINDS}
    assert {name.rpartition(".")[2] for name in names["visual"]} == {suffix}
    assert {name.rpartition(".")[2] for name in names["collision"]} <= {"obj"}
    assert all((arm / "out" / name.partition("arm2_description/")[2]).is_file() for name in names["visual"])
    in_sdf = {uri.text or "" for uri in ET.parse(arm / "out" / "arm2.sdf").getroot().iter("uri") if uri.text}
    visuals = {uri for uri in in_sdf if uri.startswith("meshes/") and not uri.endswith(".obj")}
    assert {uri.rpartition(".")[2] for uri in visuals} == ({suffix} if suffix == "dae" else set())


def test_a_maintainer_has_a_name_and_an_address(stepbot: Stepbot, arm: Path) -> None:
    """Anything else is a usage error."""
    run = stepbot("convert", "arm2.robot.yaml", "--ros2", "arm2", "--maintainer", "Ada")
    assert run.code == 2
    assert "expected a name and an address" in run.err


def test_a_description_states_its_maintainer_by_options(stepbot: Stepbot, tmp_path: Path) -> None:
    """A URDF as source has no sidecar to write one into."""
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    source, folder = tmp_path / "cart.urdf", tmp_path / "out"
    source.write_text(f'<robot name="cart"><link name="base">{body}</link></robot>', encoding="utf-8")
    command = ["convert", str(source), "-o", str(folder), "-f", "urdf", "--ros2", "cart", "--base", "fixed"]
    asked = ["--maintainer", "Ada Lovelace <ada@lovelace.org>", "--license", "MIT", "--no-verify"]
    run = stepbot(*command, *asked)
    assert run.code == 0, run.err
    assert "SB640" not in run.err
    assert ET.parse(folder / "package.xml").getroot().findtext("license") == "MIT"


@pytest.mark.parametrize(
    ("address", "is_placeholder"),
    [
        ("a@example.com", True),
        ("a@Example.ORG", True),
        ("a@mail.example.net", True),
        ("a@robots.example", True),
        ("a@host.invalid", True),
        ("a@localhost", True),
        ("a@notexample.com", False),
        ("a@example.com.br", False),
        ("a@contest", False),
        ("", False),
    ],
)
def test_domains_for_examples(address: str, is_placeholder: bool) -> None:
    """Those that RFC 2606 reserves."""
    assert Metadata(email=address).is_placeholder is is_placeholder


@pytest.mark.slow
def test_engines_prove_the_urdf_of_the_package(stepbot: Stepbot, arm: Path) -> None:
    """The conversion of a package is verified like any other; `--package` and other formats do not fit."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf")
    assert run.code == 0, run.err
    assert "proven: URDF matches the CAD" in run.out
    assert stepbot("uptodate", "arm2.robot.yaml", "-o", "out", "--ros2", "arm2", "-f", "urdf").code == 0
    assert stepbot("convert", "arm2.robot.yaml", "--ros2", "arm2", "--package", "arm2_x").code == 2
    assert stepbot("convert", "arm2.robot.yaml", "--ros2", "arm2", "-f", "mjcf").code == 2
    assert main_file(pendulum(), URDF) == "pendulum.urdf"


def with_balls() -> Robot:
    """An arm with a ball joint, which URDF has as three joints with links without mass between them."""
    arm = two_link_arm()
    ball = replace(arm.joints[-1], kind=JointKind.BALL, limit=Limit())
    bare = tuple(replace(link, visuals=(), collisions=()) for link in arm.links)
    return replace(arm, links=bare, joints=(*arm.joints[:-1], ball), meshes=(), actuators=(), sensors=())


def test_massless_links_get_a_mass_for_gazebo_alone(tmp_path: Path) -> None:
    """The launch file for Gazebo gives a mass to moving links that have none; the URDF and other callers do not."""
    robot, urdf = written(with_balls(), tmp_path)
    light = {link.get("name") for link in urdf.findall("link") if link.find("inertial/mass[@value='0']") is not None}
    file = tmp_path / "urdf" / f"{robot.name}.urdf.xacro"
    same = ET.tostring(xacro(file), encoding="unicode").replace('"0.0"', '"0"')  # 0 times a number is 0.0
    assert plain(ET.fromstring(same)) == plain(urdf)
    heavy = xacro(file, least_mass="1e-5")
    masses = {link.get("name"): float(link.find("inertial/mass").get("value")) for link in heavy.findall("link")}  # type: ignore[union-attr, arg-type]
    given = {name for name, mass in masses.items() if mass == 1e-5}
    assert len(given) == 2
    assert given < light  # frames are fixed
    assert "least_mass:=1e-05" in (tmp_path / "launch" / "gazebo.launch.py").read_text(encoding="utf-8")


def with_a_massless_base() -> Robot:
    """An arm on a link without mass that holds another one, whose joint libsdformat merges first."""
    arm = two_link_arm()
    links = (Link("stand"), *arm.links, Link("a_tag"))
    fixed = (
        Joint("z_foot", JointKind.FIXED, "stand", arm.root.name),
        Joint("a_tag", JointKind.FIXED, "stand", "a_tag"),
    )
    bare = tuple(replace(link, visuals=(), collisions=()) for link in links)
    return replace(arm, links=bare, joints=(*fixed, *arm.joints), meshes=(), actuators=(), sensors=())


def test_massless_links_on_massless_ones_have_no_inertia_in_gazebo(tmp_path: Path) -> None:
    """libsdformat divides by the mass of links that it merges; other callers get the URDF's explicit zero."""
    robot, urdf = written(with_a_massless_base(), tmp_path)
    file = tmp_path / "urdf" / f"{robot.name}.urdf.xacro"
    assert plain(xacro(file)) == plain(urdf)
    bare = [
        link.get("name") for link in xacro(file, least_mass="1e-05").findall("link") if link.find("inertial") is None
    ]
    assert "a_tag" in bare
    assert "stand" not in bare
    assert "least_mass:=1e-05" in (tmp_path / "launch" / "gazebo.launch.py").read_text(encoding="utf-8")


@pytest.mark.skipif(not any(sdf_programs()), reason="libsdformat is not installed")
@pytest.mark.parametrize("drawn", [with_balls, with_a_massless_base])
def test_gazebo_converts_all_links(drawn: Callable[[], Robot], tmp_path: Path) -> None:
    """libsdformat's own conversion of what the launch file spawns has every moving joint, and the whole mass."""
    robot, urdf = written(drawn(), tmp_path)
    moving = {joint.get("name") for joint in urdf.findall("joint") if joint.get("type") != "fixed"}
    spawned = tmp_path / "spawned.urdf"
    for least, complete in (("0", False), ("1e-5", True)):
        made = xacro(tmp_path / "urdf" / f"{robot.name}.urdf.xacro", parent="world", least_mass=least)
        spawned.write_bytes(ET.tostring(made))
        command = [next(sdf_programs()), "sdf", "-p", str(spawned)]
        text = subprocess.run(command, capture_output=True, text=True, check=complete, timeout=60).stdout
        if "<sdf" not in text and not complete:
            continue
        model = ET.fromstring(text[text.index("<sdf") :])
        kept = {joint.get("name") for joint in model.iter("joint") if joint.get("type") != "fixed"}
        assert (kept == moving) == complete
        total = sum(float(mass.text or 0.0) for mass in model.iter("mass"))
        assert (abs(total - sum(link.mass_properties.mass for link in robot.links)) < 1e-4) == complete
