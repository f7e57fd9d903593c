"""Planes in contact: their shared area and its outline, in closed form."""

from math import pi

import pytest

from stepbot.authoring.survey import ALL_SOURCES, Survey
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
