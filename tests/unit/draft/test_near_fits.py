"""Faces that are only nearly coaxial: parts placed by hand beside a motor."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.contacts import near_fits, settling
from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.near_fits import ANGLE, OFFSET, NearFit, _between
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.draft_robot import infer
from stepbot.geometry.spatial import Pose
from tests.assembled import Node, assembled, inferred, joints, part
from tests.solids import box, cylinder

SERVO = box(40, 20, 30).at(0, 0, -15) + cylinder(3, 5).at(10, 0, 0)
"""A case below z = 0 [mm] with its output at (10, 0), and two holes in its bottom."""
for x in (-16, 16):
    SERVO -= cylinder(1.5, 8).at(x, 0, -30)
BASE = box(60, 30, 6) - cylinder(1.6, 6).at(-16, 0, -3) - cylinder(1.6, 6).at(16, 0, -3)
ARM = box(100, 12, 4).at(40, 0, 0) - cylinder(3.1, 4).at(0, 0, -2)


def placed_by_hand(off: float, tilt: float = 0.0) -> list[Node]:
    """A servo above its base and an arm on its output, both off by so much [mm], the arm tilted [rad]; none touches."""
    return [
        part("base", BASE, off, 0, -33.2),
        part("SG90 servo", SERVO),
        part("arm", ARM, 10 + off, 0, 2.4, rpy=(tilt, 0, 0)),
    ]


@pytest.mark.parametrize("tilt", [0.0, 0.017])
def test_what_is_placed_by_hand_on_a_servo_turns_on_it(tilt: float) -> None:
    """An arm 0.3 mm off a servo's output is its joint, on the servo's own axis, marked; the base carries the servo."""
    found = inferred(*placed_by_hand(0.3, tilt))
    assert joints(found) == [("revolute", "SG90 servo", "arm")]
    (arc,) = found.arcs
    assert arc.evidence.review
    assert arc.evidence.axis.distance(np.array([0.01, 0.0, 0.0])) < 1e-9
    assert {found.survey.parts[i].path for i in found.links[found.root]} == {"base", "SG90 servo"}


def test_what_is_farther_off_is_no_joint() -> None:
    """From 0.6 mm on, nothing says that the arm belongs to the servo."""
    assert joints(inferred(*placed_by_hand(0.7))) == []


@pytest.mark.parametrize(("off", "tilt", "count"), [(0.0, 0.0, 0), (0.5, 0.0, 1), (0.7, 0.0, 0), (0.0, 0.019, 1)])
def test_near_fits_are_within_limits_and_not_exact(off: float, tilt: float, count: int) -> None:
    """A fit is near up to 0.6 mm and 1.2 degrees; an exact one is a contact and no near fit."""
    found = Survey(assembled(*placed_by_hand(off, tilt)[1:]), ALL_SOURCES).near_fits
    assert [len(fits) for fits in found.values()] == [count] * bool(count)
    assert all(fit.offset < OFFSET and fit.angle < ANGLE for fits in found.values() for fit in fits)


@pytest.mark.parametrize("copies", [2, 9])
def test_equal_groups_are_compared_once(copies: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """What does not fit in one group is not compared in its copies, turned or moved; what fits is found in each."""
    compared: list[bool] = []

    def between(*given: Any) -> list[NearFit]:
        found = _between(*given)
        compared.append(not found)
        return found

    monkeypatch.setattr(near_fits, "_between", between)
    parts = [*placed_by_hand(0.3), part("pin", cylinder(1, 4), 0, 11, -15)]
    groups = [
        Node(f"copy {n}", children=parts, X=Pose.from_xyz_rpy((0.3 * n, 0.1, 0.0), (0.1 * n, 0.0, 0.7 * n)))
        for n in range(copies)
    ]
    found = Survey(assembled(*groups), ALL_SOURCES).near_fits
    alone = Survey(assembled(*parts), ALL_SOURCES).near_fits
    assert len(found) == copies * len(alone) == copies * 2
    assert sum(compared) == 2, "the pin and the servo, in the copies and alone"


PLATE = box(80, 40, 4)
for x in (-30, 30):
    PLATE -= cylinder(2, 4).at(x, 12, -2)
PILLAR = box(10, 30, 40).at(0, 0, 22)
LEVER = box(60, 12, 5).at(25, 0, 0) - cylinder(4, 5).at(0, 0, -2.5)
STAND = box(40, 40, 10) + cylinder(3.95, 12).at(0, 0, 5)


def by_hand(off: tuple[float, float, float], turn: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[Node]:
    """A lever on the pin of a stand, and a plate with a pillar that two holes of the stand hold, all off [mm, rad]."""
    stand = STAND - cylinder(2, 10).at(-30, 12, -5) + box(90, 8, 10).at(0, 12, 0)
    for x in (-30, 30):
        stand -= cylinder(2, 10).at(x, 12, -5)
    x, y, z = off
    return [
        part("stand", stand),
        part("lever", LEVER, x, y, 9.5 + z, turn),
        part("plate", PLATE, -x, y, -7.2 - z, (turn[1], -turn[0], turn[2])),
    ]


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.004, -0.006, 0.002)])
def test_pieces_that_touch_nothing_are_moved_to_what_they_fit(turn: tuple[float, float, float]) -> None:
    """A pin and two holes that are up to 0.3 mm and 0.4 degrees off are exact fits then, and no others are made."""
    drawn = Survey(assembled(*by_hand((0.2, -0.1, 0.0), turn)), ALL_SOURCES)
    assert drawn.contacts.pairs() == []
    found = Survey.settled(drawn.assembly, ALL_SOURCES)
    assert sorted(found.moved) == [2, 3]
    assert {pair: len(fits) for pair, fits in found.contacts.fits.items()} == {(1, 2): 1, (1, 3): 2}
    assert found.drawn_off([1, 2], np.array([0.0, 0.0, 0.01])) == pytest.approx(2.2e-4, abs=1e-4)


def test_joints_of_moved_pieces_are_where_they_are_drawn() -> None:
    """The axis is that of the stand, which stays; the joint is marked, and the draft names what was moved."""
    draft = infer(assembled(*by_hand((0.2, -0.1, 0.0))), "robot")
    (joint,) = draft.joints
    assert (joint.type, joint.child) == ("revolute", "lever")
    assert np.hypot(*np.array(joint.point)[:2]) < 1e-9
    assert "its sides are drawn 0.22 mm off each other" in joint.review
    assert "drawn up to 0.3 mm off what they fit, and compared as if in place: 'lever', 'plate'" in draft.notes


def test_what_a_horn_carries_may_be_drawn_off_the_axis() -> None:
    """A horn is exactly on its servo, and the arm 0.2 mm beside and above the horn: the joint is marked."""
    horn, arm = cylinder(8, 3), box(100, 20, 4).at(40, 0, 0)
    for x, y in ((5, 0), (-5, 0), (0, 5), (0, -5)):
        horn, arm = horn - cylinder(1, 3).at(x, y, 0), arm - cylinder(1, 4).at(x, y, -2)
    base = box(60, 30, 6).at(0, 0, -33)
    nodes = [part("base", base), part("SG90 servo", SERVO), part("servo horn", horn, 10, 0, 5)]
    for off, is_marked in ((0.0, False), (0.2, True)):
        draft = infer(assembled(*nodes, part("arm", arm, 10 + off, 0, 10.2)), "robot")
        (joint,) = draft.joints
        assert (joint.type, joint.child) == ("revolute", "arm")
        assert ("its sides are drawn 0.28 mm off each other" in joint.review) == is_marked


PEG, SOCKET = box(30, 30, 10) + cylinder(3.9, 8).at(0, 0, 5), box(30, 30, 10) - cylinder(4, 10).at(0, 0, -5)


@pytest.mark.parametrize("tilt", [0.0, 2e-3])
def test_planes_beside_faces_that_are_off_meet_again(tilt: float) -> None:
    """A block on a peg, 0.1 mm beside it and 0.1 mm above its shoulder, stands on it then, and turns about the peg."""
    nodes = [part("peg", PEG), part("block", SOCKET, 0.1, 0, 10.1, (0, tilt, 0))]
    drawn = Survey(assembled(*nodes), ALL_SOURCES)
    assert drawn.relations == {}
    relation = Survey.settled(drawn.assembly, ALL_SOURCES).relations[1, 2]
    assert relation.freedom.kind == FreedomKind.REVOLUTE
    assert relation.area == pytest.approx(9e-4 - np.pi * 0.004**2, rel=2e-3)


def test_a_gap_that_is_wider_than_faces_are_off_is_drawn() -> None:
    """Beside a peg that is 0.05 mm off, a gap of 0.2 mm stays; nothing moves along the peg."""
    found = Survey.settled(assembled(part("peg", PEG), part("block", SOCKET, 0.05, 0, 10.2)), ALL_SOURCES)
    assert not found.relations[1, 2].patches
    (X,) = found.moved.values()
    assert abs(X.p[2]) < 1e-9


@pytest.mark.parametrize(("tilt", "area"), [(0.0, 0.0), (1e-3, 4e-4)])
def test_planes_that_are_drawn_tilted_meet_where_nothing_is_round(tilt: float, area: float) -> None:
    """A box turned by 1 mrad and 0.05 mm above another one stands on it, as one that happens to touch it does."""
    lower, upper = part("lower", box(60, 30, 10)), part("upper", box(20, 20, 10), -15, 0, 10.05, (tilt, 0, 0))
    touching = part("touching", box(20, 20, 10), 15, 0, 10.005, (2e-4, 0, 0))
    relation = Survey.settled(assembled(lower, upper, touching), ALL_SOURCES).relation(1, 2)
    assert (0.0 if relation is None else relation.area) == pytest.approx(area, rel=1e-4)


def test_bodies_of_one_part_stay_in_place() -> None:
    """A part with a peg and a block 0.1 mm off it is one product: nothing can place them otherwise."""
    nodes = [part("peg", PEG), part("block", SOCKET, 0.1, 0, 10.1)]
    apart = [replace(node, name="") for node in nodes]
    assert Survey.settled(assembled(*nodes, part("far", box(9, 9, 9), 50, 0, 0)), ALL_SOURCES).moved
    one = Node("one part", children=apart)
    assert not Survey.settled(assembled(one, part("far", box(9, 9, 9), 50, 0, 0)), ALL_SOURCES).moved


def test_what_touches_stays_where_it_is() -> None:
    """A hole 0.3 mm beside another one may be meant so where the parts touch."""
    nodes = by_hand((0.3, 0.0, 0.0))
    nodes[2] = part("plate", PLATE, -0.3, 0.0, -7.0)
    found = Survey.settled(assembled(*nodes), ALL_SOURCES)
    assert sorted(found.moved) == [2]


def test_holes_that_contradict_each_other_move_nothing() -> None:
    """Two pairs of holes at distances that differ by 0.4 mm."""
    plate = box(80, 40, 4) - cylinder(2, 4).at(-30.2, 12, -2) - cylinder(2, 4).at(30.2, 12, -2)
    nodes = by_hand((0.0, 0.0, 0.0))
    nodes[2] = part("plate", plate, 0, 0, -7.2)
    assert Survey.settled(assembled(*nodes), ALL_SOURCES).moved == {}


def test_pieces_of_motors_stay_where_they_are() -> None:
    """A horn may be drawn turned in its servo; what a motor turns is decided by its own rules."""
    stand, lever, _ = by_hand((0.2, -0.1, 0.0))
    named = [replace(one, name=f"servo {one.name}") for one in (stand, lever)]
    assert Survey.settled(assembled(stand, lever), ALL_SOURCES).moved
    assert not Survey.settled(assembled(*named), ALL_SOURCES).moved


def test_a_bound_of_the_search_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies that are too many to be moved are compared as drawn, and the draft has a note."""
    monkeypatch.setattr(settling, "_MOST_BODIES", 2)
    draft = infer(assembled(*by_hand((0.2, -0.1, 0.0))), "robot")
    assert "more than 2 bodies were compared as drawn, though some are off what they fit" in draft.notes


@pytest.mark.parametrize("off", [0.1, 0.4])
def test_a_shaft_off_its_bore_may_turn_in_it(off: float) -> None:
    """A lever that stands on its base, with the pin of the base in its hole, drawn off its axis by hand."""
    base = box(200, 40, 5).at(0, 0, -2.5) + cylinder(5, 5)
    lever = box(80, 12, 5).at(0, 0, 2.5) - cylinder(5.05, 5)
    found = inferred(part("base", base), part("lever", lever, off))
    assert joints(found) == [("revolute", "base", "lever")]
    (hinge,) = [arc.evidence for arc in found.arcs]
    assert hinge.why == f"shaft of r 5 mm in a bore, {off} mm off its axis"
    assert hinge.review == "the two are drawn off each other, so that their common axis is a guess"
    far = inferred(part("base", base), part("lever", lever, 0.7))
    assert joints(far) == []
