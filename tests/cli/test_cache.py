"""Cached runs: the same bytes as without a cache, and no unneeded module loaded."""

import errno
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache, own_code
from stepbot.runtime.worker import Worker
from stepbot.serving import local_server
from stepbot.serving.session import Session
from stepbot.step import KERNEL
from tests.architecture.test_imports import HEAVY, loaded_by
from tests.command_line import snapshot
from tests.command_line import stepbot as run_stepbot

from .conftest import Stepbot

FAST = ("-f", "urdf", "--no-verify")
ENGINES = "stepbot.engines."
pytestmark = pytest.mark.xdist_group("cache")
READ = ["stepbot.step.worker:read", "stepbot.geometry.mesh_worker:compute"]
"""The worker function that reads a STEP."""


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """A folder with a sidecar, its STEP, and a cache filled by a conversion and a check."""
    folder = tmp_path_factory.mktemp("filled")
    for file in ("four_bar.robot.yaml", "four_bar.step"):
        shutil.copy(robot_library / "stepbot_four_bar" / file, folder)
    changes = {"STEPBOT_NO_CACHE": "", "STEPBOT_CACHE": "kept"}
    for command in (("convert", *FAST), ("check",), ("check", "--step")):
        assert run_stepbot(*command, "four_bar.robot.yaml", cwd=folder, changes=changes).code == 0
    return folder


