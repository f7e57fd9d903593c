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
    shapes = _Shapes(assembly)
    found = find_stops([_question(joint, members[joint.parent], members[joint.child], shapes) for joint in asked])
    stopped = {
        joint.name: replace(joint, stops=_named(stops.found, joint, assembly), stops_skipped=stops.skipped)
        for joint, stops in zip(asked, found, strict=True)
    }
    return replace(draft, joints=tuple(stopped.get(joint.name, joint) for joint in draft.joints))


def _is_open(joint: DraftJoint) -> bool:
    is_drafted = joint.confidence.is_chosen and joint.direction is not None
    return is_drafted and joint.limits is None and joint.type in _STOPPED


def _question(joint: DraftJoint, still: Sequence[int], moving: Sequence[int], shapes: "_Shapes") -> Question:
    is_slide, point, direction = joint.type is JointKind.PRISMATIC, np.array(joint.point), np.array(joint.direction)
    return Question(is_slide, point, direction, shapes.of(still), shapes.of(moving))


class _Shapes:
    """Solid parts in the assembly; a link with several joints is placed once."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._known: dict[int, Shape] = {}

    def of(self, parts: Sequence[int]) -> tuple[Shape, ...]:
        """The solids among some parts."""
        return tuple(self._shape(part) for part in parts if self._is_solid(part))

    def _is_solid(self, part: int) -> bool:
        body = self._assembly.components[part].body
        if body < 0:
            return False
        return self._assembly.bodies[body].kind is BodyKind.SOLID and len(self._assembly.bodies[body].mesh.faces) > 0

    def _shape(self, part: int) -> Shape:
        if part not in self._known:
            component = self._assembly.components[part]
            mesh = self._assembly.bodies[component.body].mesh
            faces = np.asarray(mesh.faces, dtype=np.int32)
            self._known[part] = Shape(part, component.X_WC.apply(mesh.vertices), faces)
        return self._known[part]


def _named(stops: Sequence[Stop], joint: DraftJoint, assembly: Assembly) -> tuple[FoundStop, ...]:
    paths = [component.path for component in assembly.components]
    return tuple(
        FoundStop(round(joint.zero + stop.position, 4), (paths[stop.still], paths[stop.moving])) for stop in stops
    )
