"""The import path of stepbot and its workers excludes the current folder."""

import os
import sys
import threading
from pathlib import Path

import pytest

import stepbot
from stepbot.runtime.fork_server import ForkServer, can_serve
from stepbot.runtime.import_path import safe_import_path
from stepbot.runtime.worker import Worker
from tests.processes import call_isolated

STANDARD_LIBRARY = str(Path(threading.__file__).parent)
FUNCTIONS = "tests.unit.runtime.isolated_functions"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with modules that must not be imported."""
    for name in ("random", "statistics", "sitecustomize", "lxml"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'marker')!r}, 'a').write(__name__)\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_current_folder_and_relative_entries_are_removed(here: Path) -> None:
    """The current folder and relative entries are removed; entries after the standard library are kept."""
    path = ["", ".", "src", str(here), f"{here}/x/..", "/opt/a", STANDARD_LIBRARY, "/opt/b", str(here)]
    assert safe_import_path(path, "") == ["/opt/a", STANDARD_LIBRARY, "/opt/b", str(here)]
    link = here.parent / "link"
    link.symlink_to(here)
    assert safe_import_path([str(link), "/opt/a"], "") == ["/opt/a"]


def test_absolute_entry_of_python_path_is_kept(here: Path) -> None:
    """An absolute entry of PYTHONPATH is kept; an empty or relative one is removed."""
    assert safe_import_path([str(here), "/opt/a"], f"/opt/a{os.pathsep}{here}") == [str(here), "/opt/a"]
    assert safe_import_path([str(here), "/opt/a"], f"{os.pathsep}/opt/a{os.pathsep}.") == ["/opt/a"]


def test_folder_that_holds_stepbot_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """stepbot can run in the folder that it is installed in."""
    root = Path(stepbot.__file__).resolve().parents[1]
    monkeypatch.chdir(root)
    assert safe_import_path([str(root)], "") == [str(root)]


@pytest.mark.parametrize("first", ["", ".", "HERE"])
def test_worker_imports_nothing_from_the_current_folder(
    here: Path, monkeypatch: pytest.MonkeyPatch, first: str
) -> None:
    """A worker does not import from the current folder, however that is in the caller's path."""
    monkeypatch.syspath_prepend(str(here) if first == "HERE" else first)
    for module in ("random", "statistics", "lxml"):
        assert Path(call_isolated(f"{FUNCTIONS}:imported_file", module)).parent != here
    assert not (here / "marker").exists()


@pytest.mark.skipif(not can_serve(), reason="no fork server on this system")
def test_fork_server_imports_nothing_from_the_current_folder(here: Path) -> None:
    """Neither the fork server nor its workers import from the current folder."""
    with ForkServer(("random", f"{FUNCTIONS}:start_thread")) as threaded, ForkServer(("lxml",)) as server:
        for one in (server, threaded):
            with Worker(f"{FUNCTIONS}:imported_file", start=one.fork) as worker:
                assert Path(worker.submit("statistics").result()).parent != here
    assert not (here / "marker").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="no colon in names of folders")
def test_folder_with_a_separator_in_its_name(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder name with a path separator does not add an entry in the current folder."""
    (here / "lib").mkdir()
    (here / "random.py").rename(here / "lib" / "random.py")
    monkeypatch.syspath_prepend("/opt/x:lib")
    assert Path(call_isolated(f"{FUNCTIONS}:imported_file", "random")).parent != here / "lib"
    assert not (here / "marker").exists()
