"""Swivels, struts and slides: what a shaft in a bore is between other joints."""

from math import pi

import numpy as np
import pytest

from stepbot.draft.contacts.freedom import Freedom, FreedomKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.mechanism.joints import Joint
from stepbot.draft.mechanism.locked import slide_in_struts, stop_spinning_rods
from stepbot.draft.mechanism.loops import TreeJoint, loop_motions
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind
from tests.assembled import inferred, joints, links, part, turned
from tests.solids import box, cylinder, sphere

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def joint(
    kind: JointKind, a: int, b: int, x: float = 0.0, y: float = 0.0, direction: np.ndarray | None = None
) -> Joint:
    """A joint through (x, y); a revolute one is that of a shaft which could slide, too."""
    at = Axis(np.array([x, y, 0.0]), direction)
    free = Freedom(FreedomKind.CYLINDRICAL, 2, at.point, direction)
    relation = Relation(a, b, (), (), (), free, Via.PIN, at) if kind == JointKind.REVOLUTE else None
    return Joint(JointEvidence(0.8, a, b, kind, at, "", relation), a, b)


def test_rod_between_two_balls_gets_one_universal_joint() -> None:
    """The end nearer to the root becomes universal, with both axes across the rod."""
    near, far = joint(JointKind.BALL, 0, 1), joint(JointKind.BALL, 1, 2, x=0.3)
    stop_spinning_rods([near, far], 0)
    assert near.evidence.type == JointKind.BALL, "a ball in a chain, as in a neck, is a ball"
    stop_spinning_rods([near, far, joint(JointKind.REVOLUTE, 0, 2, direction=np.array([0.0, 0.0, 1.0]))], 0)
    assert (near.evidence.type, far.evidence.type) == (JointKind.UNIVERSAL, JointKind.BALL)
    assert near.evidence.axis2 is not None
    assert near.evidence.axis.d @ X == pytest.approx(0.0)
    assert near.evidence.axis2.d @ X == pytest.approx(0.0)
    assert near.evidence.review


def test_strut_between_two_balls_slides() -> None:
    """A shaft in a bore with a ball on either side is a strut; with a hinge on one side it is not."""
    for other, expected in ((JointKind.BALL, JointKind.PRISMATIC), (JointKind.REVOLUTE, JointKind.REVOLUTE)):
        shaft = joint(JointKind.REVOLUTE, 1, 2, direction=X)
        slide_in_struts([joint(JointKind.BALL, 0, 1), shaft, joint(other, 2, 3, direction=Z)])
        assert shaft.evidence.type == expected


def loop(*links: Joint) -> list[TreeJoint]:
    """Arcs around one loop, the last a closure."""
    return [TreeJoint(j.evidence, j.a, j.b, is_closure=n == len(links) - 1) for n, j in enumerate(links)]


def test_piston_of_a_crank_can_only_slide() -> None:
    """Crank, rod and piston: the hinges turn, the piston's shaft slides and does not turn."""
    arcs = loop(
        joint(JointKind.REVOLUTE, 0, 1, direction=Z),
        joint(JointKind.REVOLUTE, 1, 2, 0.03, 0.04, Z),
        joint(JointKind.REVOLUTE, 2, 3, 0.2, 0.0, Z),
        joint(JointKind.REVOLUTE, 0, 3, 0.2, 0.0, X),
    )
    motions = loop_motions(arcs)
    assert [(motions[k].turns, motions[k].slides) for k in range(4)] == [(False, False)] * 3 + [(False, True)]


def test_rod_on_two_parallel_pins_does_not_slide() -> None:
    """In a four-bar linkage all joints turn; that its rods could float along the pins is no motion of it."""
    corners = [(0.0, 0.0), (0.0, 0.1), (0.15, 0.13), (0.2, 0.0)]
    ends = [(0, 1), (1, 2), (2, 3), (0, 3)]
    arcs = loop(*(joint(JointKind.REVOLUTE, *e, *c, Z) for e, c in zip(ends, corners, strict=True)))
    assert [(m.turns, m.slides) for m in loop_motions(arcs).values()] == [(True, False)] * 4


@pytest.mark.parametrize("ends", [(-24.0, 24.0), (24.0,)], ids=["two balls", "one ball"])
def test_a_stud_between_two_balls_on_its_axis_is_fixed(ends: tuple[float, ...]) -> None:
    """A stud through an arm with a ball at each end spins idly and is one with the arm; a rod with one may slide."""
    stud = cylinder(2, 60).at(0, 0, -30)
    arm = box(120, 16, 12).at(-50, 0, 0) - cylinder(2, 12).at(0, 0, -6)
    nodes = [part("arm", arm), part("x", stud)]
    for z in ends:
        ball = sphere(5) - cylinder(2, 12).at(0, 0, -6)
        rod = box(150, 10, 6).at(75, 0, 0) + cylinder(8, 6).at(0, 0, -3) - sphere(5.05)
        nodes += [part(f"ball {z}", ball, z=z), part(f"rod {z}", rod, z=z)]
    found = inferred(*nodes)
    assert [kind for kind, *_ in joints(found)].count("ball") == len(ends)
    assert any({"arm", "x"} <= link for link in links(found)) == (len(ends) == 2)


def test_a_name_makes_no_pin_a_slide() -> None:
    """A rod that turns on a long pin between two cheeks, 0.5 mm beside each, has no travel along it."""
    yoke = box(20, 60, 60).at(-30, 0, 0)
    for y in (-25.5, 25.5):
        yoke = yoke + box(60, 10, 40).at(0, y, 0)
    yoke = yoke + turned(cylinder(4, 60).at(0, 0, -30), rpy=(pi / 2, 0, 0))
    rod = box(112, 40, 20).at(44, 0, 0) - turned(cylinder(4.1, 40).at(0, 0, -20), rpy=(pi / 2, 0, 0))
    assert joints(inferred(part("yoke", yoke), part("piston rod", rod))) == [("revolute", "piston rod", "yoke")]
