"""``stepbot convert --for``: Python files that load a robot in programs for learning."""

import ast
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from msgspec.structs import replace

import stepbot as api
from stepbot.diagnostics import Diagnostics
from stepbot.formats.learning import PROGRAMS, SIMREADY, program_files
from stepbot.formats.mjcf.learning import rejected_by_mjx
from stepbot.robot.model import Box, Collision, Cylinder, Joint, JointKind, Link, Robot, Sphere
from tests.command_line import convert_once
from tests.processes import python_with
from tests.robots import ROBOTS, two_link_arm

from .conftest import Stepbot

MODULES = {
    "mjlab": "mjlab",
    "maniskill": "mani_skill",
    "genesis": "genesis",
    "isaaclab": "isaaclab",
    "playground": "mujoco_playground",
    "lerobot": "lerobot",
    "newton": "newton",
}
INSTALLED = {"playground": ("playground",), "newton": ("newton", "newton-usd-schemas", "usd-core", "scipy")}
"""Programs that the test installs.

Others take 5 GB and more, or another MuJoCo than stepbot's: ``PYTHON_WITH_MJLAB=/path/to/python`` names an interpreter
that has one.
"""
LOADED = tuple(program for program in PROGRAMS if program in MODULES)
"""Programs that take an arm with a gripper; robosuite has grippers of its own."""
NAMES = ",".join((*LOADED, SIMREADY))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """The arm with a gripper, with a file for each program."""
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    return convert_once(tmp_path_factory, "arm2 for programs", sidecar, "--no-verify", "--for", NAMES).folder


@pytest.mark.slow
def test_layers_for_simready(folder: Path, robot_library: Path, stepbot: Stepbot) -> None:
    """They are in a folder of their own, which `uptodate` compares, and names with the option if it is not given."""
    main = folder / SIMREADY / "arm2" / "usd" / "arm2.usda"
    assert [path.name for path in main.parent.iterdir() if path.is_file()] == [main.name]
    assert 'variantSet "MuJoCo"' in main.read_text(encoding="utf-8")
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    asked = ("uptodate", str(sidecar), "-o", str(folder), "-f", "urdf,mjcf,sdf,usd")
    assert stepbot(*asked, "--for", NAMES).code == 0
    programs = ",".join(LOADED)
    assert "add simready to `--for` of `uptodate`" in stepbot(*asked, "--for", programs, "-v").out


def tree(folder: Path, program: str) -> ast.Module:
    """The file of a program."""
    return ast.parse((folder / f"arm2_{program}.py").read_text(encoding="utf-8"))


