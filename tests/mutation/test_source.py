"""Changes of the source, and which tests are run for each."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from tests.conftest import ROOT

from . import page
from .reach import FOLDER, Place, Reach, marked
from .source import ROOMS, Outcome, drawn, section, selected
from .source_changes import Change, changes

_SOURCE = b'''"""A module of 1 line."""
LIMIT: int = 3


def f(x: float, found: list[str]) -> bool:
    """The 2 cases."""
    assert x > 0, "a number"
    if x < LIMIT and not found:
        found.extend(f"{x + 1}" for _ in zip(found, found, strict=True))
        return x * 2.0 == -x
    raise ValueError(x + 1)
'''


def test_every_change_of_a_module() -> None:
    """Operators, comparisons, numbers, conditions, results and calls; nothing in messages, assertions, annotations."""
    found = [(change.line, change.before, change.text) for change in changes("m.py", _SOURCE)]
    assert found == [
        (2, "3", "4"),
        (8, "x < LIMIT and not found", "not (x < LIMIT and not found)"),
        (8, "<", "<="),
        (8, "and", "or"),
        (8, "not", ""),
        (9, 'found.extend(f"{x + 1}" for _ in zip(found, found, strict=True))', "..."),
        (10, "x * 2.0 == -x", "None"),
        (10, "*", "/"),
        (10, "2.0", "4.0"),
        (10, "==", "!="),
        (10, "-", ""),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("path", ["src/stepbot/robot/closures.py", "src/stepbot/draft/mechanism/joints.py"])
def test_changed_source_is_python(path: str) -> None:
    """Each change gives another program, also after characters of several bytes."""
    source = (ROOT / path).read_bytes()
    found = changes(path, source)
    assert len(found) > 50
    before = ast.dump(ast.parse(source))
    for change in found[::9]:
        assert ast.dump(ast.parse(change.apply(source))) != before, change.name


@pytest.mark.slow
def test_changes_are_drawn_alike() -> None:
    """The seed decides; a smaller number is the start of a larger one."""
    some = drawn(40, 1)
    assert drawn(60, 1)[:40] == some
    assert drawn(40, 2) != some
    assert {change.path.split("/")[2] for change in some} <= {*ROOMS}


_REACHED = '''"""A module."""
LIMIT = 3


def is_small(x: int, least: int = 0) -> bool:
    """Whether x is small."""
    if x < LIMIT:
        return x >= least
    return False


def other() -> None:
    """What no test calls."""
    is_small(1)
'''
_TESTS = """
import os, subprocess, sys
from stepbot.module import is_small

def test_small():
    assert is_small(1)

def test_large():
    assert not is_small(5)

def test_in_a_forked_process():
    child = os.fork()
    if not child:
        is_small(1)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0

def test_in_another_process():
    subprocess.run([sys.executable, "-c", "from stepbot.module import is_small; is_small(2)"], check=True)

def test_that_fails():
    assert is_small(5)

def test_of_something_else():
    pass
"""


@pytest.mark.slow
def test_tests_that_reach_a_line(tmp_path: Path) -> None:
    """Also from other processes; not those that fail, nor those that take another branch."""
    source, records = tmp_path / "src", tmp_path / "records"
    for folder in (source / "stepbot", records):
        folder.mkdir(parents=True)
    (source / "stepbot" / "__init__.py").touch()
    (source / "stepbot" / "module.py").write_text(_REACHED, encoding="utf-8")
    (tmp_path / "test_module.py").write_text(_TESTS, encoding="utf-8")
    marked(source, records)
    environment = {**os.environ, FOLDER: str(records), "PYTHONPATH": f"{source}{os.pathsep}{ROOT}"}
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "tests.mutation.reach", str(tmp_path)]
    assert subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=False).returncode == 1
    reach = Reach.read(records)

    def tests(line: int) -> set[str]:
        found = reach.tests("stepbot/module.py", line, _REACHED.encode())
        return {name.partition("::test_")[2] for name in found}

    small = {"small", "in_a_forked_process", "in_another_process"}
    assert tests(8) == small
    assert tests(9) == {"large"}
    assert tests(7) == tests(5) == tests(2) == small | {"large"}, (
        "the condition, the head, and the constant that it reads"
    )
    assert not tests(14)


@pytest.mark.slow
def test_marked_source_is_python(tmp_path: Path) -> None:
    """What is marked compiles, and no module has a variable of the name of the marks."""
    assert not any("_PLACES_RUN" in path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py"))
    shutil.copytree(ROOT / "src" / "stepbot" / "robot", tmp_path / "stepbot" / "robot")
    marked(tmp_path, tmp_path)
    for path in sorted(tmp_path.rglob("*.py")):
        compile(path.read_bytes(), path, "exec", dont_inherit=True)


def test_tests_of_the_room_come_first_and_recorded_results_last() -> None:
    """Those that run little else before others, one case of each test before further ones, each kind up to a limit."""
    place = Place("stepbot/robot/closures.py", 1, 1, 10**6, ())
    seconds = {
        "tests/unit/robot/test_a.py::test_cases[1]": 1.0,
        "tests/unit/robot/test_a.py::test_cases[2]": 1.0,
        "tests/unit/robot/test_b.py::test_narrow": 1.0,
        "tests/unit/robot/test_b.py::test_long": 1000.0,
        "tests/cli/test_c.py::test_command": 1.0,
        "tests/recorded/test_recorded.py::test_result[a]": 5.0,
        "tests/recorded/test_recorded.py::test_result[b]": 4.0,
        "tests/recorded/test_recorded.py::test_result[c]": 1000.0,
    }
    bits = {name: np.array([0x80 if "narrow" in name else 0xC0], dtype=np.uint8) for name in seconds}
    change = Change("src/stepbot/robot/closures.py", 0, 0, "", 5, "")
    found = selected(change, ROOT, Reach(seconds, [place, replace(place, path="stepbot/other.py")], bits))
    assert [name.partition("::test_")[2] for name in found] == [
        "narrow",
        "cases[1]",
        "cases[2]",
        "command",
        "result[b]",
        "result[a]",
    ]


@pytest.mark.slow
def test_section_has_shares_and_what_is_not_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A section is replaced; the others stay."""
    one, two, *_ = drawn(2, 1)
    text = section([Outcome(one, True, "a test", 1.0), Outcome(two, False, "", 1.0)], "make mutants")
    assert "| all | 2 | 1 | 50% |" in text
    assert f"- {two.name}\n" in text
    assert one.name not in text
    monkeypatch.setattr(page, "PAGE", tmp_path / "page.md")
    page.PAGE.write_text(f"above\n{page.CHANGED}\nnumbers\n")
    page.write_section(page.SOURCE, "\nold\n")
    page.write_section(page.SOURCE, text)
    page.write_section("", "top\n")
    assert page.PAGE.read_text() == f"top\n{page.CHANGED}\nnumbers\n{page.SOURCE}{text}"
