"""Changes of the source, and which tests are run for each."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

from . import page
from .reach import FOLDER, Reach
from .source import ROOMS, Outcome, drawn, section
from .source_changes import changes

_SOURCE = b'''"""A module of 1 line."""
LIMIT: int = 3


def f(x: float, found: list[str]) -> bool:
    """The 2 cases."""
    assert x > 0, "a number"
    if x < LIMIT and not found:
        found.append(f"{x + 1}")
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
        (9, 'found.append(f"{x + 1}")', "..."),
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


_TESTS = """
import os, time
from stepbot.geometry.fixed_point import exact_sum

def test_slow():
    time.sleep(0.3)
    assert exact_sum([1.0]) == 1.0

def test_fast():
    assert exact_sum([1.0]) == 1.0

def test_in_a_forked_process():
    child = os.fork()
    if not child:
        exact_sum([1.0])
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0

def test_that_fails():
    assert exact_sum([1.0]) == 2.0

def test_of_something_else():
    pass
"""


@pytest.mark.slow
def test_tests_that_reach_a_line(tmp_path: Path) -> None:
    """The fastest first, also from a forked process; not those that fail, nor those that do not call it."""
    (tmp_path / "records").mkdir()
    (tmp_path / "test_sums.py").write_text(_TESTS, encoding="utf-8")
    environment = {**os.environ, FOLDER: str(tmp_path / "records")}
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "tests.mutation.reach", str(tmp_path)]
    assert subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=False).returncode == 1
    reach, path = Reach.read(tmp_path / "records"), "stepbot/geometry/fixed_point.py"
    source = (ROOT / "src" / path).read_bytes()
    lines = source.decode().splitlines()
    inside, other = (
        lines.index(text) + 1 for text in ("        return fsum(numbers)", "    return order[begins], kinds")
    )
    found = [name.partition("::")[2] for name in reach.tests(path, inside, source)]
    assert set(found) == {"test_fast", "test_in_a_forked_process", "test_slow"}
    assert found[-1] == "test_slow"
    assert not reach.tests(path, other, source)
    assert len(reach.tests(path, 1, source)) == 3, "what runs on import is reached by all that reach the file"


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
