"""No command and no worker imports a module from the current folder."""

import importlib.metadata
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Collection
from pathlib import Path

import pytest

from stepbot.runtime.programs import find_program
from tests.command_line import LONGEST, convert_once

pytestmark = pytest.mark.usefixtures("without_cache")

ARM = ("arm2.robot.yaml", "arm2.step")
PROGRAMS = (
    "gz",
    "ign",
    "sh",
    "python",
    "python3",
    Path(sys.executable).name,
    "ldconfig",
    "uname",
    "gcc",
    "cc",
    "lscpu",
)
"""Names that stepbot, Python and packages look for when they are imported."""
RUNS_PROGRAMS = (sys.executable, "-P", "-c")
INSTALLED = (sys.executable, "-P", "-m", "stepbot_cli")
"""The start of the installed command: its own folder is first on the path."""


def module_names() -> set[str]:
    """Module names: the standard library, all packages, and those that Python imports at its start."""
    packages = {name for name in importlib.metadata.packages_distributions() if name.isidentifier()}
    return {*sys.stdlib_module_names, *packages, "stepbot", "stepbot_cli", "sitecustomize", "usercustomize", "tests"}


def imported_at_start(folder: Path, python_path: str) -> set[str]:
    """Modules that Python, and `.pth` files, import or look for before the first line of stepbot."""
    (folder / "names_at_start.py").write_text("import sys; print(*(name.partition('.')[0] for name in sys.modules))")
    command = [sys.executable, "-m", "names_at_start"]

    def run() -> set[str]:
        changed = {**os.environ, "PYTHONPATH": python_path}
        done = subprocess.run(command, cwd=folder, env=changed, capture_output=True, text=True, check=True)
        return set(done.stdout.split())

    loaded, marker = run(), folder / "found"
    set_traps(folder, marker, loaded)
    return loaded | run() | set(marker.read_text(encoding="utf-8").split() if marker.exists() else ())


def set_traps(folder: Path, marker: Path, spared: Collection[str] = ()) -> None:
    """Write files named like modules, each of which records in ``marker`` that it ran."""
    code = f"with open({str(marker)!r}, 'a') as file: file.write(__name__ + ' ')\n"
    for name in module_names().difference(spared):
        (folder / f"{name}.py").write_text(code)


class Trap:
    """A folder with a robot and files named like modules, each of which records that it ran."""

    def __init__(self, folder: Path, robots: Path, spared: set[str]) -> None:
        self.folder, self.marker = folder / "trap", folder / "marker"
        self.folder.mkdir()
        for file in ARM:
            shutil.copy(robots / "stepbot_arm2" / file, self.folder)
        set_traps(self.folder, self.marker, spared)

    def run(self, command: tuple[str, ...], *arguments: str, **variables: str) -> str:
        """Run a command in the folder; it must succeed and import no file there; returns its standard output."""
        environment = {**os.environ, "PYTHONIOENCODING": "utf-8", **variables}
        run = subprocess.run(
            [*command, *arguments],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=LONGEST,
            check=False,
        )
        assert not self.marker.exists(), f"{arguments}: imported {self.marker.read_text()}"
        assert run.returncode == 0, run.stderr
        return run.stdout

    def set_programs(self, entry: str) -> str:
        """Write programs that record that they ran; returns a PATH on which this folder is first, as ``entry``."""
        for name in PROGRAMS:
            (self.folder / name).write_text(f"#!/bin/sh\necho {name} >> {self.marker}\necho 12.0\n")
            (self.folder / name).chmod(0o755)
        path = f"{entry}{os.pathsep}{os.environ['PATH']}"
        unprotected = [*RUNS_PROGRAMS, "import subprocess; subprocess.run(['gz', 'sdf', '--versions'])"]
        subprocess.run(unprotected, cwd=self.folder, env={**os.environ, "PATH": path}, check=True)
        assert self.marker.read_text().split() == ["gz"], "the programs are found by whoever does not look out"
        self.marker.unlink()
        return path

    def assert_as_without_programs(self, folder: str) -> None:
        """Assert that libsdformat has checked a robot's files only if the system has it."""
        report = json.loads((self.folder / folder / "report.json").read_text(encoding="utf-8"))
        checks = [check for check in report["checks"] if check["engine"] == "libsdformat"]
        gazebo = any(find_program(name) for name in ("gz", "ign"))
        is_old = any("the file has version" in check["why"] for check in checks)  # it runs, and does not read this one
        assert {check["status"] for check in checks} == ({"passed"} if gazebo and not is_old else {"not run"})

    def robot_files(self, folder: str) -> dict[str, bytes]:
        """The files of the robot without the report, which has times."""
        found = (self.folder / folder).rglob("*")
        files = {path.relative_to(self.folder / folder).as_posix(): path for path in found if path.is_file()}
        return {name: path.read_bytes() for name, path in files.items() if not name.endswith(".json")}


