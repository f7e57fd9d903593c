"""The ``stepbot`` command, and the files it writes."""

import io
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
from msgspec import Struct
from msgspec.structs import asdict

from stepbot.runtime.cache import Cache
from stepbot_cli import main

LONGEST = 300.0
"""Time limit [s] of a command in a test."""
BESIDE = (".drake.sdf", ".world.sdf", ".scene.xml")
"""Ends of the names of files beside the main one of a format."""
COMMAND = (sys.executable, "-m", "stepbot_cli")


def cache_of_this_run() -> Cache:
    """The cache that commands of this run of the tests share."""
    return Cache(Path(os.environ["STEPBOT_CACHE"]))


class Run(Struct, frozen=True):
    """Exit code and output of a command."""

    code: int
    out: str
    err: str


def environment(changes: Mapping[str, str] | None = None) -> dict[str, str]:
    """This process's environment with some variables set; output is UTF-8 by default."""
    return {**os.environ, "PYTHONIOENCODING": "utf-8", **(changes or {})}


def stepbot(*arguments: str | Path, cwd: Path, changes: Mapping[str, str] | None = None) -> Run:
    """Run ``stepbot`` in this process, in a folder, with some environment variables changed.

    Inside pytest, :mod:`tests.warm` starts its workers.
    """
    out, err = _stream(), _stream()
    code = _main(arguments, cwd, changes, out, err)
    return Run(code, _text(out), _text(err))


def printed(arguments: Sequence[str], cwd: Path, changes: Mapping[str, str] | None = None) -> tuple[int, str]:
    """Run ``stepbot`` as :func:`stepbot` does; returns its exit code, and what it prints on a terminal."""
    terminal = _stream()
    return _main(arguments, cwd, changes, terminal, terminal), _text(terminal)


def _stream() -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(), encoding="utf-8", newline="", write_through=True)


def _text(stream: io.TextIOWrapper) -> str:
    stream.seek(0)
    return stream.read()


def _main(
    arguments: Sequence[str | Path],
    cwd: Path,
    changes: Mapping[str, str] | None,
    out: io.TextIOWrapper,
    err: io.TextIOWrapper,
) -> int:
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(cwd)
        for name, value in (changes or {}).items():
            patch.setenv(name, value)
        return main([*map(str, arguments)])


def stepbot_process(*arguments: str | Path, cwd: Path, changes: Mapping[str, str] | None = None) -> Run:
    """The same in a separate process, started as for every user: takes several times as long."""
    command = [*COMMAND, *map(str, arguments)]
    run = subprocess.run(command, cwd=cwd, env=environment(changes), capture_output=True, timeout=LONGEST, check=False)
    return Run(run.returncode, run.stdout.decode("utf-8"), run.stderr.decode("utf-8"))


class Conversion(Struct, frozen=True, dict=True):
    """A converted robot."""

    folder: Path
    """Folder of the files."""
    run: Run

    @cached_property
    def report(self) -> dict[str, Any]:
        """The content of ``report.json``."""
        report: dict[str, Any] = json.loads((self.folder / "report.json").read_text(encoding="utf-8"))
        return report

    def file(self, suffix: str) -> Path:
        """The file with a suffix: ``.urdf``, ``.sdf`` or ``.xml``."""
        (path,) = (path for path in self.folder.glob(f"*{suffix}") if not path.name.endswith(BESIDE))
        return path


def convert(sidecar: Path, folder: Path, *options: str | Path, run: Callable[..., Run] = stepbot) -> Conversion:
    """Convert a sidecar into a folder; the test fails if the command does."""
    return assert_converted(Conversion(folder, run("convert", sidecar, "-o", folder, *options, cwd=folder.parent)))


def convert_once(temporary: pytest.TempPathFactory, name: str, sidecar: Path, *options: str | Path) -> Conversion:
    """Convert a sidecar once for all tests that use this name, in any process."""
    root = temporary.getbasetemp()
    folder = (root.parent if "PYTEST_XDIST_WORKER" in os.environ else root) / "converted" / name
    file = folder / "run.json"
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        deadline = time.monotonic() + 1.1 * LONGEST
        while not file.exists():
            assert time.monotonic() < deadline, f"nobody converted {name}"
            time.sleep(0.05)
        run = Run(**json.loads(file.read_text(encoding="utf-8")))
    else:
        run = stepbot("convert", sidecar, "-o", "out", *options, cwd=folder)
        draft = folder / "run.json.draft"
        draft.write_text(json.dumps(asdict(run)), encoding="utf-8")
        draft.replace(file)
    return assert_converted(Conversion(folder / "out", run))


def assert_converted(conversion: Conversion) -> Conversion:
    """The conversion itself; the test fails if the command did."""
    assert conversion.run.code == 0, conversion.run.err
    return conversion


def snapshot(folder: Path) -> dict[str, bytes]:
    """The bytes of all files below a folder, including hidden ones; empty folders have a trailing slash."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file():
            found[name] = path.read_bytes()
        elif not any(path.iterdir()):
            found[f"{name}/"] = b""
    return found
