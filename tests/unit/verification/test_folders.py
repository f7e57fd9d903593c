"""Folders and missing files in place of robot files."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.verification.files import format_of


def _reported(path: Path) -> tuple[str, tuple[str, ...]]:
    diagnostics = Diagnostics()
    assert format_of(path, diagnostics) is None
    (one,) = diagnostics
    assert one.code == "SB001"
    return one.message, one.help


def test_a_folder_is_reported_with_its_robot_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """URDF first; scenes, manifests and meshes are not robots to verify."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out" / "meshes").mkdir(parents=True)
    for name in ("arm.xml", "arm.scene.xml", "package.xml", "arm.sdf", "arm.world.sdf", "arm.urdf", "meshes/a.obj"):
        (tmp_path / "out" / name).write_text("<package/>" if name == "package.xml" else "<mujoco/>", encoding="utf-8")
    message, help = _reported(Path("out"))
    assert message == "is a folder, not a file"
    assert help == ("use a file in it: 'out/arm.urdf', 'out/arm.sdf', 'out/arm.xml'",)


def test_the_robot_file_of_a_package_is_in_a_folder_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ROS 2 package has its URDF one level down, and a manifest on top."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm_description" / "urdf").mkdir(parents=True)
    for name in ("package.xml", "urdf/arm.urdf"):
        (tmp_path / "arm_description" / name).touch()
    assert _reported(Path("arm_description"))[1] == ("use a file in it: 'arm_description/urdf/arm.urdf'",)


def test_a_folder_without_robot_files(tmp_path: Path) -> None:
    """The remedy names the command that writes them."""
    assert _reported(tmp_path)[1] == ("it contains no robot file; `stepbot convert` writes them",)


def test_a_missing_file_is_reported_with_those_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A similar name, else all; an empty folder leaves the remedy of the code."""
    monkeypatch.chdir(tmp_path)
    assert _reported(Path("arm.urdf")) == ("file not found", ())
    (tmp_path / "arm.urdf").touch()
    assert _reported(Path("amr.urdf"))[1] == ("did you mean 'arm.urdf'?",)
    assert _reported(Path("out"))[1] == ("robot files in '.': 'arm.urdf'",)
