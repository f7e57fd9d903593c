"""Which tests reach which statements of stepbot.

:func:`marked` has a copy of the source mark what runs, this module is the plugin of pytest that records the marks of
each test, and :class:`Reach` reads the records:

STEPBOT_REACH=FOLDER python -m pytest -p tests.mutation.reach ...

coverage.py has contexts of tests, and loses them in the processes that stepbot starts for parsing and engines.
"""

import ast
import json
import os
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest
from msgspec import Struct

FOLDER = "STEPBOT_REACH"
"""Environment variable with the folder of the records."""
_TABLE = "STEPBOT_REACH_TABLE"
"""Environment variable with the file of the marks, which a process of pytest and those that it starts share."""
_PLACES = "places.json"
_MODULE = '''"""The marks of the statements that have run, one byte each."""
import mmap
import os

try:
    with open(os.environ["{table}"], "r+b") as file:
        RUN = mmap.mmap(file.fileno(), 0)
except (KeyError, OSError):
    RUN = bytearray({count})
'''
_BLOCKS = ("body", "orelse", "finalbody")
_BRANCHES = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


class Place(Struct, frozen=True):
    """Statements that run one after the other, if none of them raises."""

    path: str
    """Of the file, below ``src``."""
    function: int
    """The line where the innermost function begins, decorators included; 0 outside of all."""
    first: int
    last: int
    """The lines of the statements."""
    names: tuple[str, ...]
    """What they read: constants and defaults matter where their names are read."""


def marked(source: Path, folder: Path) -> None:
    """Have all functions of a copy of stepbot mark what runs; its places are listed in a folder of records."""
    places = list[Place]()
    for path in sorted((source / "stepbot").rglob("*.py")):
        tree = ast.parse(path.read_bytes())
        found = list(_marks(tree, path.relative_to(source).as_posix(), len(places)))
        if found:
            places += found
            at = next((n for n, one in enumerate(tree.body) if not _comes_first(one)), len(tree.body))
            tree.body[at:at] = ast.parse("from stepbot_reached import RUN as _PLACES_RUN").body
            path.write_text(ast.unparse(ast.fix_missing_locations(tree)), encoding="utf-8")
    (source / "stepbot_reached.py").write_text(_MODULE.format(table=_TABLE, count=len(places)), encoding="utf-8")
    rows = [[one.path, one.function, one.first, one.last, list(one.names)] for one in places]
    (folder / _PLACES).write_text(json.dumps(rows), encoding="utf-8")


def _comes_first(node: ast.stmt) -> bool:
    """Whether nothing may come before a statement: a docstring, or an import from the future."""
    is_docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return is_docstring or (isinstance(node, ast.ImportFrom) and node.module == "__future__")


def _marks(tree: ast.Module, path: str, number: int) -> Iterator[Place]:
    """Put marks into a module, numbered from a number on, and give their places."""

    def within(node: ast.AST, function: int) -> Iterator[Place]:
        nonlocal number
        if isinstance(node, _DEFINITIONS):
            function = min([node.lineno, *(one.lineno for one in node.decorator_list)])
        for block in (*_BLOCKS, "handlers", "cases"):
            statements = getattr(node, block, None)
            if not isinstance(statements, list):
                continue
            runs = function and block in _BLOCKS and not isinstance(node, ast.ClassDef)
            for run in list(_runs(statements)) if runs else []:
                yield Place(path, function, run[0].lineno, _last_line(run[-1]), _names(run))
                mark = ast.parse(f"_PLACES_RUN[{number}] = 1").body[0]
                number += 1
                at = statements.index(run[0])
                statements.insert(at + 1 if _comes_first(run[0]) and at == 0 else at, mark)
            for one in statements:
                yield from within(one, function)

    yield from within(tree, 0)


def _runs(statements: Sequence[ast.stmt]) -> Iterator[list[ast.stmt]]:
    """A block in parts: after a branch, which may return, another one begins."""
    run = list[ast.stmt]()
    for one in statements:
        run.append(one)
        if isinstance(one, _BRANCHES):
            yield run
            run = []
    if run:
        yield run


def _last_line(node: ast.stmt) -> int:
    """The last line of a statement that runs with those before it: of a branch, that of its condition."""
    if isinstance(node, _BRANCHES):
        within = [one.lineno for block in (*_BLOCKS, "handlers", "cases") for one in _parts(node, block)]
        return max(node.lineno, min(within) - 1)
    return node.end_lineno or node.lineno


def _parts(node: ast.stmt, block: str) -> list[ast.stmt]:
    found = getattr(node, block, [])
    return [one.body[0] if isinstance(one, ast.match_case) else one for one in found]


def _names(run: Sequence[ast.stmt]) -> tuple[str, ...]:
    """The names in statements, without those in the blocks of branches."""
    found = dict[str, None]()

    def within(node: ast.AST) -> None:
        if isinstance(node, ast.Name | ast.Attribute):
            found[node.id if isinstance(node, ast.Name) else node.attr] = None
        elif isinstance(node, ast.keyword) and node.arg:
            found[node.arg] = None
        for child in ast.iter_child_nodes(node):
            if not (isinstance(node, _BRANCHES) and isinstance(child, ast.stmt | ast.excepthandler | ast.match_case)):
                within(child)

    for one in run:
        within(one)
    return tuple(found)


