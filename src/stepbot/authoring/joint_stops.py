"""Stops of drafted joints, where their limits are unknown: hints for whoever fills in the limits."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly, BodyKind

from .draft import Draft, DraftJoint, FoundStop
from .stops import Question, Shape, Stop, find_stops

_STOPPED = (JointKind.REVOLUTE, JointKind.PRISMATIC)


def with_stops(draft: Draft, assembly: Assembly) -> Draft:
    """The draft with the stops of its joints that have no limits, where parts of their two links meet."""
    members = {link.name: link.components for link in draft.links}
    asked = [joint for joint in draft.joints if _is_open(joint)]
    found = find_stops([_question(joint, members[joint.parent], members[joint.child], assembly) for joint in asked])
    stopped = {
        joint.name: replace(joint, stops=_named(stops.found, joint, assembly), stops_skipped=stops.skipped)
        for joint, stops in zip(asked, found, strict=True)
    }
    return replace(draft, joints=tuple(stopped.get(joint.name, joint) for joint in draft.joints))


def _is_open(joint: DraftJoint) -> bool:
    is_drafted = joint.confidence.is_chosen and joint.direction is not None
    return is_drafted and joint.limits is None and joint.type in _STOPPED


def _question(joint: DraftJoint, still: Sequence[int], moving: Sequence[int], assembly: Assembly) -> Question:
    return Question(
        joint.type is JointKind.PRISMATIC,
        np.array(joint.point),
        np.array(joint.direction),
        tuple(_shape(part, assembly) for part in still if _is_solid(part, assembly)),
        tuple(_shape(part, assembly) for part in moving if _is_solid(part, assembly)),
    )


def _is_solid(part: int, assembly: Assembly) -> bool:
    body = assembly.components[part].body
    return body >= 0 and assembly.bodies[body].kind is BodyKind.SOLID and len(assembly.bodies[body].mesh.faces) > 0


def _shape(part: int, assembly: Assembly) -> Shape:
    component = assembly.components[part]
    mesh = assembly.bodies[component.body].mesh
    return Shape(part, component.X_WC.apply(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32))


def _named(stops: Sequence[Stop], joint: DraftJoint, assembly: Assembly) -> tuple[FoundStop, ...]:
    paths = [component.path for component in assembly.components]
    return tuple(
        FoundStop(round(joint.zero + stop.position, 4), (paths[stop.still], paths[stop.moving])) for stop in stops
    )