def calls(folder: Path, program: str, name: str) -> list[dict[str, Any]]:
    """The literal keywords of each call of a name."""
    found = []
    for node in ast.walk(tree(folder, program)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == name:
            keywords = {keyword.arg or "": keyword.value for keyword in node.keywords}
            found.append({key: _value(value) for key, value in keywords.items()})
    return found


def _value(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        return ast.unparse(node)


@pytest.mark.slow
def test_each_file_loads_a_description_beside_it(folder: Path) -> None:
    """The formats that programs load are written, too, and no name is one of a file that is missing."""
    for program in LOADED:
        (named,) = (
            _value(node.args[0])
            for node in ast.walk(tree(folder, program))
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "with_name"
        )
        assert (folder / named).is_file(), program


def test_numbers_are_those_of_the_robot(folder: Path, robot_library: Path) -> None:
    """Gains, limits and the initial pose, of the sidecar."""
    shoulder, *_ = calls(folder, "isaaclab", "ImplicitActuatorCfg")
    assert shoulder["joint_names_expr"] == ["shoulder"]
    limits = [float(one.partition(": ")[2]) for one in shoulder[""].strip("{}").split(", ")]
    assert limits == [6.0, pytest.approx(1.5707963267948966)]
    (state,) = calls(folder, "isaaclab", "InitialStateCfg")
    home = {"shoulder": 0.0, "elbow": pytest.approx(0.5235987755982988), "finger": 0.015, "finger_mirror": 0.015}
    assert state["joint_pos"] == home
    (control,) = calls(folder, "maniskill", "PDJointPosControllerConfig")
    assert control["stiffness"][0] == shoulder["stiffness"] > 0.0
    assert control["damping"][0] == shoulder["damping"] > 0.0
    assert control["force_limit"][0] == 6.0


def test_uptodate_and_python_expect_the_same_files(
    folder: Path, robot_library: Path, tmp_path: Path, stepbot: Stepbot
) -> None:
    """`uptodate --for` passes on the folder, reports the files without the option, and Python writes the same."""
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    asked = ("uptodate", str(sidecar), "-o", str(folder))
    assert stepbot(*asked, "--for", NAMES).code == 0
    left = stepbot(*asked, "-f", "urdf,sdf,mjcf,usd", "-v").out
    assert "no longer written" in left
    assert all(f"add {program} to `--for` of `uptodate`" in left for program in LOADED)
    result = api.convert(sidecar, output=tmp_path, programs=["mjlab"], formats="mjcf", verify=False)
    assert result.files["arm2_mjlab.py"] == (folder / "arm2_mjlab.py").read_bytes()


@pytest.mark.slow
def test_a_batch_writes_the_same_files(folder: Path, robot_library: Path, tmp_path: Path, stepbot: Stepbot) -> None:
    """`batch --for` writes for each robot what `convert --for` does, and the formats that the programs load."""
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    options = ("-f", "urdf", "--for", "playground,lerobot", "--no-verify")
    assert stepbot("batch", str(sidecar), "-o", str(tmp_path), *options).code == 0
    (written,) = tmp_path.rglob("arm2.xml")
    for program in ("playground", "lerobot"):
        name = f"arm2_{program}.py"
        assert (written.parent / name).read_bytes() == (folder / name).read_bytes()


def test_lerobot_gets_the_longest_chain(folder: Path) -> None:
    """Its joints, whose angles it takes in degrees, lead to the tip; slides are left out."""
    found = {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in tree(folder, "lerobot").body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id != "MODEL"
    }
    assert found["JOINTS"] == ["shoulder", "elbow"] == list(found["HOME"])
    urdf = (folder / "arm2.urdf").read_text(encoding="utf-8")
    assert f'<link name="{found["TIP"]}"' in urdf
    assert found["HOME"]["elbow"] == pytest.approx(0.5235987755982988)


@pytest.mark.parametrize("program", PROGRAMS)
def test_no_name_becomes_code(program: str) -> None:
    """Names of a foreign description, with quotes, backslashes and braces, stay in strings and docstrings."""
    plain, name = two_link_arm(), 'x"""\n{boom()}\nboom()\n"""'
    joints = tuple(replace(one, name=one.name + name) for one in plain.joints)
    actuators = tuple(replace(one, name=name, joint=one.joint + name) for one in plain.actuators)
    foreign = replace(plain, name=name, joints=joints, actuators=actuators)
    ((_, content),) = program_files([program], {PROGRAMS[program].format: foreign}, Diagnostics())[
        PROGRAMS[program].format
    ].items()
    nodes = list(ast.walk(ast.parse(content)))
    assert not [node for node in nodes if isinstance(node, ast.Name) and node.id == "boom"]
    assert any(isinstance(node, ast.Constant) and "boom()" in str(node.value) for node in nodes)


@pytest.mark.parametrize("given", ["mjlab,isaac", "gym"])
def test_unknown_program_is_a_usage_error(given: str, stepbot: Stepbot) -> None:
    """The message lists the programs."""
    run = stepbot("convert", "any.yaml", "--for", given)
    assert run.code == 2
    assert f"no program '{given.rsplit(',', maxsplit=1)[-1]}'; there are {', '.join(PROGRAMS)}" in run.err


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """A UR5e for robosuite."""
    sidecar = robot_library / "universal_robots_ur5e" / "ur5e.robot.yaml"
    options = ("--no-verify", "-f", "mjcf", "--for", "robosuite")
    return convert_once(tmp_path_factory, "ur5e for robosuite", sidecar, *options).folder


def test_robosuite_gets_motors_and_a_hand(arm: Path, stepbot: Stepbot, robot_library: Path, tmp_path: Path) -> None:
    """Torques up to the limits, and a body for grippers at the tool's frame; an arm with a gripper is rejected."""
    file = ast.parse((arm / "ur5e_robosuite.py").read_text(encoding="utf-8"))
    found = {one.targets[0].id: one.value for one in file.body if isinstance(one, ast.Assign)}  # type: ignore[attr-defined]
    effort = ast.literal_eval(found["EFFORT"])
    assert list(effort) == list(ast.literal_eval(found["HOME"]))
    assert list(effort.values()) == [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]
    link, hand = ast.literal_eval(found["HAND"])
    assert (link, hand["name"]) == ("wrist_3_link", "right_hand")
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    run = stepbot("convert", str(sidecar), "-o", str(tmp_path), "-f", "mjcf", "--no-verify", "--for", "robosuite")
    assert run.code == 1
    assert "SB644" in run.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["ball", "universal", "floating_biped", "gripper_with_mimic", "tree"])
def test_robosuite_takes_arms_alone(name: str) -> None:
    """Robots with other joints, branches, followers or without a fixed base are rejected."""
    diagnostics = Diagnostics()
    assert program_files(["robosuite"], {"mjcf": ROBOTS[name]()}, diagnostics) == {}
    assert [one.code for one in diagnostics] == ["SB644"]


def test_maniskill_gets_the_limits_of_speeds() -> None:
    """Of motors and joints the narrower one; ManiSkill itself knows those of positions alone."""
    written = program_files(["maniskill"], {"urdf": ROBOTS["equipped"]()}, Diagnostics())["urdf"]
    (content,) = written.values()
    (control,) = [
        node
        for node in ast.walk(ast.parse(content))
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("PDJointVelControllerConfig")
    ]
    given = {one.arg: ast.literal_eval(one.value) for one in control.keywords if one.arg in ("lower", "upper")}
    assert given == {"lower": [-20.0], "upper": [20.0]}


def test_playground_gets_no_robot_that_mjx_rejects() -> None:
    """A contact sensor, or a cylinder that may touch a box or hull; the remedy is named."""
    diagnostics = Diagnostics()
    assert program_files(["playground"], {"mjcf": ROBOTS["equipped"]()}, diagnostics) == {}
    (one,) = diagnostics
    assert one.code == "SB644"
    assert "{collision: {for: mjx}}" in one.help[0]
    arm = three_in_a_row()
    ends = "'first'", "'third'"
    assert all(name in rejected_by_mjx(arm) for name in ends)
    assert rejected_by_mjx(replace(arm, excluded_contacts=(("first", "third"),))) == ""
    assert rejected_by_mjx(replace(arm, links=(arm.links[0], arm.links[1], replace(arm.links[2], collisions=())))) == ""


def three_in_a_row() -> Robot:
    """A cylinder, a sphere and a box on two joints: neighbours never touch."""
    shapes = {"first": Cylinder(0.1, 0.2), "second": Sphere(0.1), "third": Box((0.1, 0.1, 0.1))}
    links = tuple(Link(name, collisions=(Collision(name, shape),)) for name, shape in shapes.items())
    joints = (Joint("a", JointKind.CONTINUOUS, "first", "second"), Joint("b", JointKind.CONTINUOUS, "second", "third"))
    return Robot("row", links, joints)


@pytest.mark.long
def test_robosuite_lifts_the_hand(arm: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Its controller of torques moves the hand up in the task `Lift`, with a MuJoCo that it works with."""
    python = python_with(("robosuite>=1.5.2,<1.6", "mujoco==3.3.7"), tmp_path_factory.mktemp("robosuite"))
    command = [str(python), "ur5e_robosuite.py"]
    run = subprocess.run(command, cwd=arm, capture_output=True, text=True, timeout=900, check=False)
    assert run.returncode == 0, run.stderr
    rose = float(run.stdout.partition("the hand rose by ")[2].split()[0])
    assert 0.05 < rose < 0.3


@pytest.mark.long
@pytest.mark.parametrize("program", LOADED)
def test_program_loads_the_robot(
    program: str, folder: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Where it is installed or can be, it prints the joints of the robot; SAPIEN loads visuals with a graphics card."""
    python = Path(os.environ.get(f"PYTHON_WITH_{program.upper()}", sys.executable))
    if str(python) == sys.executable and importlib.util.find_spec(MODULES[program]) is None:
        if program not in INSTALLED:
            pytest.skip(f"{MODULES[program]} is not installed")
        python = python_with(INSTALLED[program], tmp_path_factory.mktemp(program))
    if program == "maniskill":
        folder = Path(shutil.copytree(folder, tmp_path / "arm"))
        top = ET.parse(folder / "arm2.urdf")
        for link in top.getroot().findall("link"):
            for visual in link.findall("visual"):
                link.remove(visual)
        top.write(folder / "arm2.urdf")
    command = [str(python), f"arm2_{program}.py"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=900, check=False)
    assert run.returncode == 0, run.stderr
    assert {"shoulder", "elbow"} <= set(run.stdout.split())
