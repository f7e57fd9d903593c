"""Changes of the source, and which tests are run for each."""

import ast
from pathlib import Path

import pytest

from tests.conftest import ROOT

from . import page
from .source import ROOMS, Outcome, drawn, section, selected
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
def test_changes_are_drawn_alike_and_have_tests() -> None:
    """The seed decides; a smaller number is the start of a larger one; the tests of each exist."""
    some = drawn(40, 1)
    assert drawn(60, 1)[:40] == some
    assert drawn(40, 2) != some
    assert {change.path.split("/")[2] for change in some} <= {*ROOMS}
    for change in some[:8]:
        tests = selected(change.path)
        assert all((ROOT / test).exists() for test in tests), change.path
    assert selected("src/stepbot/robot/loop_followers.py")[0] == "tests/unit/robot/test_loop_followers.py"


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
