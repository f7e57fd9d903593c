"""``stepbot convert --package``: a URDF in a ROS package."""

import shutil
import subprocess
from pathlib import Path

import pytest
import yourdfpy

from .conftest import Stepbot

NAME = "arm2_description"


@pytest.mark.slow
def test_mesh_paths_name_the_package(stepbot: Stepbot, arm: Path) -> None:
    """Only the mesh paths of the URDF change, and the engines prove the file with the package resolved."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "plain", "--no-verify").code == 0
    run = stepbot("convert", "arm2.robot.yaml", "-o", NAME, "--package", NAME)
    assert run.code == 0, run.err
    plain, packaged = ((arm / folder / "arm2.urdf").read_text(encoding="utf-8") for folder in ("plain", NAME))
    assert packaged.count(f'filename="package://{NAME}/meshes/') == plain.count('filename="meshes/') > 0
    assert packaged.replace(f"package://{NAME}/", "") == plain
    for name in ("arm2.sdf", "arm2.xml"):
        assert (arm / NAME / name).read_bytes() == (arm / "plain" / name).read_bytes()
    [proven] = [line for line in run.out.splitlines() if line.startswith("proven: ")]
    assert all(word in proven for word in ("URDF", "MuJoCo", "yourdfpy"))


@pytest.mark.slow
def test_readers_of_packages_find_every_mesh(stepbot: Stepbot, arm: Path) -> None:
    """A reader that knows where the package is loads all meshes: yourdfpy, with the package's folder."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "out", "--package", NAME, "-f", "urdf", "--no-verify").code == 0

    def found(fname: str) -> str:
        assert fname.startswith(f"package://{NAME}/")
        return str(arm / "out" / fname.removeprefix(f"package://{NAME}/"))

    robot = yourdfpy.URDF.load(str(arm / "out" / "arm2.urdf"), filename_handler=found)
    visuals = sum(len(link.visuals) for link in robot.link_map.values())
    assert len(robot.scene.geometry) == visuals > 0


@pytest.mark.skipif(shutil.which("check_urdf") is None, reason="check_urdf of liburdfdom-tools is not installed")
def test_the_parser_of_ros_accepts_it(stepbot: Stepbot, arm: Path) -> None:
    """check_urdf, which has the URDF parser of ROS, reads the file and finds its tree."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "out", "--package", NAME, "-f", "urdf", "--no-verify").code == 0
    command = ["check_urdf", str(arm / "out" / "arm2.urdf")]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert run.returncode == 0, run.stderr
    assert "robot name is: arm2" in run.stdout
    assert "root Link: base" in run.stdout


@pytest.mark.parametrize("name", ["Arm", "2arm", "arm-description", "arm/x", "a", 'arm"'])
def test_names_that_ros_rejects_are_refused(stepbot: Stepbot, arm: Path, name: str) -> None:
    """A name that is not one of a ROS package ends with a usage error, and nothing is written."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--package", name)
    assert run.code == 2
    assert "not the name of a ROS package" in run.err
    assert not (arm / "out").exists()


def test_without_a_urdf_there_is_nothing_to_package(stepbot: Stepbot, arm: Path) -> None:
    """The option requires the format urdf."""
    assert stepbot("convert", "arm2.robot.yaml", "-f", "mjcf", "--package", NAME).code == 2


def test_uptodate_compares_with_the_same_package(stepbot: Stepbot, arm: Path) -> None:
    """`uptodate --package` finds the files current, and without the option it finds a difference."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "out", "--package", NAME, "--no-verify").code == 0
    assert stepbot("uptodate", "arm2.robot.yaml", "-o", "out", "--package", NAME).code == 0
    assert stepbot("uptodate", "arm2.robot.yaml", "-o", "out").code == 1
