"""Snippets of docs/use-it-in.md run if the engine is installed, and are parsed if not."""

import importlib.util
import re
import runpy
import shutil
import subprocess
import sys
import types
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from stepbot.runtime.robot_library import library_robot
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heading", "module", "printed"),
    [
        ("MuJoCo", "mujoco", r"^2 joints at \["),
        ("PyBullet", "pybullet", r"^shoulder \S+\nelbow \S+$"),
        ("Drake", "pydrake", r"^2 positions, "),
        pytest.param("MJX", "mujoco.mjx", r"(?m)^2 joints, \d+ bodies$", marks=pytest.mark.long),
        pytest.param("MuJoCo Warp", "mujoco_warp", r"(?m)^2 joints, \d+ bodies$", marks=pytest.mark.long),
        pytest.param("SAPIEN", "sapien", r"(?m)^2 joints, \d+ links$", marks=pytest.mark.long),
        pytest.param("Genesis", "genesis", r"(?m)^\d+ degrees of freedom, \d+ links$", marks=pytest.mark.long),
        pytest.param("Newton", "newton", r"(?m)^3 joints, masses \[", marks=pytest.mark.long),
    ],
)
def test_snippet_runs(heading: str, module: str, printed: str, folder: Path) -> None:
    """The Python snippet of an engine loads the file and prints the robot."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")
    command = [sys.executable, "-c", block(heading, "python")]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=900)
    assert run.returncode == 0, run.stderr
    stated = "\n".join(line for line in run.stdout.splitlines() if not line.startswith("pybullet build time"))
    assert re.search(printed, stated), run.stdout


CAMERA = """
import numpy as np
from pydrake.geometry import (ClippingRange, ColorRenderCamera, DepthRange, DepthRenderCamera, MakeRenderEngineVtk,
    RenderCameraCore, RenderEngineVtkParams)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.sensors import CameraInfo, RgbdSensor

builder = DiagramBuilder()
plant, graph = AddMultibodyPlantSceneGraph(builder, 0.0)
graph.AddRenderer("vtk", MakeRenderEngineVtk(RenderEngineVtkParams()))
Parser(plant).AddModels("arm/arm.sdf")
plant.Finalize()
core = RenderCameraCore("vtk", CameraInfo(64, 48, 0.8), ClippingRange(0.01, 10.0), RigidTransform())
cameras = ColorRenderCamera(core, False), DepthRenderCamera(core, DepthRange(0.1, 9.0))
sensor = builder.AddSystem(
    RgbdSensor(graph.world_frame_id(), RigidTransform(RollPitchYaw(-np.pi / 2, 0, 0), [0, -1.0, 0.1]), *cameras))
builder.Connect(graph.get_query_output_port(), sensor.query_object_input_port())
diagram = builder.Build()
context = sensor.GetMyContextFromRoot(diagram.CreateDefaultContext())
print(np.isfinite(sensor.depth_image_32F_output_port().Eval(context).data).sum())
"""


@pytest.mark.slow
def test_normals_for_cameras_of_drake(folder: Path, tmp_path: Path) -> None:
    """Every face of every mesh gets its geometric normal, and Drake's camera sees the robot."""
    meshes = tmp_path / "arm" / "meshes"
    shutil.copytree(folder / "arm", tmp_path / "arm")
    before = {path.name: _triangles(path)[0] for path in meshes.glob("*.obj")}
    run = [sys.executable, "-c", block("Drake's cameras", "python")]
    assert subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=100).stderr == ""
    assert before
    for name, corners in before.items():
        after, normals = _triangles(meshes / name)
        assert after == pytest.approx(corners, abs=1e-7)
        geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        geometric /= np.linalg.norm(geometric, axis=1, keepdims=True)
        assert normals == pytest.approx(np.repeat(geometric[:, None], 3, axis=1), abs=1e-4)
    if importlib.util.find_spec("pydrake") is None:
        pytest.skip("pydrake is not installed: its camera saw nothing")
    command = [sys.executable, "-c", CAMERA]
    seen = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=100)
    assert int(seen.stdout.split()[-1]) > 10


def _triangles(path: Path) -> tuple[Any, Any]:
    """Corners (n, 3, 3) of the faces of an OBJ file, and their normals (n, 3, 3), or nothing."""
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    vertices, normals = (np.array([line[1:4] for line in lines if line[:1] == [tag]], float) for tag in ("v", "vn"))
    faces = [[corner.split("/") for corner in line[1:]] for line in lines if line[:1] == ["f"]]
    of = np.array([[int(corner[0]) - 1 for corner in face] for face in faces])
    named = [[int(corner[2]) - 1 for corner in face] for face in faces] if len(normals) else []
    return vertices[of], normals[np.array(named)] if named else normals


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


@pytest.mark.slow
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
