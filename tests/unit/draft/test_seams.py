"""Joints across a gap: what faces of revolution, cradles and centred faces show, and what they do not."""

from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.mechanism.gaps import _is_beside_motor
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.robot.model import JointKind
from tests.assembled import Node, cut, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder

QUARTER = pi / 2


def across_a_gap(gap: float) -> tuple[Node, Node]:
    """A drum on a column, each a subassembly, on one axis with a gap [mm] between their ends."""
    column = part("column", cylinder(20, 100))
    bracket = part("bracket", box(60, 60, 10), z=-5)
    drum = part("drum", cylinder(25, 40), z=100 + gap)
    arm = part("arm", box(20, 200, 10), y=90, z=145 + gap)
    return group("stand", bracket, column), group("turret", drum, arm)


def test_ends_on_one_axis_turn_across_a_gap() -> None:
    """A drum that stands 2 mm above a column turns on it, about their common axis, marked for review."""
    found = inferred(*across_a_gap(2.0))
    (arc,) = found.arcs
    assert joints(found) == [("revolute", "stand/column", "turret/drum")]
    assert abs(arc.evidence.axis.distance(found.survey.parts[2].com)) < 1e-9
    assert arc.evidence.review


@pytest.mark.parametrize(("beside", "turns"), [(32.0, True), (70.0, False)])
def test_ends_across_a_wide_gap_turn_if_the_bodies_are_in_one_another(beside: float, *, turns: bool) -> None:
    """A gap of 12 mm is no joint, unless a post of the stand reaches beside the drum, as a fork does."""
    _, turret = across_a_gap(12.0)
    foot, post = part("foot", box(130, 60, 10), x=25, z=-5), part("post", box(10, 10, 130), x=beside, z=65)
    found = inferred(group("stand", part("column", cylinder(20, 100)), foot, post), turret)
    assert joints(found) == ([("revolute", "stand/column", "turret/drum")] if turns else [])


def test_rods_of_a_frame_turn_on_nothing() -> None:
    """Two rods whose ends meet the holes of two blocks hold these together: nothing turns about a long bar's axis."""
    hole = cylinder(8.5, 30)
    block = box(120, 40, 30).at(0, 0, 15) - hole.at(-40, 0, 0) - hole.at(40, 0, 0)
    rods = [part(f"rod {n}", cylinder(8, 200), x=x) for n, x in enumerate((-40, 40))]
    found = inferred(part("foot", block, z=-30), part("head", block, z=200), *rods)
    assert found.arcs == []
    assert len(found.links) == 1


@pytest.mark.parametrize(("cans", "turning"), [(1, 1), (3, 0)])
def test_boards_with_equal_cans_turn_on_none_of_them(cans: int, turning: int) -> None:
    """Boards 17 mm apart, with equal cans above each other: three lines cannot all be an axis, a single one may be."""
    at = [(-30, -20), (0, 20), (30, -20)][:cans]
    boards = [
        group(
            f"board {n}", part("pcb", box(100, 70, 2), z=z), *(part("can", cylinder(6, 14), x, y, z + 1) for x, y in at)
        )
        for n, z in enumerate((0, 18))
    ]
    assert len(joints(inferred(*boards))) == turning


