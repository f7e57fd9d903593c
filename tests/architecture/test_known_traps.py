"""The table of known traps in docs/verification.md names an existing test for each trap, and lists each test."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "verification.md"
NAMED = re.compile(r"`(tests/\S+\.py)::(test_\w+)`")
OWN = "tests/simulators/test_known_traps.py"
"""A module that contains tests of traps only."""


def _section() -> str:
    text = PAGE.read_text(encoding="utf-8")
    return text.split("\n## Known traps\n")[1].split("\n## ")[0]


def _tests_in(path: str) -> set[str]:
    module = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {one.name for one in module.body if isinstance(one, ast.FunctionDef) and one.name.startswith("test_")}


def test_every_trap_has_a_test_that_exists() -> None:
    """Each row of the table names an existing test, and no test is named twice."""
    rows = [line for line in _section().splitlines() if line.startswith("| ")][2:]
    named = [match.groups() for row in rows if (match := NAMED.search(row))]
    assert len(named) == len(rows) > 25
    assert len(set(named)) == len(named)
    assert [f"{path}::{name}" for path, name in named if name not in _tests_in(path)] == []


def test_every_test_of_a_trap_is_in_the_table() -> None:
    """Each test of a trap is listed in the table."""
    assert _tests_in(OWN) <= {name for path, name in NAMED.findall(_section()) if path == OWN}
