"""Sums are exact, rounded once, and equal on every Python."""

import ast
import re
from fractions import Fraction
from math import inf, isnan
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import MassProperties, combined

SOURCE = Path(__file__).resolve().parents[3] / "src"
COUNTS = re.compile(
    r"len\(|map\(len,|int\(|1\b|(one\.face_)?count$|any\(|bool\(|(map\()?self(\._lines)?\.has\b|_straighten_edge\(|_faces_drawn\(|sizes\["
    r"|.*(\.size| (==|!=|<=?|>=?|is not|in) .*|nthreads\(\)\.values\(\))$"
)
"""Arguments allowed for the built-in ``sum``: whole numbers."""


@given(st.lists(st.floats(-1e300, 1e300), max_size=30))
def test_sum_is_exact(values: list[float]) -> None:
    """The sum is that of the exact fractions, rounded to a double."""
    assert exact_sum(values) == float(sum(map(Fraction, values)))


def test_sum_of_what_is_not_finite() -> None:
    """Non-finite sums are infinite or NaN, as by adding."""
    assert exact_sum([1e308, 1e308]) == inf
    assert exact_sum([1.0, -inf]) == -inf
    assert isnan(exact_sum([inf, -inf]))
    assert exact_sum(iter(())) == 0.0


def test_masses_are_summed_exactly() -> None:
    """Ten bodies of 0.1 kg have 1 kg; added one by one they are 1.1e-16 kg short."""
    assert (
        combined([MassProperties.of(0.1, (0.0, 0.0, 0.0), [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]])] * 10).mass == 1.0
    )


def _summed() -> list[tuple[str, str]]:
    """Calls of ``sum`` without a start in the source, and their arguments."""
    found = []
    for file in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sum":
                (added, *start) = node.args
                element = added.elt if isinstance(added, ast.GeneratorExp | ast.ListComp) else added
                if not start:
                    found.append((f"{file.relative_to(SOURCE)}:{node.lineno}", ast.unparse(element)))
    return found


@pytest.mark.slow
def test_built_in_sum_only_counts() -> None:
    """Fractions are added by `exact_sum`: the built-in ``sum`` compensates for rounding only from Python 3.12 on."""
    summed = _summed()
    assert len(summed) > 10
    assert [place for place in summed if not COUNTS.match(place[1])] == []
