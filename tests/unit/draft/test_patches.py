"""Planes in contact: their shared area and its outline, in closed form."""

from itertools import combinations
from math import pi
from random import Random

import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.parts import scene
from stepbot.geometry.fixed_point import exact_sum
from tests.assembled import Node, assembled, part
from tests.solids import box, cylinder


def areas(*nodes: Node) -> list[float]:
    """The shared areas of the first two parts [mm^2]."""
    return [patch.area * 1e6 for patch in Survey(assembled(*nodes), ALL_SOURCES).contacts.patches.get((1, 2), [])]


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_overlap_of_two_boxes(turn: float) -> None:
    """Two boxes, one on the other and half off it, share half a side, in any direction of space."""
    below, above = box(40, 30, 10).at(0, 0, -5), box(40, 30, 10).at(20, 0, 5)
    nodes = part("below", below, 1, 2, 3, (turn, turn, turn)), part("above", above, 1, 2, 3, (turn, turn, turn))
    assert areas(*nodes) == pytest.approx([600.0])


def test_disc_on_a_plate_with_a_hole() -> None:
    """A disc of r 20 over a hole of r 8 shares a ring; circles are polygons of 16 sides or more."""
    plate = box(60, 60, 10).at(0, 0, -5) - cylinder(8, 10).at(0, 0, -10)
    (area,) = areas(part("plate", plate), part("disc", cylinder(20, 5)))
    assert area == pytest.approx(pi * (20**2 - 8**2), rel=0.03)


@pytest.mark.parametrize("gap", [0.03, -0.03, 5.0])
def test_planes_apart_share_nothing(gap: float) -> None:
    """Faces 0.03 mm apart, or one in the other, are no contact."""
    assert areas(part("below", box(40, 30, 10), z=-5), part("above", box(40, 30, 10), z=5 + gap)) == []


def test_planes_that_look_the_same_way_share_nothing() -> None:
    """Two boxes side by side have coplanar upper faces, which touch nothing; their sides do."""
    assert areas(part("left", box(40, 30, 10), x=-20), part("right", box(40, 30, 10), x=20)) == pytest.approx([300.0])


@pytest.mark.parametrize("chunk", [1, 5, 1_000_000])
def test_all_overlaps_of_two_layers_of_bricks(chunk: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bricks below and above a plane share the overlaps of their rectangles, and no other pair shares any."""
    monkeypatch.setattr(scene, "_CHUNK", chunk)
    random = Random(3)
    sizes = [(random.randint(6, 40), random.randint(6, 40)) for _ in range(14)]
    places = [(random.randint(-50, 50) + 0.1 * n, random.randint(-50, 50) + 0.1 * n) for n in range(14)]
    layers = [n % 2 for n in range(14)]
    nodes = [
        part(f"brick{n}", box(*size, 10), *place, 10 * layer)
        for n, (size, place, layer) in enumerate(zip(sizes, places, layers, strict=True))
    ]
    found = {
        pair: exact_sum(patch.area for patch in shared) * 1e6
        for pair, shared in Survey(assembled(*nodes), ALL_SOURCES).contacts.patches.items()
    }
    expected = {}
    for a, b in combinations(range(14), 2):
        sides = [min(places[a][k] + sizes[a][k] / 2, places[b][k] + sizes[b][k] / 2) for k in range(2)]
        sides = [sides[k] - max(places[a][k] - sizes[a][k] / 2, places[b][k] - sizes[b][k] / 2) for k in range(2)]
        if layers[a] != layers[b] and min(sides) > 0.0 and sides[0] * sides[1] > 0.5:
            expected[a + 1, b + 1] = pytest.approx(sides[0] * sides[1])
    assert len(expected) > 5
    assert found == expected
