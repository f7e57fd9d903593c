"""Bearings by their dimensions, where no name says what they are."""

import pytest

from stepbot.draft.contacts.roles import _DIMENSIONS, _LINEAR
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
MR126 6 12 3, MR117 7 11 2.5, MR137 7 13 3, MR128 8 12 2.5, MR148 8 14 3.5, MR52ZZ 2 5 2.5, 692ZZ 2 6 3, 602ZZ 2 7 3.5,
MR63ZZ 3 6 2.5, MR83 3 8 2.5, 693ZZ 3 8 4, 603ZZ 3 9 5, MR74ZZ 4 7 2.5, MR84ZZ 4 8 3, MR104 4 10 3, MR104ZZ 4 10 4,
MR85ZZ 5 8 2.5, MR95ZZ 5 9 3, MR105ZZ 5 10 4, MR115 5 11 4, MR106ZZ 6 10 3, MR126ZZ 6 12 4, MR117ZZ 7 11 3,
MR137ZZ 7 13 4, MR128ZZ 8 12 3.5, MR148ZZ 8 14 4, 688W6 8 16 6,
682ZZ 2 5 2.3, 689ZZ 9 17 5
"""
"""Designation, bore, outside diameter and width [mm] in makers' catalogues; ZZ is shielded."""
THIN = """
6700 10 15 3, 6700ZZ 10 15 4, 61800W6 10 19 6, 63800 10 19 7, 6701 12 18 4, 63801 12 21 7, 6702 15 21 4, 63802 15 24 7,
6703 17 23 4, 63803 17 26 7, 6704 20 27 4, 6705 25 32 4, 6706 30 37 4, 6707 35 44 5, 6708 40 50 6, 6709 45 55 6,
6710 50 62 6, 61811 55 72 9, 61911 55 80 13, 6011 55 90 18, 61812 60 78 10, 61912 60 85 13, 6012 60 95 18,
61813 65 85 10, 61913 65 90 13, 6013 65 100 18, 61814 70 90 10, 61914 70 100 16, 6014 70 110 20, 61815 75 95 10,
61915 75 105 16, 61816 80 100 10, 61916 80 110 16, 61817 85 110 13, 61917 85 120 18, 61818 90 115 13, 61918 90 125 18,
61819 95 120 13, 61919 95 130 18, 61820 100 125 13, 61920 100 140 20
"""
"""Thin and large ones, likewise."""
LINEAR = """
LM3 3 7 10, LM4 4 8 12, LM5 5 10 15, LM6 6 12 19, LM6L 6 12 35, LM8S 8 15 17, LM8 8 15 24, LM8L 8 15 45, LME8 8 16 25,
LM10 10 19 29, LM10L 10 19 55, LM12 12 21 30, LM12L 12 21 57, LME12 12 22 32, LM13 13 23 32, LM13L 13 23 61,
LME16 16 26 36, LM16 16 28 37, LM16L 16 28 70, LM20 20 32 42, LME20 20 32 45, LM20L 20 32 80, LME25 25 40 58,
LM25 25 40 59, LM25L 25 40 112, LM30 30 45 64, LM30L 30 45 123
"""
"""Linear bearings: designation, bore, outside diameter and length [mm]."""


def catalogue(text: str) -> dict[str, tuple[float, ...]]:
    """The dimensions of each designation."""
    return {name: tuple(map(float, numbers)) for name, *numbers in map(str.split, text.split(","))}


def test_standard_bearings_are_known() -> None:
    """The tables have the bearings of five series from 10 to 50 mm, miniature, thin and linear ones, and no others."""
    standard: dict[str, tuple[float, ...]] = {
        f"{series}{number:02}": (bore, outside[number], width[number])
        for series, (outside, width) in SERIES.items()
        for number, bore in enumerate(BORES)
    }
    standard |= catalogue(MINIATURE) | catalogue(THIN)
    assert set(standard.values()) == _DIMENSIONS
    assert set(catalogue(LINEAR).values()) == _LINEAR


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
