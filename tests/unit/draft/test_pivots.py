"""Joints at lone round contacts between two lopsided groups of parts."""

import numpy as np
import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.pivots import find_pivots, held_by_faces
from tests.assembled import BARE, Node, assembled, cut, group, inferred, joints, links, part
from tests.solids import Solid, box, cylinder

SEAL = cylinder(20, 3)
"""On z = 0."""


def shell(towards: float) -> Solid:
    """An arm of 40 mm by 40 mm that reaches along x, its middle at z = 0, with the axis of the seal in one end."""
    return box(200, 40, 40).at(80 * towards, 0, 0)


def stacked(upper: Solid, *more: Node) -> list[Node]:
    """An arm below the seal, something above it, and more."""
    return [part("lower", shell(1), z=-20), part("seal", SEAL), part("upper", upper, z=23), *more]


def test_two_arms_that_meet_at_a_seal_turn_on_each_other() -> None:
    """Two arms with a disc between them have a joint about its axis, marked for review."""
    found = inferred(*stacked(shell(-1)), sources=BARE)
    assert joints(found) == [("revolute", "lower", "upper")]
    (arc,) = found.arcs
    assert np.allclose(np.abs(arc.evidence.axis.d), (0, 0, 1))
    assert np.allclose(arc.evidence.axis.point[:2], 0, atol=1e-9)
    assert arc.evidence.review == "nothing but one round contact holds its two sides together"


def test_a_symmetric_lid_is_no_link() -> None:
    """What is symmetric about the axis of its round contact could turn without any effect: it is a lid or a foot."""
    assert joints(inferred(*stacked(cylinder(30, 60).at(0, 0, -20)), sources=BARE)) == []


def test_a_plate_beside_the_seal_holds_both_sides() -> None:
    """Arms that a third part touches, off the axis, do not turn."""
    plate = part("plate", box(40, 10, 83), y=25, z=1.5)
    assert joints(inferred(*stacked(shell(-1), plate), sources=BARE)) == []


def test_a_screw_beside_the_axis_holds_both_sides() -> None:
    """Arms that one screw fits in, off the axis, do not turn."""
    hole = cylinder(2, 40).at(17, 17, -20)
    screw = cylinder(1.98, 83).at(17, 17, -40) + cylinder(4, 4).at(17, 17, 43)
    arms = [part("lower", shell(1) - hole, z=-20), part("seal", SEAL), part("upper", shell(-1) - hole, z=23)]
    assert len(joints(inferred(*arms))) == 1
    assert joints(inferred(*arms, part("M4x80 screw", screw))) == []


def test_parts_of_one_subassembly_do_not_turn() -> None:
    """The tree holds two arms together."""
    other = part("other", box(10, 10, 10), x=500)
    assert joints(inferred(group("arm", *stacked(shell(-1))), other)) == []


COLUMN = cylinder(24, 76).at(160, 0, -120) + cylinder(18, 4).at(160, 0, -44)
"""Below the far end of the lower arm, with the whole assembly on it, and wider below."""


def test_a_round_stand_below_an_arm_turns() -> None:
    """A column that is symmetric about its round contact, with everything else on it, has a joint marked for review."""
    found = inferred(*stacked(shell(-1)), part("column", COLUMN), sources=BARE)
    assert joints(found) == [("revolute", "column", "lower"), ("revolute", "lower", "upper")]
    column = links(found).index({"column"})
    (arc,) = (arc for arc in found.arcs if column in (arc.parent, arc.child))
    assert np.allclose(np.abs(arc.evidence.axis.d), (0, 0, 1))
    assert np.allclose(arc.evidence.axis.point[:2], (0.16, 0), atol=1e-9)
    assert "it may turn at another one of them, or not at all" in arc.evidence.review


def test_what_lies_between_stand_and_arm_goes_with_the_larger_contact() -> None:
    """A plate below the column stays with it, since their contact is larger than that of column and arm."""
    plate = part("plate", cylinder(60, 10).at(160, 0, -130))
    found = inferred(*stacked(shell(-1)), plate, part("column", COLUMN), sources=BARE)
    assert {"column", "plate"} in links(found)