@pytest.mark.parametrize(
    ("pair", "others", "is_beside"),
    [
        ((2, 3), [], True),  # what is beside the output
        ((1, 3), [], True),  # beside the case alone
        ((1, 3), [(2, 3)], False),  # beside both: it is the output's
        ((1, 3), [(2, 4)], True),
        ((3, 4), [], False),
        ((3, 4), [(2, 3)], False),
    ],
)
@pytest.mark.parametrize("turned", [False, True])
def test_a_joint_across_a_gap_repeats_that_of_a_motor(
    pair: tuple[int, int], others: list[tuple[int, int]], *, is_beside: bool, turned: bool
) -> None:
    """On the axis of a motor with case 1 and output 2, where one side is on the motor; on another line never."""

    def seam(a: int, b: int, at: float = 0.0) -> JointEvidence:
        axis = Axis(np.array([at, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
        return JointEvidence(0.6, *((b, a) if turned else (a, b)), JointKind.REVOLUTE, axis, "")

    drive = replace(seam(1, 2), a=1, b=2, drives=True)
    decision: Any = SimpleNamespace(clusters=Clusters(range(1, 5)), joints=[replace(drive, drives=False), drive])
    across = [seam(*one) for one in (pair, *others)]
    assert _is_beside_motor(decision, across[0], across) is is_beside
    assert not _is_beside_motor(decision, seam(*pair, at=0.01), across)


def test_ends_far_apart_show_no_joint() -> None:
    """At a gap of 40 mm, wider than the drum is, nothing shows that it turns: the joint is a placeholder."""
    found = inferred(*across_a_gap(80.0))
    assert joints(found) == []


def test_round_end_turns_on_the_middle_of_a_rectangle() -> None:
    """A disc 1 mm below a rectangular plate, centred on it, turns about its own axis."""
    plate = part("plate", box(90, 80, 10), z=6)
    disc = part("disc", cylinder(30, 15), z=-15)
    found = inferred(group("fork", plate), group("arm", disc, part("shell", box(40, 40, 200), z=-115)))
    (arc,) = found.arcs
    assert arc.evidence.type == JointKind.REVOLUTE
    assert arc.evidence.axis.distance(found.survey.parts[2].com) < 1e-9


@pytest.mark.parametrize("offset", [0.1, 3.0])
def test_round_end_off_the_middle_shows_nothing(offset: float) -> None:
    """The same disc off the centre of the plate, if only by 0.1 mm, could be anywhere: no joint."""
    plate = part("plate", box(90, 80, 10), x=offset, z=6)
    disc = part("disc", cylinder(30, 15), z=-15)
    found = inferred(group("fork", plate), group("arm", disc, part("shell", box(40, 40, 200), z=-115)))
    assert joints(found) == []


def nodding(cradle_radius: float) -> tuple[Node, Node]:
    """A head with an open cradle of a radius [mm] above a drive of 30 mm across the neck."""
    drive = part("drive", turned(cylinder(30, 84), y=42, rpy=(QUARTER, 0, 0)))
    # What is below the middle of the cradle is open, and a little more: it covers 2.35 rad.
    hollow = turned(cylinder(cradle_radius, 200), y=100, rpy=(QUARTER, 0, 0))
    below = box(2 * cradle_radius + 8, 300, 200).at(0, 0, -100 + 0.385 * cradle_radius)
    head = cut(Solid(box(160, 150, 180).shape, box(1, 1, 1).moments).at(0, 0, 60), hollow, below)
    return group("neck", part("column", cylinder(20, 200), z=-230), drive), group("head", part("skull", head))


def test_cradle_turns_about_the_shaft_inside_it() -> None:
    """A bore that covers 2.35 rad, 3 mm around a shaft, has the shaft's axis."""
    found = inferred(*nodding(33.0))
    (arc,) = found.arcs
    assert arc.evidence.type == JointKind.REVOLUTE
    assert abs(arc.evidence.axis.d[1]) == pytest.approx(1.0)


def test_cradle_much_wider_than_the_shaft_shows_nothing() -> None:
    """A recess 20 mm around a shaft is no bearing of it."""
    assert joints(inferred(*nodding(50.0))) == []


def test_small_subassembly_is_a_link_of_its_own() -> None:
    """A wrist with a thousandth of the robot's volume, a gap before and behind it, is a link, not a part of another."""
    base = group("base", part("block", box(400, 400, 400), z=-200))
    forearm = group("forearm", part("tube", cylinder(15, 150), z=2))
    ring, drive = (
        part("ring", cylinder(14, 20), z=153),
        part("drive", turned(cylinder(12, 40), y=20, rpy=(QUARTER, 0, 0)), z=185),
    )
    wrist = group("wrist", ring, drive)
    hand = group("hand", part("palm", turned(cylinder(12, 60), rpy=(QUARTER, 0, 0)), y=-21, z=185))
    found = inferred(base, forearm, wrist, hand)
    assert links(found) == [{"base/block"}, {"forearm/tube"}, {"wrist/ring", "wrist/drive"}, {"hand/palm"}]
    assert ("revolute", "forearm/tube", "wrist/drive") in joints(found)
    assert ("revolute", "hand/palm", "wrist/drive") in joints(found)


def test_three_equal_hinges_on_one_line_hold_a_door() -> None:
    """Hinges in a list of their own, each with a leaf of two knuckles and one of one: the door turns, in one joint."""
    pair, single = box(30, 3, 90).at(-16, 6, 0), box(30, 3, 30).at(16, 6, 0)
    knuckle = cylinder(7, 29.6).at(0, 0, -14.8) - cylinder(4, 29.6).at(0, 0, -14.8)
    gap = box(20, 20, 30.4)
    pair = pair - gap + knuckle.at(0, 0, -30) + knuckle.at(0, 0, 30)
    hinges = [
        part(name, solid, z=z)
        for z in (-300, 0, 300)
        for name, solid in (("leaf", pair), ("flap", single - cylinder(7, 40).at(0, 0, -20) + knuckle))
    ]
    wall, door = part("wall", box(100, 40, 900), x=-53, y=27.5), part("door", box(400, 40, 800), x=203, y=27.5)
    found = inferred(wall, door, group("bought", *hinges))
    assert [arc.evidence.why for arc in found.arcs] == ["knuckles that alternate on one line"]
