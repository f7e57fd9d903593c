"""Balls in sockets."""

import pytest

from stepbot.draft.contacts.contacts import Socket
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.robot.model import JointKind
from tests.assembled import assembled, cut, group, inferred, joints, links, part
from tests.solids import Solid, box, cylinder, sphere


def socket(radius: float) -> Solid:
    """A block with a spherical hollow around the origin, open below."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    block = box(60, 60, 40).at(0, 0, 15)
    return Solid(BRepAlgoAPI_Cut(block.shape, sphere(radius).shape).Shape(), block.moments)


def found(radius: float, x: float = 0.0) -> list[Socket]:
    """What a ball of r 10 mm and a socket of another radius have in common."""
    nodes = part("socket", socket(radius)), part("ball", sphere(10), x=x)
    return Survey(assembled(*nodes), ALL_SOURCES).contacts.sockets.get((1, 2), [])


@pytest.mark.parametrize(("radius", "x", "count"), [(10.0, 0, 1), (10.5, 0, 1), (12.0, 0, 0), (10.0, 0.1, 0)])
def test_ball_in_a_socket(radius: float, x: float, count: int) -> None:
    """A ball is in a socket of nearly its radius about one centre."""
    assert len(found(radius, x)) == count


def test_joint_is_a_ball_about_the_centre() -> None:
    """A stud with a ball in the socket of another subassembly is a ball joint at its centre."""
    stud = group("stud", part("ball", sphere(10)), part("post", cylinder(4, 60), z=-69.9))
    inference = inferred(group("base", part("block", socket(10.02))), stud)
    (arc,) = inference.arcs
    assert arc.evidence.type == JointKind.BALL
    assert arc.evidence.axis.point == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("s", [0.5, 1.0, 3.0])
def test_the_ball_of_a_rod_end_is_bolted_on(s: float, side: float) -> None:
    """A bored ball in the eye of a rod, on one screw and a spacer beside a lever, is of the lever."""
    bore = cylinder(2.5 * s, 60 * s).at(0, 0, -30 * s)
    above = box(40 * s, 40 * s, 10 * s)
    ball = cut(sphere(6.45 * s), above.at(0, 0, 9.5 * s), above.at(0, 0, -9.5 * s), bore)
    eye = cut(box(80 * s, 18 * s, 6 * s).at(30 * s, 0, 0), sphere(6.5 * s))
    spacer = cylinder(4 * s, 1.5 * s) - cylinder(2.5 * s, 1.5 * s)
    lever = box(80 * s, 20 * s, 10 * s).at(-30 * s, 0, 0) - cylinder(2.5 * s, 10 * s).at(0, 0, -5 * s)
    found = inferred(
        part("lever", lever),
        part("rod", eye, z=side * 11 * s),
        part("ball", ball, z=side * 11 * s),
        part("spacer", spacer, z=5 * s if side > 0 else -6.5 * s),
        part("M5x40 screw", cylinder(2.5 * s, 40 * s).at(0, 0, -20 * s) + cylinder(4.5 * s, 4 * s).at(0, 0, 20 * s)),
    )
    assert joints(found) == [("ball", "lever", "rod")]
    assert any({"lever", "ball"} <= link for link in links(found))


def test_stud_of_a_ball_goes_with_what_holds_it() -> None:
    """A ball stud screwed into a lever is no fastener and no link: the lever is on the ball joint."""
    stud = sphere(10) + cylinder(4, 40).at(0, 0, -49)
    lever = box(100, 30, 12).at(40, 0, -36) - cylinder(4, 12).at(0, 0, -42)
    nodes = [group("base", part("block", socket(10.02))), part("lever", lever), part("ball stud", stud)]
    inference = inferred(*nodes)
    assert joints(inference) == [("ball", "base/block", "lever")]
    assert {"lever", "ball stud"} in links(inference)
    assert [h.type for h in inference.offered] == ["revolute"]
    # Nothing asks whether a stud with a nut turns in the lever.
    assert not inferred(*nodes, part("M8 nut", cylinder(7, 6) - cylinder(4, 6), z=-48)).offered
