"""A run writes all files or none, and removes only files of an earlier run."""

import errno
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.runtime.output import beside, check_writable, discard, failed_output, write_atomically
from stepbot.runtime.output_list import MANIFEST

POSIX = pytest.mark.skipif(os.name == "nt", reason="needs links and pipes in folders")
ARM = {"arm.urdf": b"urdf", "arm.xml": b"mjcf", "meshes/a.obj": b"a", "meshes/b.obj": b"b"}


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder except stepbot's file list."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != MANIFEST)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def codes(error: StepbotError) -> list[str]:
    """The codes of the errors."""
    return [diagnostic.code for diagnostic in error.diagnostics]


def test_files_are_written_and_nothing_else(tmp_path: Path) -> None:
    """Files are written, missing folders are created, and no staging folder remains."""
    out = tmp_path / "a" / "b"
    write_atomically(ARM, out)
    assert contents(out) == ARM
    assert sorted(path.name for path in out.iterdir()) == [MANIFEST, "arm.urdf", "arm.xml", "meshes"]


def test_second_run_touches_its_stamp_alone(tmp_path: Path) -> None:
    """Unchanged files keep their time stamp; the file list has that of the last run."""
    write_atomically(ARM, tmp_path)
    for path in tmp_path.rglob("*"):
        os.utime(path, (1, 1))
    write_atomically(ARM, tmp_path)
    touched = [path.name for path in tmp_path.rglob("*") if path.is_file() and path.stat().st_mtime != 1]
    assert touched == [".stepbot.json"]


def test_stale_meshes_go_and_files_of_others_stay(tmp_path: Path) -> None:
    """A mesh that is no longer needed is removed, unless it is not stepbot's or was changed."""
    write_atomically({**ARM, "meshes/c.obj": b"c"}, tmp_path)
    (tmp_path / "meshes/mine.obj").write_bytes(b"mine")
    (tmp_path / "meshes/c.obj").write_bytes(b"edited by hand")
    write_atomically({"arm.urdf": b"2", "arm.xml": b"2", "meshes/a.obj": b"a"}, tmp_path)
    assert contents(tmp_path) == {
        "arm.urdf": b"2",
        "arm.xml": b"2",
        "meshes/a.obj": b"a",
        "meshes/c.obj": b"edited by hand",
        "meshes/mine.obj": b"mine",
    }


def test_folders_go_with_their_last_file(tmp_path: Path) -> None:
    """A file in several folders leaves none of them empty; a folder with a file of the user stays."""
    write_atomically(
        {"arm.usda": b"u", "simready/arm/usd/arm.usda": b"s", "simready/arm/usd/payloads/b.usda": b"b"}, tmp_path
    )
    write_atomically({"arm.usda": b"u"}, tmp_path)
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == []
    write_atomically({"arm.usda": b"u", "simready/arm/usd/arm.usda": b"s"}, tmp_path)
    (tmp_path / "simready/mine.txt").write_bytes(b"mine")
    write_atomically({"arm.usda": b"u"}, tmp_path)
    assert [path.name for path in (tmp_path / "simready").iterdir()] == ["mine.txt"]


def test_parts_that_a_robot_no_longer_has(tmp_path: Path) -> None:
    """The SRDF, the file for Drake and MoveIt's settings go with a run that writes what they belong to without them."""
    package = {"CMakeLists.txt": b"c", "arm.urdf": b"u", "urdf/arm.xacro": b"x"}
    planning = {".setup_assistant": b"s", "arm.srdf": b"r", "config/kinematics.yaml": b"k", "launch/demo.py": b"d"}
    loops = {"arm.sdf": b"s", "arm.drake.sdf": b"d"}
    write_atomically({**package, **planning}, tmp_path)
    write_atomically(loops, tmp_path)
    (tmp_path / "config/kinematics.yaml").write_bytes(b"edited by hand")
    write_atomically({"arm.xml": b"m"}, tmp_path)
    assert set(contents(tmp_path)) == {*package, *planning, *loops, "arm.xml"}, "a run for another format"
    assert beside(package, tmp_path)[1] == ["arm.drake.sdf", "arm.sdf", "arm.xml"]
    write_atomically(package, tmp_path)
    assert set(contents(tmp_path)) == {*package, *loops, "arm.xml", "config/kinematics.yaml"}
    write_atomically({"arm.sdf": b"s"}, tmp_path)
    assert set(contents(tmp_path)) == {*package, "arm.sdf", "arm.xml", "config/kinematics.yaml"}