def definition(source: bytes, line: int) -> tuple[int, frozenset[str]]:
    """The first line of the function whose head a line is in, 0 if in none, and the names that the line sets.

    Constants that are made of another one are among its names.
    """
    function, names, tree = 0, set[str](), ast.parse(source)
    for node in ast.walk(tree):  # outer ones come first
        if not (isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or 0)):
            continue
        if isinstance(node, _DEFINITIONS):
            function = min([node.lineno, *(one.lineno for one in node.decorator_list)])
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            names = _targets(node)
    for node in () if function else tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and names.intersection(_names([node])):
            names |= _targets(node)
    return function, frozenset(names)


def _targets(node: ast.Assign | ast.AnnAssign) -> set[str]:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return {one.id for one in targets if isinstance(one, ast.Name)}


class Recorder:
    """Writes down the marks of each test, those of the processes that it starts included."""

    def __init__(self, folder: Path, table: Path) -> None:
        self._folder, self._table = folder, np.memmap(table, dtype=np.uint8, mode="r+")
        self._tests = 0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self) -> Iterator[None]:
        """Record what the test and its fixtures run."""
        self._tests += 1
        self._table[:] = 0
        try:
            return (yield)
        finally:
            with (self._folder / f"{os.getpid()}.runs").open("a", encoding="ascii") as file:
                file.write(f"{self._tests}\t{np.packbits(self._table).tobytes().hex()}\n")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep the outcome and the duration of set-up, call and tear-down."""
        if self._tests:  # not in the process that distributes the tests
            with (self._folder / f"{os.getpid()}.tests").open("a", encoding="utf-8") as file:
                file.write(f"{self._tests}\t{report.outcome}\t{report.duration:.4f}\t{report.nodeid}\n")


def _table() -> Path | None:
    """A new table of marks for this process and those that it starts, where the environment asks for one."""
    folder = Path(os.environ.get(FOLDER, ""))
    if not (os.environ.get(FOLDER) and (folder / _PLACES).is_file()):
        return None
    table = folder / f"{os.getpid()}.table"
    table.write_bytes(bytes(len(json.loads((folder / _PLACES).read_text(encoding="utf-8")))))
    os.environ[_TABLE] = str(table)
    return table


_OWN_TABLE = _table()
"""Made when pytest imports the plugin, before anything imports stepbot."""


def pytest_configure(config: pytest.Config) -> None:
    """Record, where the environment asks for it."""
    if _OWN_TABLE is not None:
        config.pluginmanager.register(Recorder(_OWN_TABLE.parent, _OWN_TABLE))


class Reach(Struct, frozen=True, dict=True):
    """The tests that reach each statement."""

    seconds: Mapping[str, float]
    """How long each test that passed took [s]."""
    places: Sequence[Place]
    runs: Mapping[str, np.ndarray]
    """By test, a bit for each place."""

    @staticmethod
    def read(folder: Path) -> "Reach":
        """Read the records of a folder."""
        seconds, unsound, runs = Counter[str](), set[str](), dict[str, np.ndarray]()
        for results in sorted(folder.glob("*.tests")):
            names = {}
            for line in results.read_text(encoding="utf-8").splitlines():
                number, outcome, duration, name = line.split("\t", 3)
                names[number] = name
                seconds[name] += float(duration)
                if outcome != "passed":
                    unsound.add(name)
            for line in results.with_suffix(".runs").read_text(encoding="ascii").splitlines():
                number, bits = line.split("\t")
                if number in names and names[number] not in unsound:
                    runs[names[number]] = np.frombuffer(bytes.fromhex(bits), dtype=np.uint8)
        rows = json.loads((folder / _PLACES).read_text(encoding="utf-8"))
        places = [Place(path, function, first, last, tuple(names)) for path, function, first, last, names in rows]
        return Reach({name: seconds[name] for name in runs}, places, runs)

    @cached_property
    def _tests(self) -> tuple[list[str], np.ndarray]:
        names = sorted(self.runs)
        return names, np.array([self.runs[name] for name in names])

    @cached_property
    def breadth(self) -> Mapping[str, int]:
        """How many places each test runs: the fewer, the more it says of each."""
        names, bits = self._tests
        return dict(zip(names, np.bitwise_count(bits).sum(axis=1).tolist(), strict=True))

    @cached_property
    def _readers(self) -> Mapping[str, list[int]]:
        found = defaultdict[str, list[int]](list)
        for n, place in enumerate(self.places):
            for name in place.names:
                found[name].append(n)
        return found

    def tests(self, path: str, line: int, source: bytes) -> list[str]:
        """The tests that run a line of a file below ``src``, sorted.

        Of the head of a function, those that call it. Of other lines outside of functions, those that run what reads
        the names that the line sets: in the file itself if anything in it does; without names those of the whole file.
        """
        of_file = [n for n, place in enumerate(self.places) if place.path == path]
        within = [n for n in of_file if self.places[n].first <= line <= self.places[n].last]
        if within:
            return self._running([max(within, key=lambda n: self.places[n].first)])
        function, names = definition(source, line)
        if function:
            return self._running([n for n in of_file if self.places[n].function == function])
        readers = [n for name in names for n in self._readers.get(name, [])]
        return self._running([n for n in readers if self.places[n].path == path] or readers or of_file)

    def _running(self, places: Sequence[int]) -> list[str]:
        names, bits = self._tests
        runs = np.zeros(len(names), dtype=bool)
        for n in places:
            runs |= (bits[:, n >> 3] >> (7 - (n & 7)) & 1).astype(bool)
        return [name for name, does in zip(names, runs, strict=True) if does]
