"""Paths that engines can open."""

import os
import sys
from pathlib import Path

import pytest

from stepbot.engines.file_references import openable

BAR = os.fsdecode(b"b\xe4r")


@pytest.mark.skipif(sys.platform != "linux", reason="file names are Unicode there")
@pytest.mark.parametrize("name", ["arm.urdf", f"{BAR}.urdf"])
def test_what_is_beside_a_file_is_beside_its_other_path(tmp_path: Path, name: str) -> None:
    """A file beside the opened one is found if the name of the file, or of a folder above it, is not UTF-8."""
    folder = tmp_path / BAR / "robots" / "arm"
    (folder / "meshes").mkdir(parents=True)
    (folder.parent / "shared.obj").write_bytes(b"s")
    (folder / "meshes" / "a.obj").write_bytes(b"a")
    (folder / name).write_bytes(b"text")
    path = openable(folder / name)
    assert str(path).encode("utf-8")
    assert path.is_absolute()
    assert path.suffix == ".urdf"
    assert path.read_bytes() == b"text"
    assert (path.parent / "meshes" / "a.obj").read_bytes() == b"a"
    assert name != "arm.urdf" or (path.parent / ".." / "shared.obj").read_bytes() == b"s"


def test_relative_path_is_in_the_current_folder_of_the_call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A relative path is resolved in the current folder of each call, in one process too."""
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        assert openable(Path("arm.urdf")) == (tmp_path / name / "arm.urdf").resolve()


def test_path_in_utf8_stays(tmp_path: Path) -> None:
    """A UTF-8 path needs no link."""
    (tmp_path / "arm.urdf").write_bytes(b"")
    assert openable(tmp_path / "arm.urdf") == (tmp_path / "arm.urdf").resolve()