def test_settings_of_moveit_go_with_a_run_for_the_package_alone(tmp_path: Path) -> None:
    """Formats of the run before, which this one does not write, keep their meshes and none of the package's files."""
    package = {"CMakeLists.txt": b"c", "arm.urdf": b"u", "urdf/arm.xacro": b"x", "meshes/a.obj": b"a"}
    planning = {".setup_assistant": b"s", "arm.srdf": b"r", "config/kinematics.yaml": b"k", "launch/demo.py": b"d"}
    others = {"arm.sdf": b"s", "arm.xml": b"m", "report.json": b"{}", "meshes/b.obj": b"b"}
    write_atomically({**package, **planning, **others}, tmp_path)
    write_atomically({**package, "report.json": b"{}"}, tmp_path)
    assert set(contents(tmp_path)) == {*package, *others}
    write_atomically({**package, **planning}, tmp_path)
    write_atomically({"arm.xml": b"m"}, tmp_path)
    assert {*package, *planning} <= set(contents(tmp_path)), "a run for another format"


def test_meshes_stay_while_another_file_needs_them(tmp_path: Path) -> None:
    """Meshes that files of earlier runs refer to are kept by a run for one format or another robot."""
    write_atomically(ARM, tmp_path)
    write_atomically({"leg.urdf": b"leg", "meshes/b.obj": b"b", "meshes/c.obj": b"c"}, tmp_path)
    write_atomically({"arm.urdf": b"2", "meshes/d.obj": b"d"}, tmp_path)
    assert set(contents(tmp_path)) == {"arm.urdf", "arm.xml", "leg.urdf", *(f"meshes/{x}.obj" for x in "abcd")}
    write_atomically({"arm.xml": b"2", "meshes/d.obj": b"d"}, tmp_path)
    assert set(contents(tmp_path)) == {"arm.urdf", "arm.xml", "leg.urdf", *(f"meshes/{x}.obj" for x in "bcd")}


def test_robots_in_one_folder_do_not_change_each_others_meshes(tmp_path: Path) -> None:
    """A mesh of another robot may be reused, not replaced; other formats of the same robot may replace it."""
    write_atomically({**ARM, "report.json": b"{}"}, tmp_path)
    before = contents(tmp_path)
    with pytest.raises(StepbotError) as error:
        write_atomically({"leg.urdf": b"leg", "report.json": b"2", "meshes/a.obj": b"a of the leg"}, tmp_path)
    assert codes(error.value) == ["SB004"]
    assert "mesh 'meshes/a.obj' would overwrite a different mesh of 'arm.urdf'" in str(
        next(iter(error.value.diagnostics))
    )
    assert contents(tmp_path) == before
    write_atomically({"arm.drake.sdf": b"sdf", "meshes/a.obj": b"new"}, tmp_path)
    (tmp_path / "arm.urdf").unlink()
    (tmp_path / "arm.xml").unlink()
    (tmp_path / "arm.drake.sdf").unlink()
    write_atomically({"leg.urdf": b"leg", "report.json": b"2", "meshes/a.obj": b"a of the leg"}, tmp_path)
    assert contents(tmp_path)["meshes/a.obj"] == b"a of the leg"


@pytest.mark.parametrize("text", ["", "{", "[]", '{"files": 3}', '{"files": {"arm.urdf": ["meshes/b.obj"]}}'])
def test_unreadable_list_removes_nothing(tmp_path: Path, text: str) -> None:
    """With a broken file list no file is removed."""
    write_atomically({**ARM, "arm.urdf": b"<!-- Written by stepbot -->"}, tmp_path)
    (tmp_path / MANIFEST).write_text(text, encoding="utf-8")
    write_atomically({"arm.urdf": b"2", "meshes/a.obj": b"a"}, tmp_path)
    assert "meshes/b.obj" in contents(tmp_path)