def test_a_foot_below_a_body_without_other_joints_is_no_link() -> None:
    """Nothing shows that a body on a round foot is a mechanism."""
    assert joints(inferred(part("lower", shell(1), z=-20), part("foot", COLUMN), sources=BARE)) == []


def test_a_cap_as_wide_as_its_contact_is_no_stand() -> None:
    """A round body that is no wider at the end of the assembly than where it touches the arm is a cap."""
    cap = part("cap", cylinder(24, 80).at(160, 0, -120))
    assert joints(inferred(*stacked(shell(-1)), cap, sources=BARE)) == [("revolute", "lower", "upper")]


def test_one_of_two_feet_is_no_stand() -> None:
    """An arm that stands on two round feet does not turn on either of them."""
    feet = [part("column", COLUMN), part("other", COLUMN, x=-60)]
    assert joints(inferred(*stacked(shell(-1)), *feet, sources=BARE)) == [("revolute", "lower", "upper")]


def test_a_screw_on_the_axis_holds_a_stand() -> None:
    """A stand that one screw clamps does not turn."""
    hole = cylinder(2, 40).at(160, 0, -20)
    arm, column = part("lower", shell(1) - hole, z=-20), part("column", COLUMN - cylinder(2, 80).at(160, 0, -120))
    screw = part("M4x20 screw", cylinder(1.98, 130).at(160, 0, -125) + cylinder(4, 4).at(160, 0, 5))
    _, *rest = stacked(shell(-1))
    assert len(joints(inferred(arm, column, *rest))) == 2
    assert len(joints(inferred(arm, column, screw, *rest))) == 1


def forearm(width: float) -> Solid:
    """A tube along z from 0 to 120 mm, with a flat or a square end of 80 mm above it."""
    return cylinder(20, 120) + box(width, 40, 80).at(0, 0, 160)


@pytest.mark.parametrize(("width", "turns"), [(14.0, True), (40.0, False)])
def test_a_fork_at_the_end_of_a_tube_is_lopsided(width: float, turns: bool) -> None:
    """A tube with a flat end turns on an arm that it meets at a round face; one with a square end may be a post."""
    nodes = [part("lower", shell(1), z=-20), part("upper", forearm(width))]
    assert joints(inferred(*nodes, sources=BARE)) == ([("revolute", "lower", "upper")] if turns else [])


def test_a_stand_on_a_spigot_turns() -> None:
    """A round stand is marked as turning, too, where a short spigot in the arm centres it; in half a bore it is not."""
    stand = part("column", COLUMN + cylinder(14, 5).at(160, 0, -40))
    _, *rest = stacked(shell(-1))
    bored = shell(1) - cylinder(14, 5).at(160, 0, -20)
    found = inferred(part("lower", bored, z=-20), stand, *rest, sources=BARE)
    assert joints(found) == [("revolute", "column", "lower"), ("revolute", "lower", "upper")]
    half = cut(bored, box(100, 60, 6).at(210, 0, -17))
    assert joints(inferred(part("lower", half, z=-20), stand, *rest, sources=BARE)) == [("revolute", "lower", "upper")]


def test_a_seal_between_two_faces_only_holds_them() -> None:
    """Two bars with a disc between them, on no pin, have a line that they are held on, not one that they turn on."""
    bars = part("one", box(60, 20, 5), z=-2.5), part("two", box(60, 20, 5), z=3.5)
    survey = Survey(assembled(*bars, part("disc", cylinder(8, 1))), ALL_SOURCES)
    (pivot,) = held_by_faces(survey)
    assert (pivot.hosts, pivot.turns) == ((1, 2), False)
    assert abs(pivot.axis.d[2]) == pytest.approx(1.0)


@pytest.mark.parametrize("has_pin", [False, True])
def test_rings_with_nothing_in_them_are_gaskets(has_pin: bool) -> None:
    """Bores with a ring between them are a pivot only with a pin in it."""
    flange, ring = box(80, 80, 10).at(0, 0, 5) - cylinder(15, 10), cylinder(18, 2) - cylinder(15.5, 2)
    nodes = [part("lower", flange), part("ring", ring, z=10), part("upper", flange, z=12)]
    nodes += [part("pin", cylinder(15, 22))] if has_pin else []
    assert len(find_pivots(Survey(assembled(*nodes), ALL_SOURCES))) == has_pin
