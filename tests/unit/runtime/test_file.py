"""Files and paths that others name: nothing hangs, nothing raises, nothing is lost."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.runtime.file import exists, is_file, is_folder, open_regular, read_regular, resolved, write_file

POSIX = pytest.mark.skipif(os.name == "nt", reason="needs links, pipes and modes")


def loop(folder: Path) -> Path:
    """A link to itself."""
    (folder / "loop").symlink_to(folder / "loop")
    return folder / "loop"


def pipe(folder: Path) -> Path:
    """A named pipe that nobody writes to."""
    os.mkfifo(folder / "pipe")
    return folder / "pipe"


NAMES: dict[str, Callable[[Path], Path]] = {
    "too long": lambda folder: folder / ("x" * 5000),
    "too long above": lambda folder: folder / ("x" * 300) / "a",
    "null": lambda folder: folder / "a\0b",
    "loop": loop,
    "below a loop": lambda folder: loop(folder) / "a",
    "surrogate": lambda folder: folder / "a\ud800",
    "below a file": lambda folder: Path(__file__) / "a",
}


@POSIX
@pytest.mark.parametrize("kind", NAMES)
def test_names_that_cannot_be_files(tmp_path: Path, kind: str) -> None:
    """Each question has an answer, and writing is a coded error."""
    path = NAMES[kind](tmp_path)
    assert not any(question(path) for question in (exists, is_file, is_folder))
    assert resolved(path).is_absolute()
    if kind != "surrogate":
        before = sorted(tmp_path.iterdir())
        write_file(path, b"new", diagnostics := Diagnostics())
        assert [one.code for one in diagnostics] == ["SB004"]
        assert sorted(tmp_path.iterdir()) == before


@POSIX
@pytest.mark.parametrize("device", ["pipe", "/dev/zero", "folder"])
def test_only_regular_files_are_opened(tmp_path: Path, device: str) -> None:
    """A pipe, a device and a folder are errors at once, read directly or through a link; they are not replaced."""
    path = {"pipe": pipe, "folder": lambda folder: folder}.get(device, lambda _: Path(device))(tmp_path)
    (tmp_path / "link").symlink_to(path)
    for name in (path, tmp_path / "link"):
        with pytest.raises(OSError, match=r"regular|directory"):
            open_regular(name)
        write_file(name, b"new", diagnostics := Diagnostics())
        assert [one.code for one in diagnostics] == ["SB004"]
    assert (tmp_path / "link").is_symlink()
    assert not path.is_file()


@POSIX
def test_written_in_place(tmp_path: Path) -> None:
    """The mode stays; a link stays a link, and the file that it leads to is written."""
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "arm.robot.yaml", tmp_path / "link.yaml"
    target.write_bytes(b"old")
    target.chmod(0o640)
    link.symlink_to("there/arm.robot.yaml")
    write_file(link, b"new", diagnostics := Diagnostics(), replaces=b"old")
    assert not list(diagnostics)
    assert link.is_symlink()
    assert (read_regular(target), target.stat().st_mode & 0o777) == (b"new", 0o640)
    write_file(link, b"newer", diagnostics, replaces=b"old")
    assert [one.message for one in diagnostics] == ["cannot write the file: it was changed elsewhere meanwhile"]
    assert target.read_bytes() == b"new"
    assert sorted(path.name for path in target.parent.iterdir()) == ["arm.robot.yaml"]


def test_longest_name(tmp_path: Path) -> None:
    """A file whose name is as long as the file system allows is written."""
    path = tmp_path / f"{'x' * 250}.yaml"
    write_file(path, b"new", diagnostics := Diagnostics())
    assert not list(diagnostics)
    assert path.read_bytes() == b"new"