@pytest.mark.parametrize("path", ["arm.urdf", "meshes/a.obj", "package.xml"])
@pytest.mark.parametrize("is_listed", [False, True], ids=["new folder", "folder of another robot"])
def test_files_that_stepbot_has_not_written_are_kept(tmp_path: Path, path: str, *, is_listed: bool) -> None:
    """A file by hand under the name of a new one is an error and stays; the same content is no conflict."""
    if is_listed:
        write_atomically({"leg.urdf": b"leg"}, tmp_path)
    (tmp_path / "meshes").mkdir()
    (tmp_path / path).write_bytes(b"by hand")
    before = contents(tmp_path)
    files = {**ARM, "package.xml": b"<package/>"}
    with pytest.raises(StepbotError, match=f"'{path}' exists, and stepbot has not written it") as error:
        write_atomically(files, tmp_path)
    assert codes(error.value) == ["SB004"]
    assert contents(tmp_path) == before
    (tmp_path / path).write_bytes(files[path])
    write_atomically(files, tmp_path)
    assert contents(tmp_path) == {**before, **files}


def test_folder_that_has_lost_its_list(tmp_path: Path) -> None:
    """Marked files of stepbot are replaced, with their meshes; one by hand beside them is kept."""
    marked = {name: b"<!-- Written by stepbot -->" + name.encode() for name in ("arm.urdf", "arm.xml")}
    write_atomically({**ARM, **marked}, tmp_path)
    (tmp_path / MANIFEST).unlink()
    newer = {name: content + b"2" for name, content in {**ARM, **marked}.items()}
    write_atomically(newer, tmp_path)
    assert contents(tmp_path) == newer
    (tmp_path / MANIFEST).unlink()
    (tmp_path / "arm.xml").write_bytes(b"by hand")
    with pytest.raises(StepbotError, match=r"'arm\.xml' exists"):
        write_atomically({**ARM, **marked}, tmp_path)
    assert contents(tmp_path) == {**newer, "arm.xml": b"by hand"}


def test_list_cannot_name_files_elsewhere(tmp_path: Path) -> None:
    """A manipulated file list removes nothing outside the folder."""
    out = tmp_path / "out"
    victim = tmp_path / "victim"
    victim.write_bytes(b"b")
    write_atomically(ARM, out)
    listed = json.loads((out / MANIFEST).read_bytes())
    digest = listed["files"]["arm.urdf"].pop("meshes/b.obj")
    listed["files"]["arm.urdf"].update({"../victim": digest, str(victim): digest})
    (out / MANIFEST).write_text(json.dumps(listed), encoding="utf-8")
    write_atomically({"arm.urdf": b"2", "arm.xml": b"2", "meshes/a.obj": b"a"}, out)
    assert victim.exists()


@pytest.mark.parametrize(
    "path", ["/abs", "../up", "a/../../b", "", ".", "a//b", "a\\b", "a\0b", MANIFEST, ".stepbot-x/a"]
)
def test_paths_stay_in_the_folder(tmp_path: Path, path: str) -> None:
    """Names that leave the folder, or are those of stepbot's own files, are rejected."""
    with pytest.raises(StepbotError) as error:
        write_atomically({"arm.urdf": b"1", path: b"x"}, tmp_path / "out")
    assert codes(error.value) == ["SB004"]
    assert not (tmp_path / "out").exists()


def test_failure_in_the_middle_puts_everything_back(tmp_path: Path) -> None:
    """If one file cannot be moved to its place, all others are restored."""
    write_atomically(ARM, tmp_path)
    before = {**contents(tmp_path), MANIFEST: (tmp_path / MANIFEST).read_bytes()}
    (tmp_path / "zzz.urdf").mkdir()  # a folder at the path of the last file
    with pytest.raises(StepbotError) as error:
        write_atomically(
            {"arm.urdf": b"new", "meshes/a.obj": b"new", "meshes/n/n.obj": b"n", "zzz.urdf": b"z"}, tmp_path
        )
    assert codes(error.value) == ["SB004"]
    assert "zzz.urdf" in str(error.value)
    assert {**contents(tmp_path), MANIFEST: (tmp_path / MANIFEST).read_bytes()} == before
    assert not (tmp_path / "meshes/n").exists()
    assert not list(tmp_path.glob(".stepbot-*"))


def test_output_that_is_a_file_is_refused(tmp_path: Path) -> None:
    """A file at the path of the folder, or above it, is a diagnostic."""
    (tmp_path / "out").write_bytes(b"")
    for folder in (tmp_path / "out", tmp_path / "out" / "deeper"):
        with pytest.raises(StepbotError) as error:
            write_atomically(ARM, folder)
        assert codes(error.value) == ["SB004"]
    assert (tmp_path / "out").read_bytes() == b""


