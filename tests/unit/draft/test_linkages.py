"""Linkages: bodies on one pin, one screw or one pair of holes."""

import pytest

from tests.assembled import Node, inferred, joints, part
from tests.solids import Solid, box, cylinder


def bar(x: float, y: float, u: float, v: float, level: float, bore: float = 3.0) -> Solid:
    """A plate of 5 mm from (x, y) to (u, v) with a bore at either end, at a height."""
    low, high = (min(x, u) - 8, min(y, v) - 8), (max(x, u) + 8, max(y, v) + 8)
    size = high[0] - low[0], high[1] - low[1]
    plate = box(*size, 5).at(low[0] + size[0] / 2, low[1] + size[1] / 2, level)
    return plate - cylinder(bore, 30).at(x, y, level - 15) - cylinder(bore, 30).at(u, v, level - 15)


def four_bar(second: float = 3.0) -> list[Node]:
    """A crank, a coupler and a rocker on a ground plate, each pair with one pair of bare holes."""
    points = (0, 0), (0, 60), (130, 80), (120, 0)
    ends = list(zip(points, (*points[1:], points[0]), strict=True))
    names = "crank", "coupler", "rocker", "ground"
    levels = 5.0, 10.0, 5.0, 0.0
    return [
        part(name, bar(*a, *b, level, second if name == "coupler" else 3.0))
        for name, (a, b), level in zip(names, ends, levels, strict=True)
    ]


def test_bare_holes_of_a_four_bar_are_four_marked_joints() -> None:
    """Three joints of the tree and one that closes the loop, each marked for review."""
    found = inferred(*four_bar())
    assert sorted(joints(found)) == [
        ("revolute", "coupler", "crank"),
        ("revolute", "coupler", "rocker"),
        ("revolute", "crank", "ground"),
        ("revolute", "ground", "rocker"),
    ]
    assert all(arc.evidence.review for arc in found.arcs)
    assert sum(arc.is_closure for arc in found.arcs) == 1


def test_a_truss_of_three_bars_does_not_move() -> None:
    """Bars that close a triangle have no mobility: none of their holes is a joint."""
    points = (0, 0), (100, 0), (50, 90)
    ends = zip(points, (*points[1:], points[0]), strict=True)
    levels = 0.0, 5.0, 10.0
    bars = [part(f"bar {n}", bar(*a, *b, levels[n])) for n, (a, b) in enumerate(ends)]
    pin = part("pin", cylinder(3, 20).at(0, 0, -4))
    assert joints(inferred(*bars, pin)) == []


@pytest.mark.parametrize("screws", [1, 2])
def test_two_screws_hold_what_one_lets_turn(screws: int) -> None:
    """A bracket on one screw is offered as a joint, and one on two is fixed."""
    at = [(0.0, 0.0), (20.0, 0.0)][:screws]
    base, bracket = box(200, 60, 10).at(0, 0, -5), box(30, 150, 8).at(10, 60, 4)
    parts = []
    for n, (x, y) in enumerate(at):
        hole = cylinder(2, 60).at(x, y, -30)
        base, bracket = base - hole, bracket - hole
        parts.append(part(f"M4x16 screw {n}", cylinder(2, 16).at(x, y, -8) + cylinder(4, 4).at(x, y, 8)))
    found = inferred(part("base", base), part("bracket", bracket), *parts)
    assert joints(found) == ([("revolute", "base", "bracket")] if screws == 1 else [])
    assert all(arc.evidence.review for arc in found.arcs)
