"""Inference from facts: stated joints, rigid pairs and the root override the evidence."""

import pytest

from stepbot.draft.answers import STATED, Facts, KnownJoint
from stepbot.draft.inference import InferredMechanism, infer_mechanism
from stepbot.robot.model import JointKind
from tests.assembled import assembled, group, joints, links, part
from tests.solids import box, cylinder

PLATE = box(200, 200, 10).at(0, 0, -5)
"""Its upper side is z = 0 [mm]."""


def turntable(facts: Facts) -> InferredMechanism:
    """A disc on a plate and a block on the disc, screwed or turning: the drawing does not show it."""
    assembly = assembled(part("plate", PLATE), part("disc", cylinder(50, 10)), part("block", box(40, 30, 20), z=20))
    return infer_mechanism(assembly, facts=facts)


def test_stated_joint_separates_what_was_one() -> None:
    """Without facts all three are one link; a stated joint is taken, and the block goes with the disc."""
    assert links(turntable(Facts())) == [{"plate", "disc", "block"}]
    known = KnownJoint("disc", "plate", JointKind.REVOLUTE, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    found = turntable(Facts(joints=(known,)))
    assert links(found) == [{"plate"}, {"disc", "block"}]
    (arc,) = found.arcs
    assert (arc.evidence.why, arc.evidence.score, arc.evidence.review) == (STATED, 1.0, "")


def test_rigid_pair_is_one_link() -> None:
    """An arm on a pin of another subassembly turns, unless the user says that it is pressed in."""
    base = group("base", part("block", PLATE + cylinder(10, 30)))
    arm = group("arm", part("lever", box(120, 30, 20).at(40, 0, 15) - cylinder(10.02, 20).at(0, 0, 5)))
    assembly = assembled(base, arm)
    assert joints(infer_mechanism(assembly)) == [("revolute", "arm/lever", "base/block")]
    rigid = infer_mechanism(assembly, facts=Facts(rigid=(("arm/lever", "base/block"),)))
    assert (rigid.arcs, links(rigid)) == ([], [{"base/block", "arm/lever"}])


def test_root_is_the_link_of_a_part() -> None:
    """The root is the link of the part that the user names, however small it is."""
    known = KnownJoint("disc", "plate", JointKind.REVOLUTE, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    found = turntable(Facts(joints=(known,), root=3))
    assert links(found)[found.root] == {"disc", "block"}
    assert [(arc.parent, arc.child) for arc in found.arcs] == [(1, 0)]


def test_fact_about_no_part_is_an_error() -> None:
    """A path that is not that of a part is a KeyError."""
    with pytest.raises(KeyError):
        turntable(Facts(rigid=(("disc", "nothing"),)))