def test_links_are_replaced_and_not_followed(tmp_path: Path) -> None:
    """A symbolic link at the path of a file is replaced; its target is unchanged."""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_bytes(b"urdf")
    (tmp_path / "out").mkdir()
    try:
        (tmp_path / "out" / "arm.urdf").symlink_to(elsewhere)
    except OSError:
        pytest.skip("no symbolic links here")
    write_atomically({"arm.urdf": b"new"}, tmp_path / "out")
    assert elsewhere.read_bytes() == b"urdf"
    assert (tmp_path / "out" / "arm.urdf").read_bytes() == b"new"


def test_folders_of_killed_runs_are_removed_after_a_day(tmp_path: Path) -> None:
    """A staging folder older than a day is removed; a younger one may belong to a concurrent run."""
    old, young = tmp_path / ".stepbot-old", tmp_path / ".stepbot-young"
    for folder in (old, young):
        folder.mkdir()
        (folder / "0.new").write_bytes(b"x")
    past = time.time() - 2 * 24 * 3600
    os.utime(old, (past, past))
    write_atomically(ARM, tmp_path)
    assert (old.exists(), young.exists()) == (False, True)


KILLED = """
import os, signal, sys
from pathlib import Path
import stepbot.runtime.output as output
steps = int(sys.argv[2])
real = Path.replace
def replace(self, target):
    global steps
    if steps == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    steps -= 1
    return real(self, target)
Path.replace = replace
new = {"arm.urdf": b"new", "arm.xml": b"new", "meshes/a.obj": b"new", "meshes/c.obj": b"new"}
output.write_atomically(new, Path(sys.argv[1]))
"""


@POSIX
def test_linked_folders_are_not_written_through(tmp_path: Path) -> None:
    """A mesh folder that is a link elsewhere is rejected, and its target is unchanged."""
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    write_atomically(ARM, out)
    (out / "meshes").rename(elsewhere)
    (out / "meshes").symlink_to(elsewhere)
    before = contents(elsewhere)
    with pytest.raises(StepbotError, match="SB004"):
        write_atomically({"arm.urdf": b"new", "meshes/new.obj": b"new"}, out)
    write_atomically({"arm.urdf": b"new", "arm.xml": b"new"}, out)
    discard(out)
    assert contents(elsewhere) == before


@POSIX
def test_list_that_never_ends(tmp_path: Path) -> None:
    """A pipe or deeply nested text at the path of the file list is replaced."""
    os.mkfifo(tmp_path / MANIFEST)
    write_atomically(ARM, tmp_path)
    assert (tmp_path / MANIFEST).is_file()
    (tmp_path / MANIFEST).write_bytes(b'{"files": ' + b"[" * 1_000_000)
    write_atomically(ARM, tmp_path)
    assert contents(tmp_path) == ARM


WRITER = """
import sys
from pathlib import Path
from stepbot.runtime.output import write_atomically
folder, name = Path(sys.argv[1]), sys.argv[2]
print("ready", flush=True)
sys.stdin.readline()
for number in range(20):
    write_atomically({f"{name}.urdf": b"%d" % number, f"{name}/{number}.obj": b"mesh of %d" % number}, folder)
"""


@pytest.mark.slow
def test_concurrent_runs_into_one_folder(tmp_path: Path) -> None:
    """After concurrent runs the list has the files of all, and no unneeded mesh remains."""
    names = [f"robot{number}" for number in range(4)]
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path), name], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        for name in names
    ]
    for run in runs:
        assert run.stdout is not None
        assert run.stdout.readline() == b"ready\n"
    for run in runs:
        assert run.stdin is not None
        run.stdin.write(b"go\n")
        run.stdin.flush()
    for run in runs:
        run.communicate()
    assert [run.returncode for run in runs] == [0] * len(runs)
    listed = json.loads((tmp_path / MANIFEST).read_bytes())["files"]
    assert sorted(listed) == [f"{name}.urdf" for name in names]
    assert contents(tmp_path) == {
        **{f"{name}.urdf": b"19" for name in names},
        **{f"{name}/19.obj": b"mesh of 19" for name in names},
    }


HOLDER = """
import sys, time
from pathlib import Path
from stepbot.runtime.output_list import locked
with locked(Path(sys.argv[1]), 1.0):
    print("locked", flush=True)
    time.sleep(600)
"""


