"""Snippets of docs/use-it-in.md run if the engine is installed, and are parsed if not."""

import importlib.util
import re
import runpy
import subprocess
import sys
import types
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from stepbot.jobs.library import library_robot
from stepbot_cli import main

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "use-it-in.md").read_text(encoding="utf-8")


def block(heading: str, language: str) -> str:
    """The code block of a language below a heading of the page."""
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)
    return str(found)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the README's robot, exported, described and converted as documented."""
    folder = tmp_path_factory.mktemp("use it in")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (sidecar,) = re.findall(r"^```yaml\n(.*?)^```$", readme, re.MULTILINE | re.DOTALL)
    (folder / "arm.robot.yaml").write_text(sidecar, encoding="utf-8")
    (folder / "arm2.step").write_bytes(library_robot("arm2").step.read_bytes())
    assert (
        main(
            [
                "convert",
                str(folder / "arm.robot.yaml"),
                "-o",
                str(folder / "arm"),
                "--no-verify",
                "-f",
                "urdf,sdf,mjcf,usd",
            ]
        )
        == 0
    )
    return folder


@pytest.mark.parametrize(
    ("heading", "module", "printed"),
    [
        ("MuJoCo", "mujoco", r"^2 joints at \["),
        ("PyBullet", "pybullet", r"^shoulder \S+\nelbow \S+$"),
        ("Drake", "pydrake", r"^2 positions, "),
        pytest.param("MJX", "mujoco.mjx", r"(?m)^2 joints, \d+ bodies$", marks=pytest.mark.long),
        pytest.param("MuJoCo Warp", "mujoco_warp", r"(?m)^2 joints, \d+ bodies$", marks=pytest.mark.long),
        pytest.param("SAPIEN", "sapien", r"(?m)^2 joints, \d+ links$", marks=pytest.mark.long),
        pytest.param("Newton", "newton", r"(?m)^3 joints, masses \[", marks=pytest.mark.long),
    ],
)
def test_snippet_runs(heading: str, module: str, printed: str, folder: Path) -> None:
    """The Python snippet of an engine loads the file and prints the robot."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")
    command = [sys.executable, "-c", block(heading, "python")]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0, run.stderr
    stated = "\n".join(line for line in run.stdout.splitlines() if not line.startswith("pybullet build time"))
    assert re.search(printed, stated), run.stdout


def test_world_for_gazebo_includes_the_model(folder: Path) -> None:
    """The world is well-formed SDFormat of stepbot's version, and the included model exists."""
    world = ET.fromstring(block("Gazebo", "xml"))
    model = ET.parse(folder / "arm" / "arm.sdf").getroot()
    assert (world.tag, world.attrib["version"]) == (model.tag, model.attrib["version"])
    (uri,) = (element.text or "" for element in world.iter("uri"))
    assert (folder / uri).is_file()


def test_launch_file_for_rviz_finds_every_mesh(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With stand-ins for ROS, the launch file starts three nodes and passes them a URDF whose meshes exist."""
    launch, ros, actions = (types.ModuleType(name) for name in ("launch", "launch_ros", "launch_ros.actions"))
    vars(launch)["LaunchDescription"] = list
    vars(actions)["Node"] = dict
    for module in (launch, ros, actions):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    path = folder / "view.launch.py"
    path.write_text(block("RViz", "python"), encoding="utf-8")
    nodes: list[dict[str, Any]] = runpy.run_path(str(path))["generate_launch_description"]()
    assert [node["package"] for node in nodes] == ["robot_state_publisher", "joint_state_publisher_gui", "rviz2"]
    urdf = ET.fromstring(nodes[0]["parameters"][0]["robot_description"])
    meshes = [element.attrib["filename"] for element in urdf.iter("mesh")]
    assert meshes
    assert all(mesh.startswith("file:///") and Path(mesh.removeprefix("file://")).is_file() for mesh in meshes)


@pytest.mark.parametrize(("number", "name"), [(0, "arm_description"), (1, "my_robots")])
def test_the_commands_for_ros_packages_fill_them(
    number: int, name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The documented commands write what the page lists and its CMake lines install; `package://` finds every mesh."""
    monkeypatch.chdir(folder)
    section = PAGE.partition("\n## ROS 2 package\n")[2].partition("\n## ")[0]
    command = re.findall(r"^```sh\n(.*)\n```$", section, re.MULTILINE)[number]
    assert main([*command.split()[1:], "--no-verify"]) == 0
    package = folder / "src" / name
    rows = re.findall(r"^\| (`.*?) \| (?!if there are actuators)", section, re.MULTILINE)
    listed = [file for row in rows for file in re.findall(r"`(.*?)`", row)]
    installed = re.findall(r"^install\(\w+ (\S+) DESTINATION share/", section, re.MULTILINE)
    assert len(listed) > 8
    for file in installed if number else listed:
        assert (package / file).exists() or (package / "config" / file).exists(), file
    meshes = [element.attrib["filename"] for element in ET.parse(package / "arm.urdf").getroot().iter("mesh")]
    assert meshes
    assert all(mesh.startswith(f"package://{name}/meshes/") for mesh in meshes)
    assert all((folder / "src" / mesh.removeprefix("package://")).is_file() for mesh in meshes)
