"""``stepbot convert --gazebo``: a folder that Gazebo finds as a model, read by engines, by Drake and by libsdformat."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import files_of
from stepbot.formats.sdformat.gazebo_model import CONFIG, MODEL, gazebo_model
from stepbot.runtime.programs import sdf_programs
from tests.robots import ROBOTS, two_link_arm

from .conftest import Stepbot

SDF = format_named("sdf")

WORLD = """<sdf version="1.9"><world name="other"><include><uri>model://{name}/</uri></include></world></sdf>"""
"""A world of somebody else, which finds the model by its name; Drake needs the slash after names with `_`."""

LOAD_IN_DRAKE = """
import sys
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder
plant, scene = AddMultibodyPlantSceneGraph(DiagramBuilder(), 1e-3)
parser = Parser(plant)
parser.package_map().Add(sys.argv[2], sys.argv[3])
parser.AddModels(sys.argv[1])
plant.Finalize()
print(plant.num_joints(), scene.model_inspector().num_geometries())
"""


@pytest.mark.slow
def test_the_folder_is_a_model_that_engines_prove(stepbot: Stepbot, arm: Path) -> None:
    """Only mesh paths change and model.config is added; engines read the file, and `uptodate` expects the same."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "plain", "--no-verify", "-f", "sdf").code == 0
    run = stepbot("convert", "arm2.robot.yaml", "-o", "models/desk_arm", "--gazebo", "-f", "sdf")
    assert run.code == 0, run.err
    assert "proven: SDFormat matches the CAD" in run.out
    folder = arm / "models" / "desk_arm"
    for name, renamed in (("arm2.sdf", MODEL), ("arm2.world.sdf", "arm2.world.sdf")):
        plain, model = (path.read_text(encoding="utf-8") for path in (arm / "plain" / name, folder / renamed))
        assert model.count("<uri>model://desk_arm/meshes/") == plain.count("<uri>meshes/") > 0
        assert model.replace("model://desk_arm/", "") == plain
    names, plain_names = ({path.name for path in place.iterdir()} for place in (folder, arm / "plain"))
    assert (names - plain_names, plain_names - names) == ({CONFIG, MODEL}, {"arm2.sdf"})
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert [one["path"] for one in report["files"] if one["content"] == "robot"] == [MODEL]
    again = ("uptodate", "arm2.robot.yaml", "-o", "models/desk_arm", "-f", "sdf")
    assert stepbot(*again, "--gazebo").code == 0
    assert stepbot(*again).code == 1


@pytest.mark.parametrize("make", ROBOTS.values(), ids=ROBOTS)
def test_model_config_names_the_file_and_its_version(make) -> None:  # type: ignore[no-untyped-def]
    """`<sdf>` names the main file with its version, and every URI of a mesh is a file of the model."""
    lowered = lower(make(), SDF, Diagnostics())
    files = gazebo_model(lowered, files_of(lowered, SDF), "the_model")
    config = ET.fromstring(files[CONFIG])
    (named,) = config.findall("sdf")
    model = ET.fromstring(files[named.text or ""])
    assert named.text == MODEL
    assert named.attrib["version"] == model.attrib["version"]
    assert config.findtext("name") == lowered.name
    uris = [uri.text or "" for uri in model.iter("uri")]
    assert all(uri.removeprefix("model://the_model/") in files for uri in uris)


@pytest.mark.parametrize("name", ["a b", "größe", "a%20b", "-x"])
def test_folders_that_no_uri_can_name_are_refused(stepbot: Stepbot, arm: Path, name: str) -> None:
    """A folder whose name a URI would escape ends with a usage error, and nothing is written."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", f"./{name}", "--gazebo")
    assert run.code == 2
    assert "cannot be a Gazebo model" in run.err
    assert not (arm / name).exists()
    assert stepbot("convert", "arm2.robot.yaml", "--gazebo", "-f", "urdf").code == 2


@pytest.fixture
def world(tmp_path: Path) -> Path:
    """A world that includes a model in the folder ``models`` beside it."""
    lowered = lower(two_link_arm(), SDF, Diagnostics())
    for path, data in gazebo_model(lowered, files_of(lowered, SDF), "the_model").items():
        file = tmp_path / "models" / "the_model" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    file = tmp_path / "world.sdf"
    file.write_text(WORLD.format(name="the_model"), encoding="utf-8")
    return file


def test_drake_finds_the_model_and_its_meshes(world: Path) -> None:
    """Drake resolves the include through model.config, and all joints and shapes are there."""
    if importlib.util.find_spec("pydrake") is None:
        pytest.skip("drake is not installed")
    folder = world.parent / "models" / "the_model"
    command = [sys.executable, "-c", LOAD_IN_DRAKE, str(world), "the_model", str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert run.returncode == 0, run.stderr
    joints, shapes = map(int, run.stdout.split())
    robot = two_link_arm()
    assert joints == len(robot.joints) + 1  # and the joint to the world
    assert shapes >= len([shape for link in robot.links for shape in link.visuals])


def test_libsdformat_finds_the_model(world: Path) -> None:
    """Gazebo's parser accepts the world where the model is in its path, and rejects it elsewhere."""
    program = next(sdf_programs(), None)
    if program is None:
        pytest.skip("libsdformat is not installed")
    verdicts = []
    for place in (world.parent / "models", world.parent):
        run = subprocess.run(
            [program, "sdf", "--check", str(world)],
            env={**os.environ, "SDF_PATH": str(place)},
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )
        verdicts.append("Valid." in run.stdout.splitlines() and "Error" not in run.stdout + run.stderr)
    assert verdicts == [True, False]


def test_joints_without_limits_are_revolute() -> None:
    """No SDFormat has a `continuous` joint, of which Gazebo's DART makes a fixed one."""
    for make in ROBOTS.values():
        lowered = lower(make(), SDF, Diagnostics())
        for path, data in files_of(lowered, SDF).items():
            if path.endswith(".sdf"):
                assert b'type="continuous"' not in data, path