@pytest.mark.slow
def test_run_that_keeps_a_folder_locked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While a run holds the lock, others fail after some time; after it has died, they write."""
    write_atomically(ARM, tmp_path)
    monkeypatch.setattr("stepbot.runtime.output._LONGEST_WAIT", 0.2)
    with subprocess.Popen([sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"locked\n"
        try:
            for action in (lambda: write_atomically({"arm.urdf": b"new"}, tmp_path), lambda: discard(tmp_path)):
                with pytest.raises(StepbotError, match="SB004") as caught:
                    action()
                assert "another process" in str(caught.value)
            assert contents(tmp_path) == ARM
        finally:
            holder.kill()
    write_atomically({"arm.urdf": b"new"}, tmp_path)
    assert (tmp_path / "arm.urdf").read_bytes() == b"new"


@pytest.mark.skipif(os.name == "nt", reason="locked in another way on Windows")
def test_file_system_without_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a file system without locks, files are written with a note."""
    diagnostics = Diagnostics()
    write_atomically(ARM, tmp_path, diagnostics=diagnostics)
    assert not list(diagnostics)

    def no_locks(descriptor: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", no_locks)
    write_atomically(ARM, tmp_path / "out", diagnostics=diagnostics)
    assert contents(tmp_path / "out") == ARM
    assert [(one.code, one.severity, one.span.file) for one in diagnostics] == [
        ("SB011", "note", str(tmp_path / "out"))
    ]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_internal_error_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[BaseException]
) -> None:
    """A run that ends by a bug or Ctrl-C removes the folders that it has created."""

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr("stepbot.runtime.output._check_case", fail)
    with pytest.raises(error):
        write_atomically(ARM, tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="no SIGKILL on Windows")
@pytest.mark.parametrize("steps", range(6))
def test_killed_run_leaves_whole_files_and_the_next_one_tidies_up(tmp_path: Path, steps: int) -> None:
    """After a kill between any two moves, every file is old or new, and the next run completes."""
    write_atomically(ARM, tmp_path)
    source = Path(__file__).resolve().parents[3] / "src"
    environment = {**os.environ, "PYTHONPATH": str(source)}
    run = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), str(steps)], env=environment, check=False)
    assert run.returncode == (-9 if steps < 6 else 0)
    new = {"arm.urdf": b"new", "arm.xml": b"new", "meshes/a.obj": b"new", "meshes/c.obj": b"new"}
    for path, content in contents(tmp_path).items():
        if not path.startswith(".stepbot-"):
            assert content in (ARM.get(path), new.get(path))
    write_atomically(new, tmp_path)
    assert {path: content for path, content in contents(tmp_path).items() if not path.startswith(".stepbot-")} == new


def test_discarded(tmp_path: Path) -> None:
    """Discarding removes what a run wrote, with its folder; changed and foreign files stay."""
    out = tmp_path / "out"
    write_atomically({"arm.urdf": b"1", "meshes/a.obj": b"2"}, out)
    discard(out)
    assert not out.exists()
    discard(out)
    write_atomically({"arm.urdf": b"1", "report.json": b"{}", "meshes/a.obj": b"2"}, out)
    (out / "arm.urdf").write_bytes(b"mine")
    (out / "notes.txt").write_bytes(b"mine too")
    discard(out)
    assert contents(out) == {"arm.urdf": b"mine", "notes.txt": b"mine too"}


MARK = b"<!-- Written by stepbot 0.1.0 from arm.step. -->\n"


@pytest.mark.parametrize("words", [b"<!-- tuned for stepbot -->", b"stepbot", b"# not Written by stepbot"])
def test_word_is_no_mark(tmp_path: Path, words: bytes) -> None:
    """A file of someone else that mentions stepbot at its start is kept."""
    (tmp_path / "arm.urdf").write_bytes(words)
    with pytest.raises(StepbotError, match=r"'arm\.urdf' exists, and stepbot has not written it"):
        write_atomically(ARM, tmp_path)
    assert contents(tmp_path) == {"arm.urdf": words}


