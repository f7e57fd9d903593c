"""Rules for every discovered format, on every robot."""

import copy
import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS, format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import MeshFormat, MeshFormats, Robot
from stepbot.robot.multi_dof import steps_by_child
from tests.robots import ROBOTS, every_robot

every_format = pytest.mark.parametrize("format_", FORMATS)
every_xml_format = pytest.mark.parametrize("format_", [one.name for one in FORMATS.values() if one.root])

RENDER_ALL = """
from tests.conformance.test_every_writer import digest_of_all
print(digest_of_all())
"""


def digest_of_all() -> str:
    """A hash of the files of every robot in every format, and of one robot with meshes in every format of theirs."""
    robots = [build() for build in ROBOTS.values()]
    robots += [replace(ROBOTS["tree"](), mesh_formats=MeshFormats(one, one)) for one in MeshFormat]
    digest = hashlib.sha256()
    for robot in robots:
        for name in FORMATS:
            for path, content in render(robot, name, Diagnostics()).items():
                digest.update(path.encode() + content)
    return digest.hexdigest()


def mesh_bytes(robot: Robot) -> list[bytes]:
    """Vertices and faces of all meshes of a robot."""
    return [asset.mesh.vertices.tobytes() + asset.mesh.faces.tobytes() for asset in robot.meshes]


@every_format
@every_robot
def test_same_input_same_bytes(name: str, format_: str) -> None:
    """Two robots with equal content have equal files in equal order."""
    first, second = (list(render(ROBOTS[name](), format_, Diagnostics()).items()) for _ in range(2))
    assert first == second


@pytest.mark.long  # tests/cli/test_determinism.py does it with whole conversions
def test_bytes_depend_on_nothing_around(tmp_path: Path) -> None:
    """Another hash seed, locale and working directory than those of this process change no byte."""
    root = Path(__file__).resolve().parents[2]
    paths = os.pathsep.join([str(root), str(root / "src")])
    environment = {**os.environ, "PYTHONHASHSEED": "4242", "LC_ALL": "de_DE.UTF-8", "PYTHONPATH": paths}
    run = subprocess.run(
        [sys.executable, "-c", RENDER_ALL], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stdout == digest_of_all() + "\n"


@every_format
@every_robot
def test_robot_is_left_as_it_was(name: str, format_: str) -> None:
    """A writer does not change the given robot."""
    robot = ROBOTS[name]()
    before, meshes = copy.deepcopy(robot.links + robot.joints + robot.closures), mesh_bytes(robot)
    render(robot, format_, Diagnostics())
    assert robot.links + robot.joints + robot.closures == before
    assert mesh_bytes(robot) == meshes


@every_xml_format
@every_robot
def test_every_name_is_in_the_file(name: str, format_: str) -> None:
    """Names of the robot, links and joints are in the file unchanged, unless the format has no place for them."""
    robot = lower(ROBOTS[name](), FORMATS[format_], Diagnostics())
    files = render(ROBOTS[name](), format_, Diagnostics())
    top = etree.fromstring(files[f"{robot.name}{FORMATS[format_].suffix}"])
    names = {element.get("name") for element in top.iter("*")} | {top.get("model")}
    stated = {robot.name, *(link.name for link in robot.links), *(frame.name for frame in robot.frames)}
    stated |= {shape.name for link in robot.links for shape in (*link.visuals, *link.collisions)}
    stated |= {closure.name for closure in robot.closures}
    if format_ != "sdf":  # plugins refer to actuators by their joints
        stated |= {actuator.name for actuator in robot.actuators}
    if format_ == "mjcf":  # fixed joints and the parts of a multi-dof joint have no names
        stated |= {step.name for steps in steps_by_child(robot).values() for step in steps if step.kind != "fixed"}
    else:
        stated |= {joint.name for joint in robot.joints}
    assert stated <= names


@every_xml_format
@every_robot
def test_every_mesh_is_written_and_referred_to(name: str, format_: str) -> None:
    """The file refers to exactly its own meshes, by relative paths."""
    robot = ROBOTS[name]()
    files = render(robot, format_, Diagnostics())
    main, *others = files
    meshes = [path for path in others if path.startswith("meshes/")]
    top = etree.fromstring(files[main])
    attributes = {element.get(key) for element in top.iter("mesh") for key in ("filename", "file")}
    referred = attributes | {element.text for element in top.iter("uri")}
    assert referred - {None} == set(meshes) == {file.path for file in MeshFiles(robot).all}


def test_meshes_read_back_by_trimesh() -> None:
    """An OBJ file contains one object in metres, with the vertices and faces of the asset."""
    import trimesh

    robot = ROBOTS["tree"]()
    files = render(robot, "urdf", Diagnostics())
    for asset in robot.meshes:
        read = trimesh.load_mesh(
            trimesh.util.wrap_as_stream(files[f"meshes/{asset.name}.obj"]), file_type="obj", process=False
        )
        np.testing.assert_array_equal(read.vertices, asset.mesh.vertices)
        np.testing.assert_array_equal(read.faces, asset.mesh.faces)


def test_formats_are_found_and_have_aliases() -> None:
    """Formats are listed in the declared order and found by name or alias, in any case."""
    assert tuple(FORMATS) == ("urdf", "sdf", "mjcf", "usd", "webots")
    assert format_named("SDFormat") is FORMATS["sdf"]
    assert format_named("mujoco") is FORMATS["mjcf"]
    with pytest.raises(KeyError):
        format_named("step")


def test_finding_formats_imports_no_xml_library() -> None:
    """Listing the formats does not import lxml."""
    code = "import sys, stepbot.formats; print([m for m in ('lxml', 'trimesh', 'mujoco') if m in sys.modules])"
    root = Path(__file__).resolve().parents[2]
    environment = {**os.environ, "PYTHONPATH": str(root / "src")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
