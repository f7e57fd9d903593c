"""Loops that could not move show which joint is missing."""

from math import pi

import numpy as np
import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.mechanism.locked import held_joints, note_doubts
from stepbot.draft.mechanism.loops import TreeJoint, locked_arcs
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, assembled, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder

ALONG_X = (0.0, pi / 2, 0.0)
RING = cylinder(11, 7) - cylinder(4, 7)
"""A bearing 608."""


def rod(length: float) -> Solid:
    """A rod along x with a seat for a bearing at either end."""
    return box(length + 40, 36, 7).at(length / 2, 0, 3.5) - cylinder(11, 7) - cylinder(11, 7).at(length, 0, 0)


def crank_slider(crank: float, length: float) -> list[Node]:
    """A disc lying on a base, a rod in bearings from a pin of the disc to one of a block, which slides on two rails.

    The disc's pin is at (25, crank) from its axis, the block's at (length, crank); the rails are along x.
    """
    rails = [(y, 30.0) for y in (crank - 30.0, crank + 30.0)]
    base = box(500, 300, 20).at(150, 0, -10)
    for x in (length - 80, length + 80):
        base = base + box(10, 90, 45).at(x, crank, 22.5)
        for y, z in rails:
            base = base - turned(cylinder(4, 10), x - 5, y, z, ALONG_X)
    block = box(50, 80, 20).at(length, crank, 30)
    for y, z in rails:
        block = block - turned(cylinder(4.05, 50), length - 25, y, z, ALONG_X)
    disc = (cylinder(60, 10) + cylinder(4, 37).at(25, crank, 10)).at(-25, 0, 0)
    return [
        part("base", base),
        part("disc", disc),
        part("block", block + cylinder(4, 7).at(length, crank, 40)),
        part("rod", rod(length), 0, crank, 40),
        part("ring 1", RING, 0, crank, 40),
        part("ring 2", RING, length, crank, 40),
        *(part(f"rail {n}", turned(cylinder(4, 170), length - 85, y, z, ALONG_X)) for n, (y, z) in enumerate(rails)),
    ]


def arc(parent: int, child: int, x: float, y: float, *, closure: bool = False) -> TreeJoint:
    """A hinge about z through (x, y) [m]."""
    axis = Axis(np.array([x, y, 0.0]), np.array([0.0, 0.0, 1.0]))
    return TreeJoint(JointEvidence(0.9, parent, child, JointKind.REVOLUTE, axis, ""), parent, child, closure)


def test_triangle_is_locked_and_four_bar_is_not() -> None:
    """Three hinges with parallel axes hold three links rigidly; four let all of them move."""
    three = [arc(0, 1, 0.0, 0.0), arc(1, 2, 0.1, 0.0), arc(0, 2, 0.0, 0.1, closure=True)]
    four = [*three[:2], arc(2, 3, 0.1, 0.13), arc(0, 3, 0.0, 0.1, closure=True)]
    assert locked_arcs(three) == {0, 1, 2}
    assert locked_arcs(four) == set()


@pytest.mark.parametrize(("offset", "is_doubted"), [(0.0, True), (0.1, False)])
def test_two_joints_in_a_row_about_one_line_are_doubted(offset: float, is_doubted: bool) -> None:
    """What turns about one line on both of its sides, as a bearing may, and nowhere else, has one joint."""
    arcs = [arc(0, 1, 0.0, 0.0), arc(1, 2, offset, 0.0)]
    for one in arcs:
        one.evidence.by_role = True
    survey = Survey(assembled(*(part(f"{n}", RING, 30.0 * n) for n in range(3))), ALL_SOURCES)
    note_doubts(arcs, Structure(survey, set()), lambda i: i, has_drives=False)
    assert [bool(one.evidence.review) for one in arcs] == [is_doubted, is_doubted]


def test_chain_has_no_locked_joint() -> None:
    """Without a loop nothing is locked."""
    assert locked_arcs([arc(0, 1, 0.0, 0.0), arc(1, 2, 0.1, 0.0)]) == set()


def test_disc_in_a_locked_loop_turns() -> None:
    """A disc on a plate is one with it, by its face; as the crank of a slider it turns, or nothing could move."""
    nodes = crank_slider(40.0, 200.0)
    found = inferred(*nodes, sources=BARE)
    assert joints(found) == [
        ("prismatic", "base", "block"),
        ("revolute", "base", "disc"),
        ("revolute", "block", "rod"),
        ("revolute", "disc", "rod"),
    ]
    (drive,) = (
        a for a in found.arcs if {"disc", "base"} == {found.survey.parts[i].path for i in (a.evidence.a, a.evidence.b)}
    )
    assert drive.evidence.review == "without it a loop of joints could not move"
    assert not locked_arcs(found.arcs)


def test_disc_in_no_loop_is_one_with_the_plate() -> None:
    """Without block and rod, nothing shows that the disc turns."""
    nodes = crank_slider(40.0, 200.0)
    assert links(inferred(*nodes[:2], sources=BARE)) == [{"base", "disc"}]


@pytest.mark.parametrize("is_needed", [False, True])
def test_one_screw_clamps_a_bracket_whose_loop_moves_without_it(is_needed: bool) -> None:
    """A bracket on one screw turns only if the four-bar that it carries a hinge of needs it as its fourth hinge."""
    plate = box(200, 60, 10).at(0, 0, -5) - cylinder(2.5, 10).at(0, 0, -10)
    screw = cylinder(2.5, 14).at(0, 0, -8) + cylinder(5, 4).at(0, 0, 6)
    bracket = box(30, 20, 6).at(0, 0, 3) - cylinder(2.75, 6)
    survey = Survey(assembled(part("plate", plate), part("bracket", bracket), part("M5 screw", screw)), ALL_SOURCES)
    relation = survey.relation(1, 2)
    assert relation is not None
    assert relation.axis is not None
    why = "the only line that holds both"
    hinge = JointEvidence(0.72, 1, 2, JointKind.REVOLUTE, relation.axis, why, relation, of_linkage=True)
    corners = [(0.1, 0.0), (0.1, 0.1), (0.03, 0.1)][: 3 if is_needed else None]
    chain = [(1, 3), (3, 4), (4, 2)]
    bars = [arc(a, b, x, y, closure=b == 2) for (a, b), (x, y) in zip(chain, corners, strict=True)]
    if not is_needed:
        bars[-1:] = [arc(4, 5, 0.03, 0.1), arc(5, 2, 0.03, 0.02, closure=True)]
    found = held_joints(
        survey, [TreeJoint(hinge, 1, 2, is_closure=False), *bars], [[]] + [[n] for n in range(1, 3)] + [[]] * 3
    )
    assert len(found) == (0 if is_needed else 1)


@pytest.mark.parametrize(("lines", "count"), [(2, 0), (3, 1)])
def test_bolts_on_parallel_lines_hold_two_links(lines: int, count: int) -> None:
    """Two links that could turn about one line and three others beside it are bolted together."""
    survey = Survey(assembled(part("a", box(9, 9, 9)), part("b", box(9, 9, 9), 20)), ALL_SOURCES)
    others = [arc(1, 2, 0.01 * n, 0.0).evidence for n in range(1, lines + 1)]
    assert len(held_joints(survey, [arc(1, 2, 0.0, 0.0)], [[], [1], [2]], others)) == count