@pytest.mark.slow
def test_no_command_imports_from_the_current_folder(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """No command, worker or server imports a file of the folder, and the output is that of another folder.

    No program of the folder runs, even first in PATH: `gz` and `ign` are found in absolute entries only.
    """
    trap = Trap(tmp_path, robot_library, set())
    path = "" if os.name == "nt" else trap.set_programs("")
    trap.run(INSTALLED, "convert", "arm2.robot.yaml", "-o", "out", **({"PATH": path} if path else {}))
    elsewhere = convert_once(tmp_path_factory, "stepbot_arm2", robot_library / "stepbot_arm2" / "arm2.robot.yaml")
    clean = {path.name: path.read_bytes() for path in elsewhere.folder.iterdir() if path.suffix in (".urdf", ".xml")}
    written = trap.robot_files("out")
    assert clean
    assert {name: written[name] for name in clean} == clean
    trap.assert_as_without_programs("out")
    assert json.loads(trap.run(INSTALLED, "formats", "--json"))


@pytest.mark.long
def test_no_further_command_imports_from_the_current_folder(tmp_path: Path, robot_library: Path) -> None:
    """Commands that start the same workers as `convert`."""
    trap = Trap(tmp_path, robot_library, set())
    trap.run(INSTALLED, "library", "export", "arm2", "-o", "out")
    trap.run(INSTALLED, "verify", "out/arm2.urdf", "out/arm2.sdf", "out/arm2.xml")
    assert "shoulder" in trap.run(INSTALLED, "inspect", "arm2.step")
    trap.run(INSTALLED, "check", "--step", "--", "arm2.robot.yaml")
    trap.run(INSTALLED, "convert", "arm2.robot.yaml", "-o", "converted", "--no-verify")
    trap.run(INSTALLED, "uptodate", "-o", "converted", "arm2.robot.yaml")
    trap.run(INSTALLED, "batch", "-j", "2", "-o", "many", "arm2.robot.yaml")
    assert trap.robot_files("many/arm2") == trap.robot_files("out")


@pytest.mark.long  # tests/unit/runtime/test_import_path.py removes the entries in a new interpreter
@pytest.mark.parametrize(
    "python_path", [pytest.param(os.pathsep, id="empty"), pytest.param(f"{os.pathsep}.", id="relative")]
)
def test_no_import_from_the_current_folder_where_python_begins_with_it(
    tmp_path: Path, robot_library: Path, python_path: str
) -> None:
    """stepbot removes the current folder from the path, where `python -m` or PYTHONPATH put it first."""
    (tmp_path / "start").mkdir()
    spared = {
        *imported_at_start(tmp_path / "start", python_path),
        "stepbot",
        "stepbot_cli",
        "sitecustomize",
        "usercustomize",
    }
    trap = Trap(tmp_path, robot_library, spared)
    trap.run((sys.executable, "-m", "stepbot_cli"), "convert", "arm2.robot.yaml", "-o", "out", PYTHONPATH=python_path)
    assert (trap.folder / "out" / "arm2.urdf").is_file()


@pytest.mark.long  # the first test has an empty entry in PATH
@pytest.mark.skipif(os.name == "nt", reason="the program is a script of a Unix shell here")
@pytest.mark.parametrize("entry", [pytest.param("", id="empty entry"), pytest.param(".", id="relative entry")])
def test_no_program_of_the_current_folder_is_run(entry: str, tmp_path: Path, robot_library: Path) -> None:
    """No program of the current folder runs where it is first in PATH by another spelling, also for `verify`."""
    trap = Trap(tmp_path, robot_library, module_names())
    path = trap.set_programs(entry)
    trap.run(INSTALLED, "convert", "arm2.robot.yaml", "-o", "out", "-f", "sdf", PATH=path)
    trap.assert_as_without_programs("out")
    trap.run(INSTALLED, "verify", "out/arm2.sdf", PATH=path)