@pytest.fixture
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, filled: Path) -> Path:
    """A cache filled with the sidecar's results."""
    shutil.copytree(filled / "kept", tmp_path / "kept")
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.fixture
def four_bar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, filled: Path) -> Path:
    """The current folder, with a sidecar and its STEP."""
    for file in ("four_bar.robot.yaml", "four_bar.step"):
        shutil.copy(filled / file, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "four_bar.robot.yaml"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Record the functions passed to worker processes, which still run."""
    functions: list[str] = []
    start, submit = Worker.__init__, Worker.submit
    monkeypatch.setattr(Worker, "started", [], raising=False)

    def noted_start(self: Worker, function: str, **options: object) -> None:
        start(self, function, **options)  # type: ignore[arg-type]
        self.function = function  # type: ignore[attr-defined]
        Worker.started.append(function)  # type: ignore[attr-defined]

    def noted_submit(self: Worker, *arguments: object, more: bool = False) -> Worker:
        functions.append(self.function)  # type: ignore[attr-defined]
        return submit(self, *arguments, more=more)

    monkeypatch.setattr(Worker, "__init__", noted_start)
    monkeypatch.setattr(Worker, "submit", noted_submit)
    return functions


def edit(path: Path, old: str, new: str) -> None:
    """Replace a part of a file."""
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.mark.slow
def test_same_bytes_with_and_without(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """Files and text are identical without a cache, with an empty one, a full one, and one with the geometry alone."""

    def printed(folder: str, *options: str) -> str:
        run = stepbot("convert", four_bar.name, "-o", folder, *FAST, *options)
        assert run.code == 0
        return (run.out + run.err).replace(folder, "FOLDER")

    shutil.rmtree(cache)
    briefly = printed("without", "--no-cache")
    assert "in FOLDER" in briefly
    assert not cache.exists()
    verbosely = printed("filling", "-v")
    assert asked == [*READ, *READ]
    assert printed("whole") == briefly
    assert printed("whole", "-v") == verbosely != briefly
    edit(four_bar, "version: 1", "version: 1 # edited")
    assert stepbot("convert", four_bar.name, "-o", "geometry", *FAST).code == 0
    assert asked == [*READ, *READ], "to edit the sidecar reads no STEP"
    assert Worker.started == asked, "no process is started in vain"  # type: ignore[attr-defined]
    expected = snapshot(Path("without"))
    assert "report.json" in expected
    assert all(snapshot(Path(name)) == expected for name in ("filling", "whole", "geometry"))


@pytest.mark.slow
def test_engines_are_asked_once(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """Engines run only for changed files; observations of the others come from the cache."""
    verified = stepbot("convert", four_bar.name, "-o", "one")
    assert verified.code == 0
    assert any(function.startswith(ENGINES) for function in asked)
    first = list(asked)
    again = stepbot("convert", four_bar.name, "-o", "two")
    assert again.code == 0
    assert " checks)" in again.out
    assert again.out == verified.out.replace(" in one ", " in two ").replace("view one", "view two")
    assert asked == first
    assert snapshot(Path("one")) == snapshot(Path("two"))
    edit(four_bar, "version: 1", "version: 1 # a word")
    assert stepbot("convert", four_bar.name, "-o", "three").code == 0
    assert set(asked[len(first) :]) <= {"stepbot.engines.drake.observer:observe"}  # it reads no loops of SDFormat
    assert snapshot(Path("one")) == snapshot(Path("three"))


@pytest.mark.slow
def test_changed_step_is_read(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """A changed STEP with the former name and modification time is read."""
    step = four_bar.with_name("four_bar.step")
    edit(step, "DATA;", "DATA; ")
    assert stepbot("convert", four_bar.name, *FAST).code == 0
    assert asked == READ


@pytest.mark.slow
def test_finer_mesh_is_read_anew(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """Read options are part of the cache key."""
    with four_bar.open("a", encoding="utf-8") as file:
        file.write("\nmesh: {tolerance: 0.01 mm}\n")
    assert stepbot("convert", four_bar.name, *FAST).code == 0
    assert asked == READ


@pytest.mark.slow
def test_corrupt_entries_are_ignored(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """Corrupt entries are ignored and the output is identical."""
    assert stepbot("convert", four_bar.name, "-o", "one", *FAST).code == 0
    assert asked == []
    for path in cache.rglob("*"):
        if path.is_file():
            path.write_bytes(path.read_bytes()[: -len(path.name)] + path.name.encode())
    assert stepbot("convert", four_bar.name, "-o", "two", *FAST).code == 0
    assert snapshot(Path("one")) == snapshot(Path("two"))
    assert asked == READ


@pytest.mark.slow
def test_only_a_page_keeps_geometry_in_memory(
    four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """While it is open; after it has ended, or could not start, a conversion without cache reads the STEP."""

    def in_use(*_: object) -> None:
        raise OSError(errno.EADDRINUSE, "in use")

    session = Session(four_bar, Options(Path("out"), cache=Cache(cache)))
    session.load()
    shutil.rmtree(cache)
    assert stepbot("convert", four_bar.name, "-o", "one", *FAST).code == 0
    assert KERNEL not in asked
    session.close()
    monkeypatch.setattr(local_server, "_Server", in_use)
    with pytest.raises(OSError, match="in use"):
        Session(four_bar, Options(Path("out"), cache=Cache(cache)))
    shutil.rmtree(cache)
    assert stepbot("convert", four_bar.name, "-o", "two", *FAST).code == 0
    assert asked == READ


def test_errors_are_not_kept(four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str]) -> None:
    """A failed conversion is not cached."""
    edit(four_bar, "links:", "links:\n  ghost: {parts: [nowhere]}")
    first = stepbot("convert", four_bar.name, *FAST)
    second = stepbot("convert", four_bar.name, *FAST)
    assert first.code == second.code == 1
    assert first.err == second.err


@pytest.mark.parametrize("options", [(), ("--step",)])
def test_cached_diagnostics_are_identical(
    four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str], options: tuple[str, ...]
) -> None:
    """Cached diagnostics are identical, including remedies, and the kernel does not run."""
    edit(four_bar, "version: 1", "version: 1\nmass: exact")
    runs = [stepbot("check", *options, four_bar.name) for _ in range(3)]
    assert runs[0] == runs[1] == runs[2]
    assert asked == [], "the edit changes nothing about how the STEP is read"


@pytest.mark.slow
def test_unchanged_check_loads_nothing_heavy(tmp_path: Path, four_bar: Path, cache: Path) -> None:
    """A second check imports neither numpy nor a YAML reader."""
    for options in ([], ["--step"]):
        code, modules = loaded_by(["check", *options, four_bar.name], tmp_path)
        assert code == 0
        assert not modules & HEAVY


@pytest.mark.slow
def test_edited_sidecar_loads_no_kernel(tmp_path: Path, four_bar: Path, cache: Path) -> None:
    """After an edit of the sidecar the main process imports neither kernel nor trimesh, nor what verifies files."""
    edit(four_bar, "version: 1", "version: 1 # a word")
    code, modules = loaded_by(["convert", four_bar.name, *FAST], tmp_path)
    assert code == 0
    assert not modules & {"OCP", "trimesh", "scipy", "mujoco", "pybullet"}
    assert not [name for name in modules if name.startswith(("stepbot.verification", "stepbot.engines.workers"))]


def test_info_and_clear(cache: Path, stepbot: Stepbot) -> None:
    """`cache info` reports size and entries; `cache clear` removes them."""
    reported = json.loads(stepbot("cache", "info", "--json").out)
    assert Path(reported["folder"]) == cache
    assert reported["entries"] > 0
    assert 0 < reported["size"] < reported["limit"]
    assert f"entries  {reported['entries']}" in stepbot("cache", "info").out
    assert json.loads(stepbot("cache", "clear", "--json").out)["entries"] == reported["entries"]
    assert json.loads(stepbot("cache", "info", "--json").out)["entries"] == 0


def test_limit_from_the_environment(cache: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """``STEPBOT_CACHE_SIZE`` limits the size; an invalid value is rejected."""
    monkeypatch.setenv("STEPBOT_CACHE_SIZE", "3M")
    assert json.loads(stepbot("cache", "info", "--json").out)["limit"] == 3 * 2**20
    monkeypatch.setenv("STEPBOT_CACHE_SIZE", "plenty")
    assert stepbot("cache", "info").code == 2


@pytest.mark.slow
def test_unwritable_cache_is_a_note(four_bar: Path, stepbot: Stepbot, tmp_path: Path, cache: Path) -> None:
    """An unwritable cache is a note; the command succeeds."""
    shutil.rmtree(cache)
    cache.write_text("a file, no folder", encoding="utf-8")
    run = stepbot("convert", four_bar.name, *FAST, "-v")
    assert run.code == 0
    assert "note[SB006]" in run.err
    assert b"SB006" not in (tmp_path / "four_bar" / "report.json").read_bytes()


@pytest.mark.slow
def test_other_code_finds_nothing(
    four_bar: Path, cache: Path, stepbot: Stepbot, asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Entries of another version of stepbot's code are not used."""
    import stepbot.runtime.cache.sources as keys

    original: Callable[[], str] = own_code
    monkeypatch.setattr(keys, "own_code", lambda: original() + "!")
    keys.environment.cache_clear()
    try:
        assert stepbot("convert", four_bar.name, *FAST).code == 0
    finally:
        monkeypatch.undo()
        keys.environment.cache_clear()
    assert asked == READ
    assert Cache(cache).usage().entries > 0
