"""Commands on a URDF whose meshes are in a package, whatever the folder of the package is called."""

import json
import shutil
from pathlib import Path

import pytest

from .conftest import Stepbot

NAME = "arm2_description"


@pytest.fixture
def package(arm: Path, stepbot: Stepbot) -> Path:
    """A package in a folder of another name, and a copy of its URDF elsewhere, as in a build folder."""
    written = ("convert", "arm2.robot.yaml", "-o", "src/arm", "--package", NAME, "-f", "urdf,sdf,mjcf", "--no-verify")
    assert stepbot(*written).code == 0
    (arm / "build").mkdir()
    shutil.copy(arm / "src" / "arm" / "arm2.urdf", arm / "build")
    return arm


@pytest.mark.slow
def test_verify_searches_upwards_and_in_the_given_folders(package: Path, stepbot: Stepbot) -> None:
    """Every engine that reads URDF loads the meshes of a package that was found; PyBullet does not search for it."""
    for arguments in (["src/arm/arm2.urdf"], ["build/arm2.urdf", "--package-path", "src/arm"]):
        document = json.loads(stepbot("verify", *arguments, "--json").out)
        assert document["diagnostics"] == []
        loads = {one["engine"]: one["status"] for one in document["report"]["checks"] if one["quantity"] == "load"}
        installed = {engine for engine, status in loads.items() if status != "not run"}
        assert {"mujoco", "yourdfpy"} <= installed
        assert all(loads[engine] == "passed" for engine in installed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("verify", "build/arm2.urdf", "src/arm/arm2.sdf"), 1),
        (("collisions", "build/arm2.urdf", "--srdf", "arm.srdf"), 1),
        (("diff", "build/arm2.urdf", "src/arm/arm2.urdf"), 2),
    ],
)
def test_missing_meshes_are_an_error(package: Path, stepbot: Stepbot, arguments: tuple[str, ...], code: int) -> None:
    """No result is computed from a robot without its shapes."""
    run = stepbot(*arguments, "--json")
    found = json.loads(run.out)["diagnostics"]
    assert run.code == code
    assert {(one["code"], one["file"]) for one in found} == {("SB861", "build/arm2.urdf")}
    assert all("--package-path" in one["help"][0] for one in found)
    assert not (package / "arm.srdf").exists()
    assert stepbot(*arguments, "--package-path", "src/arm").code == 0


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.pybullet
def test_drive_finds_the_package(package: Path, stepbot: Stepbot) -> None:
    """A folder is driven in both engines, whatever it is called."""
    document = json.loads(stepbot("drive", "src/arm", "--test", "hold", "--json").out)
    assert {one["engine"] for one in document["tests"]} == {"mujoco", "pybullet"}
    assert all(one["code"] == "SB830" for one in document["diagnostics"])


def test_a_missing_relative_mesh_has_its_own_remedy(package: Path, stepbot: Stepbot) -> None:
    """The first place that names the mesh, and the others."""
    (package / "src" / "arm" / "meshes" / "beam.obj").unlink()
    text = (package / "build" / "arm2.urdf").read_text(encoding="utf-8")
    relative = text.replace(f"package://{NAME}/", "../src/arm/")
    (package / "build" / "arm2.urdf").write_text(relative, encoding="utf-8")
    line = next(number for number, one in enumerate(relative.splitlines(), 1) if "beam.obj" in one)
    (found,) = json.loads(stepbot("verify", "build/arm2.urdf", "--json").out)["diagnostics"]
    assert (found["message"], found["line"]) == ("mesh '../src/arm/meshes/beam.obj' not found", line)
    assert found["help"] == ["put the meshes where the file names them"]
