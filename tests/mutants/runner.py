"""Runs tests in forks of a process that has loaded the packages they need, on a copy of the checkout."""

import json
import os
import shutil
import signal
import sys
import time
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

_PARTS = ("src", "cli", "tests", "robot_library", "schemas", "pyproject.toml", "docs", "benchmarks", "README.md")
NOTICED, PASSED, LATE = "noticed", "passed", "late"

Reached = dict[str, dict[str, float]]
"""For each function, as ``file:line``, the tests that call it, each with its time [s]."""


def copied(root: Path, folder: Path) -> Path:
    """A copy of the checkout; what is not code is linked."""
    for name in _PARTS:
        if (root / name).is_dir() and name in ("src", "tests"):
            shutil.copytree(root / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (root / name).exists():
            (folder / name).symlink_to(root / name)
    return folder


def preload() -> None:
    """Load packages that take long, and none of stepbot's own modules."""
    for name in ("numpy", "lxml.etree", "pydantic", "ruamel.yaml", "trimesh", "mujoco", "hypothesis", "OCP.gp"):
        __import__(name)


class _Callers:
    """Notes for each test which functions of stepbot it calls, by their first lines."""

    def __init__(self, folder: Path) -> None:
        self._prefix, self._called = f"{folder}/src/stepbot/", set[tuple[str, int]]()
        self.reached: Reached = {}

    def _trace(self, frame: FrameType, event: str, argument: object) -> None:  # noqa: ARG002
        code = frame.f_code
        if code.co_filename.startswith(self._prefix):
            self._called.add((code.co_filename, code.co_firstlineno))

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Note what one test calls."""
        self._called.clear()
        start = time.monotonic()
        sys.settrace(self._trace)
        yield
        sys.settrace(None)
        seconds = time.monotonic() - start
        for file, line in self._called:
            key = f"src/stepbot/{file.removeprefix(self._prefix)}:{line}"
            self.reached.setdefault(key, {})[item.nodeid] = seconds


def reached_by(folder: Path, tests: Sequence[str], seconds: float) -> Reached:
    """Which tests of some files call which functions, in processes of their own."""
    answer = folder / "reached.json"
    answer.unlink(missing_ok=True)
    with _child() as is_child:
        if is_child:
            callers = _Callers(folder)
            _pytest(folder, tests, [callers])
            answer.write_text(json.dumps(callers.reached), encoding="utf-8")
            os._exit(0)
        _waited(seconds)
    return json.loads(answer.read_text(encoding="utf-8")) if answer.exists() else {}


def outcome(folder: Path, tests: Collection[str], seconds: float) -> str:
    """Whether tests pass; those that take longer than a time limit [s] count as failed."""
    with _child() as is_child:
        if is_child:
            os._exit(0 if _pytest(folder, [*tests, "-x"], []) == 0 else 1)
        status = _waited(seconds)
    return LATE if status is None else PASSED if status == 0 else NOTICED


_running: list[int] = []


@contextmanager
def _child() -> Iterator[bool]:
    """Fork; True in the child. The child has a session of its own, which ends with the block."""
    sys.stdout.flush()
    number = os.fork()
    if number == 0:
        try:
            os.setsid()
            yield True
        finally:
            os._exit(2)  # what the caller's blocks would clean up is not the child's
    _running[:] = [number]
    try:
        yield False
    finally:
        with suppress(ProcessLookupError):
            os.killpg(number, signal.SIGKILL)


def _waited(seconds: float) -> int | None:
    """Exit status of the child; None after a time limit [s], when it is killed."""
    (number,), deadline = _running, time.monotonic() + seconds
    while time.monotonic() < deadline:
        done, status = os.waitpid(number, os.WNOHANG)
        if done:
            return status
        time.sleep(0.05)
    os.killpg(number, signal.SIGKILL)
    os.waitpid(number, 0)
    return None


def _pytest(folder: Path, arguments: Sequence[str], plugins: list[Any]) -> int:
    with (folder.parent / f"{folder.name}.txt").open("w", encoding="utf-8") as output:
        os.dup2(output.fileno(), 1)
        os.dup2(output.fileno(), 2)
    os.chdir(folder)
    ours = [str(folder), str(folder / "src"), str(folder / "cli")]
    sys.path[:] = [*ours, *(path for path in sys.path if "/src" not in path and "/cli" not in path)]
    for name in [name for name in sys.modules if name.split(".")[0] in ("stepbot", "stepbot_cli", "tests")]:
        del sys.modules[name]
    os.environ |= {"PYTHONPATH": os.pathsep.join(ours), "PYTHONDONTWRITEBYTECODE": "1"}
    quiet = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-m", "not long", "--no-header", "--tb=no"]
    return int(pytest.main([*quiet, *arguments], plugins=plugins))
