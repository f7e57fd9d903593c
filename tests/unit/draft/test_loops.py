"""The tree of a mechanism, and the joints that close its loops."""

import numpy as np

from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.mechanism.joints import Joint
from stepbot.draft.mechanism.loops import spanning_tree
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind


def link(a: int, b: int, score: float, kind: JointKind = JointKind.REVOLUTE, *, drives: bool = False) -> Joint:
    """A joint between two clusters."""
    axis = Axis(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    return Joint(JointEvidence(score, a, b, kind, axis, "", drives=drives), a, b)


def closures(*joints: Joint) -> list[tuple[int, int]]:
    """The clusters of the joints that close loops, in a mechanism of four clusters whose root is 0."""
    arcs = spanning_tree(joints, {n: n for n in range(4)}, 0)
    return [(arc.evidence.a, arc.evidence.b) for arc in arcs if arc.is_closure]


def test_loop_is_not_cut_at_its_motor() -> None:
    """A joint that a motor drives is in the tree, whatever the scores: a closure cannot have an actuator."""
    passive = link(0, 1, 0.9), link(1, 2, 0.95), link(2, 3, 0.87)
    assert closures(*passive, link(0, 3, 0.83)) == [(0, 3)]
    assert closures(*passive, link(0, 3, 0.83, drives=True)) == [(2, 3)]


def test_loop_is_not_cut_at_a_slide() -> None:
    """A prismatic joint is in the tree, and a ball closes the loop, whatever the scores."""
    slide, ball = link(0, 3, 0.6, JointKind.PRISMATIC), link(1, 2, 0.95, JointKind.BALL)
    assert closures(link(0, 1, 0.9), ball, link(2, 3, 0.87), slide) == [(1, 2)]
