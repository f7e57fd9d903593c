"""Which tests reach which functions of stepbot: a plugin of pytest records it, and :class:`Reach` reads it.

STEPBOT_REACH=FOLDER python -m pytest -p tests.mutation.reach ...

coverage.py has contexts of tests, and loses them in the processes that stepbot forks for parsing and engines.
"""

import ast
import mmap
import os
import sys
import threading
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import FrameType

import pytest
from msgspec import Struct

from tests.conftest import ROOT

_WHOLE = "tests/recorded/"
FOLDER = "STEPBOT_REACH"
"""Environment variable with the folder of the records."""


class Recorder:
    """Appends the first call of each function in each test, in this process and in those that it forks."""

    def __init__(self, folder: Path, source: Path) -> None:
        self._source = f"{source}{os.sep}"
        self._records, self._results = (folder / f"{os.getpid()}.{name}" for name in ("calls", "tests"))
        self._number = mmap.mmap(-1, 4)  # of the test; forked processes share it
        self._tests = 0
        self._process, self._out, self._test = 0, -1, b""
        self._seen: set[int] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self) -> Iterator[None]:
        """Record what the test and its fixtures call."""
        self._tests += 1
        self._number[:] = self._tests.to_bytes(4, "little")
        threading.settrace(self._called)
        sys.settrace(self._called)
        try:
            return (yield)
        finally:
            sys.settrace(None)
            threading.settrace(None)  # type: ignore[arg-type]

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep the outcome and the duration of set-up, call and tear-down."""
        if self._tests:  # not in the process that distributes the tests
            with self._results.open("a", encoding="utf-8") as file:
                file.write(f"{self._tests}\t{report.outcome}\t{report.duration:.4f}\t{report.nodeid}\n")

    def _called(self, frame: FrameType, *_: object) -> None:
        code, test = frame.f_code, self._number[:]
        if test != self._test:
            self._test = test
            self._seen.clear()
        if id(code) in self._seen:
            return
        self._seen.add(id(code))
        if not code.co_filename.startswith(self._source):
            return
        if os.getpid() != self._process:
            self._process = os.getpid()
            self._out = os.open(self._records, os.O_APPEND | os.O_CREAT | os.O_WRONLY)
        path = code.co_filename.removeprefix(self._source)
        os.write(self._out, b"%d\t%s\t%d\n" % (int.from_bytes(test, "little"), path.encode(), code.co_firstlineno))


def pytest_configure(config: pytest.Config) -> None:
    """Record, where the environment asks for it."""
    if folder := os.environ.get(FOLDER):
        config.pluginmanager.register(Recorder(Path(folder), ROOT / "src"))


class Reach(Struct, frozen=True):
    """The tests that reach each function, the fastest first."""

    seconds: Mapping[str, float]
    """How long each test that passed took [s]."""
    functions: Mapping[tuple[str, int], frozenset[str]]
    """By path below ``src`` and first line."""

    @staticmethod
    def read(folder: Path) -> "Reach":
        """Read the records of a folder."""
        seconds, unsound = Counter[str](), set[str]()
        functions = defaultdict[tuple[str, int], set[str]](set)
        for results in sorted(folder.glob("*.tests")):
            names = {}
            for line in results.read_text(encoding="utf-8").splitlines():
                number, outcome, duration, name = line.split("\t", 3)
                names[number] = name
                seconds[name] += float(duration)
                if outcome != "passed":
                    unsound.add(name)
            for line in results.with_suffix(".calls").read_text(encoding="utf-8").splitlines():
                number, path, first = line.split("\t")
                if number in names:
                    functions[path, int(first)].add(names[number])
        sound = {name: time for name, time in seconds.items() if name not in unsound}
        return Reach(sound, {key: frozenset(tests & sound.keys()) for key, tests in functions.items()})

    def tests(self, path: str, line: int, source: bytes) -> list[str]:
        """The tests that reach a line of a file below ``src``; for what runs on import, those of the whole file."""
        first = _function(source, line)
        reached = (tests for (one, at), tests in self.functions.items() if one == path and first in (None, at))
        return sorted(set[str]().union(*reached), key=self._rank)

    def _rank(self, test: str) -> tuple[float, str]:
        """What compares whole results comes as early as tests of a tenth of its duration."""
        return self.seconds[test] * (0.1 if test.startswith(_WHOLE) else 1.0), test


def _function(source: bytes, line: int) -> int | None:
    """The first line of the innermost function that a line is in, its decorators included; None outside of all."""
    found: ast.FunctionDef | ast.AsyncFunctionDef | None = None
    for node in ast.walk(ast.parse(source)):  # outer ones come first
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.body[0].lineno <= line <= (
            node.end_lineno or 0
        ):
            found = node
    return min([found.lineno, *(one.lineno for one in found.decorator_list)]) if found else None
