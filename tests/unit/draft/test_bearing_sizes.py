"""Bearings by their dimensions, where no name says what they are."""

import pytest

from stepbot.draft.contacts.roles import _DIMENSIONS
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.parts.names import Role
from tests.assembled import BARE, assembled, group, inferred, joints, links, part
from tests.solids import Solid, box, cylinder


def ring(bore: float, outside: float, width: float) -> Solid:
    """A plain ring, by its diameters and its width [mm]."""
    return cylinder(outside / 2, width) - cylinder(bore / 2, width)


@pytest.mark.parametrize(
    ("bore", "outside", "width", "role"),
    [
        (8, 22, 7, Role.BEARING),  # 608
        (6, 12, 4, Role.BEARING),  # MR126
        (25, 47, 12, Role.BEARING),  # 6005
        (8.4, 16, 1.6, None),  # a washer of ISO 7089
        (8, 22, 8, None),  # a spacer
        (8.05, 22, 7, None),
    ],
)
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_ring_of_a_catalogue_is_a_bearing(
    bore: float, outside: float, width: float, role: Role | None, tilt: float
) -> None:
    """A ring of 608, MR126 or 6005 is a bearing in any direction; washers and spacers are not."""
    survey = Survey(assembled(part("ring", ring(bore, outside, width), 5, 6, 7, (tilt, 2 * tilt, 0))), BARE)
    assert survey.parts[1].role == role


BORES = (10, 12, 15, 17, 20, 25, 30, 35, 40, 45, 50)
SERIES = {
    "60": ((26, 28, 32, 35, 42, 47, 55, 62, 68, 75, 80), (8, 8, 9, 10, 12, 12, 13, 14, 15, 16, 16)),
    "62": ((30, 32, 35, 40, 47, 52, 62, 72, 80, 85, 90), (9, 10, 11, 12, 14, 15, 16, 17, 18, 19, 20)),
    "63": ((35, 37, 42, 47, 52, 62, 72, 80, 90, 100, 110), (11, 12, 13, 14, 15, 17, 19, 21, 23, 25, 27)),
    "618": ((19, 21, 24, 26, 32, 37, 42, 47, 52, 58, 65), (5, 5, 5, 5, 7, 7, 7, 7, 7, 7, 7)),
    "619": ((22, 24, 28, 30, 37, 42, 47, 55, 62, 68, 72), (6, 6, 7, 7, 9, 9, 9, 10, 12, 12, 12)),
}
"""Outside diameters and widths [mm] of the dimension series of ISO 15, bore numbers 00 to 10."""
MINIATURE = """
682 2 5 1.5, 692 2 6 2.3, 602 2 7 2.8, 683 3 7 2, 693 3 8 3, 603 3 9 3, 623 3 10 4, 684 4 9 2.5, 694 4 11 4, 604 4 12 4,
624 4 13 5, 634 4 16 5, 685 5 11 3, 695 5 13 4, 605 5 14 5, 625 5 16 5, 635 5 19 6, 686 6 13 3.5, 696 6 15 5,
606 6 17 6, 626 6 19 6, 687 7 14 3.5, 697 7 17 5, 607 7 19 6, 627 7 22 7, 688 8 16 4, 698 8 19 6, 608 8 22 7,
628 8 24 8, 689 9 17 4, 699 9 20 6, 609 9 24 7, 629 9 26 8, 683ZZ 3 7 3, 684ZZ 4 9 4, 685ZZ 5 11 5, 686ZZ 6 13 5,
687ZZ 7 14 5, 688ZZ 8 16 5, MR63 3 6 2, MR74 4 7 2, MR84 4 8 2, MR85 5 8 2, MR95 5 9 2.5, MR105 5 10 3, MR106 6 10 2.5,
MR126 6 12 3, MR117 7 11 2.5, MR137 7 13 3, MR128 8 12 2.5, MR148 8 14 3.5
"""
"""Designation, bore, outside diameter and width [mm] in makers' catalogues; ZZ is shielded."""


def test_standard_bearings_are_known() -> None:
    """All bearings of five series from 10 to 50 mm, and the miniature ones, are in the table."""
    standard = {
        f"{series}{number:02}": (bore, outside[number], width[number])
        for series, (outside, width) in SERIES.items()
        for number, bore in enumerate(BORES)
    }
    for designation, *dimensions in map(str.split, MINIATURE.split(",")):
        standard[designation] = tuple(map(float, dimensions))
    assert {name: rings for name, rings in standard.items() if rings not in _DIMENSIONS} == {}


def test_joint_at_an_unnamed_bearing_is_marked() -> None:
    """An arm with a ring of 608 in its bore turns about the axle in the ring; the joint is to be reviewed."""
    arm = box(200, 40, 7).at(80, 0, 3.5) - cylinder(11, 7)
    axle = part("axle", cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35))
    found = inferred(axle, part("arm", arm), part("ring", ring(8, 22, 7)), sources=BARE)
    assert joints(found) == [("revolute", "arm", "axle")]
    assert found.arcs[0].evidence.review == "not named as a bearing"
    assert links(found) == [{"axle"}, {"arm", "ring"}]


def test_spacer_is_no_bearing() -> None:
    """The same arm with a spacer of other dimensions gets no joint at it."""
    arm = box(200, 40, 8).at(80, 0, 4) - cylinder(11, 8)
    axle = part("axle", cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35))
    found = inferred(axle, part("arm", arm), part("ring", ring(8, 22, 8)), sources=BARE)
    assert not [arc for arc in found.arcs if "dimensions" in arc.evidence.why]


def test_named_bearing_needs_no_review() -> None:
    """The same ring named as a bearing, between two subassemblies, gives a joint without a mark."""
    arm = box(200, 40, 7).at(80, 0, 3.5) - cylinder(11, 7)
    axle = cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35)
    found = inferred(
        group("base", part("axle", axle)), group("swing", part("arm", arm), part("608-ZZ", ring(8, 22, 7)))
    )
    assert joints(found) == [("revolute", "base/axle", "swing/arm")]
    assert found.arcs[0].evidence.review == ""


@pytest.mark.parametrize(("length", "kind"), [(24, "prismatic"), (23, None)])
def test_ring_of_a_linear_bearing_slides(length: float, kind: str | None) -> None:
    """A block with a ring of LM8UU in its bore slides on its rod, to be reviewed; one with a spacer does not."""
    block = box(40, 40, length).at(0, 0, length / 2) - cylinder(7.5, length)
    rod = part("rod", cylinder(4, 200).at(0, 0, -100) + box(80, 80, 10).at(0, 0, -105))
    found = inferred(rod, part("block", block), part("ring", ring(8, 15, length)), sources=BARE)
    slides = [arc.evidence for arc in found.arcs if arc.evidence.type.value == "prismatic"]
    assert [h.type.value for h in slides] == ([kind] if kind else [])
    assert all(h.review for h in slides)
