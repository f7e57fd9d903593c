"""Drafts corrected by answers of the user."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.answers import Facts, KnownJoint, fact_evidence, known_fixed, known_joint, rerooted
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.draft import Alternative, Confidence, Draft, DraftLink, OriginForm, OriginSnippet
from stepbot.draft.evidence.evidence import Evidence
from stepbot.geometry.spatial import Vector3
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import JointKind, Limit
from tests.unit.assemble.workshop import Workshop, at
from tests.unit.draft.test_sidecar_text import HINGE, built

ARMS = ("base", "arm", "hand", "lamp")


def chain(elbow: JointKind = JointKind.REVOLUTE, axes: tuple[str | Vector3, str | Vector3] = ("x", "y")) -> Draft:
    """A base with an arm with a hand, and a lamp on the base."""
    links = tuple(DraftLink(name, (name,), Confidence(1.0)) for name in ARMS)
    joints = [
        replace(
            HINGE,
            name=f"to_{child}",
            type=elbow if child == "arm" else JointKind.REVOLUTE,
            parent=parent,
            child=child,
            axis=axes[0],
            axis2=axes[1],
            origin=OriginSnippet(OriginForm.XYZ, xyz=(0.01 * i, 0.0, 0.02)),
            limits=None if child == "arm" and elbow is JointKind.UNIVERSAL else Limit(-1.0, 1.5),
        )
        for i, (parent, child) in enumerate((("base", "arm"), ("arm", "hand"), ("base", "lamp")))
    ]
    return Draft("test", "base", links, tuple(joints), without_density=("",))


def shop() -> Workshop:
    """Four boxes in a row."""
    made = Workshop()
    for i, name in enumerate(ARMS):
        made.box(name, X_PC=at(30 * i, 0, 0))
    return made


OBLIQUE = ((2 / 3, -1 / 3, 2 / 3), (1 / 3, -2 / 3, -2 / 3))
"""Two axes at right angles, along no axis of the assembly."""


@pytest.mark.parametrize("axes", [("x", "y"), ("-z", "y"), OBLIQUE], ids=["words", "minus", "numbers"])
@pytest.mark.parametrize("elbow", [JointKind.REVOLUTE, JointKind.UNIVERSAL])
def test_another_root_leaves_the_motion_as_it_was(
    elbow: JointKind, axes: tuple[str | Vector3, str | Vector3], tmp_path: Path
) -> None:
    """From another root, the same joint positions give the same relative poses of the links."""
    draft = chain(elbow, axes)
    before, _ = built(draft, tmp_path, shop())
    after, _ = built(rerooted(draft, "hand"), tmp_path, shop())
    assert [link.name for link in after.links] == ["hand", "arm", "base", "lamp"]
    assert [(j.parent, j.child) for j in after.joints] == [("hand", "arm"), ("arm", "base"), ("base", "lamp")]
    q = {"to_arm": 0.4, "to_hand": 0.7, "to_lamp": -0.3}
    turned_q = dict(q)
    if elbow is JointKind.UNIVERSAL:  # seen from the other side, its second axis comes first
        others = {"to_hand": 0.7, "to_lamp": -0.3}
        q, turned_q = {**others, "to_arm_1": 0.4, "to_arm_2": 0.2}, {**others, "to_arm_1": 0.2, "to_arm_2": 0.4}
    moved = [link_poses(before, q), link_poses(after, turned_q)]
    drawn = [link_poses(before, {}), link_poses(after, {})]
    for name in ARMS:
        motions = []
        for then, now in zip(drawn, moved, strict=True):  # of bodies in the assembly, independent of the links' frames
            body, arm = (now[one] @ then[one].inverse() for one in (name, "arm"))
            motions.append((arm.inverse() @ body).matrix)
        assert np.allclose(*motions, atol=1e-12), name


def test_unknown_root_is_refused() -> None:
    """A root that is not a link is rejected."""
    with pytest.raises(KeyError):
        rerooted(chain(), "nobody")


def test_answer_is_a_fact_about_two_parts() -> None:
    """A confirmed joint, one of its alternatives and a fixed one are facts with their parts, type and axis."""
    turn = Alternative(JointKind.BALL, "x", "y", Confidence(0.6, ("a ball",)), (0.0, 0.0, 0.01), None)
    joint = replace(HINGE, alternatives=(turn,))
    same = known_joint(joint)
    assert ((same.a, same.b), same.type, same.point, same.direction) == (
        *(HINGE.parts, HINGE.type, HINGE.point, HINGE.direction),
    )
    other = known_joint(joint, turn)
    assert (other.a, other.b, other.type, other.point) == ("x", "y", JointKind.BALL, (0.0, 0.0, 0.01))
    assert other.why == "stated by the user; a ball"
    assert known_joint(joint, replace(turn, point=None)).point == HINGE.point
    facts = Facts().with_joint(known_fixed(joint)).with_joint(other)
    assert (facts.rigid, facts.joints) == ((HINGE.parts,), (other,))


def test_facts_are_evidence_of_the_same_axes() -> None:
    """A stated cross has both of its axes, a hinge one, and a ball none; parts are in the order of the survey."""
    made = Workshop()
    for i, name in enumerate(("base", "arm", "hand")):
        made.box(name, X_PC=at(30 * i, 0, 0))
    point, cross = (0.01, 0.02, 0.03), ((0.0, 0.6, 0.8), (1.0, 0.0, 0.0))
    facts = Facts(
        (
            KnownJoint("arm", "base", JointKind.UNIVERSAL, point, *cross),
            KnownJoint("arm", "hand", JointKind.REVOLUTE, point, cross[0]),
            KnownJoint("base", "hand", JointKind.BALL, point, None),
        ),
        (("hand", "arm"),),
    )
    survey, found = Survey(made.assembly, ALL_SOURCES), Evidence()
    fact_evidence(survey, facts, found)
    index = {part.path: i for i, part in survey.parts.items()}
    assert [(one.a, one.b) for one in found.welds] == [(index["arm"], index["hand"])]
    universal, hinge, ball = found.joints
    assert (universal.a, universal.b) == (index["base"], index["arm"])
    assert universal.axis2 is not None
    assert [universal.axis.d.tolist(), universal.axis2.d.tolist()] == [list(one) for one in cross]
    assert universal.axis2.point.tolist() == list(point)
    assert (hinge.axis2, hinge.axis.d.tolist()) == (None, list(cross[0]))
    assert (ball.axis2, ball.axis.point.tolist()) == (None, list(point))
    with pytest.raises(KeyError):
        fact_evidence(survey, Facts((), (("hand", "nobody"),)), Evidence())
