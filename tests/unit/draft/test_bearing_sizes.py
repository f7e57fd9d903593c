"""Bearings by their dimensions, where no name says what they are."""

import pytest

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
