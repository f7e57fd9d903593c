"""What the user states about an assembly or a draft.

Facts are evidence that overrides all other; corrections change a draft: its root, a type, or that a joint is fixed.
"""

from collections.abc import Iterator

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import Alternative, Draft, DraftConnection, DraftJoint
from stepbot.draft.evidence.evidence import Evidence, JointEvidence, Priority, Weld
from stepbot.draft.parts.axis import Axis
from stepbot.geometry.spatial import Vector3
from stepbot.robot.model import JointKind

STATED = "stated by the user"


class KnownJoint(Struct, frozen=True):
    """A joint between two parts."""

    a: str
    """Path of one component."""
    b: str
    """Path of the other."""
    type: JointKind
    point: Vector3
    """On the axis [m], in the assembly; the centre of a ball."""
    direction: Vector3 | None
    """Unit direction of the axis; None for a ball."""
    direction2: Vector3 | None = None
    """Of the second axis of a universal joint."""
    why: str = STATED


class Facts(Struct, frozen=True):
    """Everything known."""

    joints: tuple[KnownJoint, ...] = ()
    rigid: tuple[tuple[str, str], ...] = ()
    """Pairs of paths of components that move as one."""
    root: int = -1
    """Index of a component of the root link; -1 if unknown."""

    def with_joint(self, joint: KnownJoint) -> "Facts":
        """These and a joint; a fixed one makes its parts a rigid pair."""
        if joint.type == JointKind.FIXED:
            return replace(self, rigid=(*self.rigid, (joint.a, joint.b)))
        return replace(self, joints=(*self.joints, joint))


NO_FACTS = Facts()


def fact_evidence(survey: Survey, facts: Facts, evidence: Evidence) -> None:
    """Add everything known.

    Raises:
        KeyError: A path is not that of a component with a body.
    """
    index = {part.path: i for i, part in survey.parts.items()}
    for a, b in facts.rigid:
        one, two = sorted((index[a], index[b]))
        evidence.welds.append(Weld(1.0, one, two, STATED, priority=Priority.STATED))
    for known in facts.joints:
        first, second = sorted((index[known.a], index[known.b]))
        axis2 = _axis(known.point, known.direction2) if known.direction2 is not None else None
        axis = _axis(known.point, known.direction)
        evidence.joint(
            JointEvidence(1.0, first, second, known.type, axis, known.why, axis2=axis2, priority=Priority.STATED)
        )


def _axis(point: Vector3, direction: Vector3 | None) -> Axis:
    return Axis(np.array(point), None if direction is None else np.array(direction))


def known_joint(joint: DraftConnection, alternative: Alternative | None = None) -> KnownJoint:
    """The fact that a joint is as drafted, or that it is one of its alternatives."""
    one = joint if alternative is None else alternative
    a, b = joint.parts if alternative is None else (alternative.a, alternative.b)
    second = joint.direction2 if alternative is None and isinstance(joint, DraftJoint) else None
    why = "; ".join((STATED, *one.confidence.evidence))
    return KnownJoint(a, b, one.type, one.point or joint.point, one.direction, second, why)


def known_fixed(joint: DraftConnection) -> KnownJoint:
    """The fact that both sides of a joint move as one."""
    return KnownJoint(*joint.parts, JointKind.FIXED, joint.point, None)


def rerooted(draft: Draft, root: str) -> Draft:
    """The same robot with another root link; joints between the two roots are reversed and keep their positions.

    Raises:
        KeyError: There is no such link.
    """
    by_name = {link.name: link for link in draft.links}
    chosen = by_name.pop(root)
    above = {joint.child: joint for joint in draft.joints}
    turned: dict[str, DraftJoint] = {}
    at = root
    while at in above:
        joint = above[at]
        turned[joint.name] = _turned_round(joint)
        at = joint.parent
    joints = tuple(_ordered(root, tuple(turned.get(joint.name, joint) for joint in draft.joints)))
    return replace(draft, root=root, links=(chosen, *by_name.values()), joints=joints)


def _turned_round(joint: DraftJoint) -> DraftJoint:
    """The same motion with parent and child exchanged: the same positions, about the opposite axis."""
    direction = None if joint.direction is None else _opposite(joint.direction)
    axis2 = None if joint.axis2 is None else _opposite_axis(joint.axis2)
    direction2 = None if joint.direction2 is None else _opposite(joint.direction2)
    turned = replace(
        joint, parent=joint.child, child=joint.parent, axis=_opposite_axis(joint.axis), direction=direction
    )
    if joint.type is JointKind.UNIVERSAL and axis2 is not None and turned.direction is not None:
        # With parent and child exchanged, the second axis comes first.
        return replace(turned, axis=axis2, axis2=turned.axis, direction=direction2, direction2=turned.direction)
    return turned


def _opposite_axis(axis: str | Vector3) -> str | Vector3:
    if isinstance(axis, str):
        return axis.removeprefix("-") if axis.startswith("-") else f"-{axis}"
    return _opposite(axis)


def _opposite(v: Vector3) -> Vector3:
    return (0.0 - v[0], 0.0 - v[1], 0.0 - v[2])


def _ordered(root: str, joints: tuple[DraftJoint, ...]) -> Iterator[DraftJoint]:
    """Joints from the root down, a parent's before those of its children."""
    waiting = [root]
    while waiting:
        at = waiting.pop(0)
        for joint in joints:
            if joint.parent == at:
                yield joint
                waiting.append(joint.child)
