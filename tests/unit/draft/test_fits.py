"""Coaxial cylinders of two parts: shaft in bore, holes end to end, and what is no fit."""

import pytest

from stepbot.draft.contacts.contacts import Fit, FitKind, LineFace
from stepbot.draft.contacts.shafts import _joined
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from tests.assembled import Node, assembled, part
from tests.solids import Solid, box, cylinder


def plate(radius: float) -> Solid:
    """A plate of 10 mm with a hole, its lower side at z = 0."""
    return box(60, 60, 10).at(0, 0, 5) - cylinder(radius, 10)


def fits(one: Node, two: Node) -> list[Fit]:
    """The fits of two parts."""
    return Survey(assembled(one, two), ALL_SOURCES).contacts.fits.get((1, 2), [])


@pytest.mark.parametrize(("shaft", "engaged"), [(8.0, 10e-3), (7.6, 10e-3), (7.4, 0.0), (8.1, 10e-3), (8.2, 0.0)])
def test_shaft_in_a_bore(shaft: float, engaged: float) -> None:
    """A shaft 0.4 mm thinner than a bore of r 8 mm, or 0.1 mm thicker, is in it along the whole plate."""
    found = fits(part("plate", plate(8)), part("shaft", cylinder(shaft, 40), z=-15))
    assert [(fit.kind, fit.shaft) for fit in found] == [(FitKind.SHAFT, 2)] * bool(engaged)
    assert [fit.length for fit in found] == pytest.approx([engaged] * bool(engaged))


@pytest.mark.parametrize(("gap", "count"), [(0.0, 1), (1.0, 1), (2.0, 0)])
def test_holes_end_to_end(gap: float, count: int) -> None:
    """Two holes on one line up to 1.5 mm apart may have one screw."""
    found = fits(part("lower", plate(4)), part("upper", plate(3), z=10 + gap))
    assert [fit.kind for fit in found] == [FitKind.HOLES] * count


@pytest.mark.parametrize(("x", "angle"), [(0.05, 0.0), (0.0, 0.01)])
def test_shaft_beside_or_aslant_fits_nothing(x: float, angle: float) -> None:
    """A shaft 0.05 mm or 0.01 rad off the line of the bore is not in it."""
    shaft = part("shaft", cylinder(7.9, 40).at(0, 0, -20), x, 0, 5, (angle, 0, 0))
    assert fits(part("plate", plate(8)), shaft) == []


def test_two_halves_of_a_bore_are_one() -> None:
    """A bore that two parts share, half each, is no full one."""
    half = box(60, 30, 10).at(0, 15, 5).shape
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    jaw = BRepAlgoAPI_Cut(half, cylinder(8, 10).shape).Shape()
    found = fits(part("jaw", jaw), part("shaft", cylinder(8, 40), z=-15))
    assert [(fit.kind, fit.full) for fit in found] == [(FitKind.SHAFT, False)]


@pytest.mark.parametrize("shift", [0.0, 5e-8, -5e-8])
def test_pieces_of_a_shaft_are_one(shift: float) -> None:
    """Faces end to end are one although a STEP file rounds their radii and ends; faces 1 um apart in radius are two."""
    pieces = [
        LineFace(4e-3, 0.0, 0.01, True, 3.0, False),
        LineFace(4e-3 + shift, 0.01 + abs(shift), 0.02, True, 3.0, False),
    ]
    (joined,) = _joined(pieces)
    assert (joined.low, joined.high) == (0.0, 0.02)
    assert len(_joined([pieces[0], LineFace(4.001e-3, 0.0, 0.01, True, 3.0, False)])) == 2