@pytest.mark.parametrize("path", ["arm.urdf", "meshes/a.obj"])
def test_edited_files_are_kept(tmp_path: Path, path: str) -> None:
    """A file that was edited since stepbot wrote it is an error and stays; an edit that the run would make is not."""
    marked = {**ARM, "arm.urdf": MARK}
    write_atomically(marked, tmp_path)
    (tmp_path / path).write_bytes(marked[path] + b"by hand")
    before, newer = contents(tmp_path), {name: content + b"2" for name, content in marked.items()}
    with pytest.raises(StepbotError, match=f"'{path}' was edited since stepbot wrote it"):
        write_atomically(newer, tmp_path)
    assert contents(tmp_path) == before
    (tmp_path / path).write_bytes(newer[path])
    write_atomically(newer, tmp_path)
    assert contents(tmp_path) == newer


@POSIX
@pytest.mark.parametrize("path", ["arm.urdf", "meshes/a.obj"])
def test_pipe_in_place_of_a_file(tmp_path: Path, path: str) -> None:
    """A pipe at the path of a file is an error at once, and stays, whether the folder has a list or not."""
    (tmp_path / "meshes").mkdir()
    os.mkfifo(tmp_path / path)
    with pytest.raises(StepbotError, match=f"'{path}' exists, and is not a regular file"):
        write_atomically(ARM, tmp_path)
    (tmp_path / path).unlink()
    write_atomically(ARM, tmp_path)
    (tmp_path / path).unlink()
    os.mkfifo(tmp_path / path)
    with pytest.raises(StepbotError, match=f"'{path}' exists, and is not a regular file"):
        write_atomically({name: content + b"2" for name, content in ARM.items()}, tmp_path)
    assert not (tmp_path / path).is_file()


@pytest.mark.parametrize("name", [".stepbot-notes", ".stepbot-abcdefgh"])
def test_hidden_folders_of_others_stay(tmp_path: Path, name: str) -> None:
    """A folder with anything but the files of a killed run is not a leftover, whatever its name and age."""
    (tmp_path / name).mkdir()
    (tmp_path / name / "notes.md").write_bytes(b"mine")
    os.utime(tmp_path / name, (1, 1))
    write_atomically(ARM, tmp_path)
    assert (tmp_path / name / "notes.md").read_bytes() == b"mine"


def run_of(robot: str, content: bytes) -> dict[str, bytes]:
    """The files of a robot, as all formats name them."""
    names = (f"{robot}.urdf", f"{robot}.sdf", f"{robot}.world.sdf", f"{robot}.xml", f"{robot}.scene.xml")
    report = json.dumps({"robot": {"name": robot}}).encode()
    return {"report.json": report, **dict.fromkeys(names, content), "meshes/a.obj": content}


@pytest.mark.parametrize("names", [("two", "two.world"), ("two.world", "two"), ("two", "two.scene")])
def test_robot_named_like_a_file_of_another(tmp_path: Path, names: tuple[str, str]) -> None:
    """The names of robots, not those of their files, say which robot a file belongs to."""
    first, second = names
    write_atomically(run_of(first, b"1"), tmp_path)
    before = contents(tmp_path)
    with pytest.raises(StepbotError, match="would overwrite a"):
        write_atomically(run_of(second, b"2"), tmp_path)
    assert contents(tmp_path) == before
    assert beside(run_of(second, b"2"), tmp_path)[0] == [first]
    write_atomically(run_of(first, b"3"), tmp_path)
    assert contents(tmp_path) == run_of(first, b"3")


@POSIX
def test_output_behind_a_loop_of_links(tmp_path: Path) -> None:
    """A loop of links in place of the folder, or above it, is a coded error, and so is a name that is too long."""
    (tmp_path / "loop").symlink_to("loop")
    for folder in (tmp_path / "loop", tmp_path / "loop" / "out", tmp_path / ("x" * 300), tmp_path / ("x" * 5000)):
        with pytest.raises(StepbotError) as error:
            write_atomically(ARM, folder)
        assert codes(error.value) == ["SB004"]
        assert failed_output(folder).name.endswith(".failed")


@POSIX
def test_names_that_no_folder_has(tmp_path: Path) -> None:
    """A folder whose name is too long is refused before any work."""
    for folder in (tmp_path / ("x" * 300), tmp_path / ("x" * 5000), tmp_path / "a\0b"):
        with pytest.raises(StepbotError) as error:
            check_writable(folder)
        assert codes(error.value) == ["SB004"]
    check_writable(tmp_path / "new" / "folder")
