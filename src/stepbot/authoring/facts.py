"""What is known about an assembly beyond its file, such as answers of the user: evidence that overrides all other."""

from dataclasses import dataclass, replace

import numpy as np

from stepbot.geometry.spatial import Vector3
from stepbot.robot.model import JointKind

from .axis import Axis
from .evidence import Evidence, Hinge, Rank, Weld
from .survey import Survey

STATED = "stated by the user"


@dataclass(frozen=True)
class KnownJoint:
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


@dataclass(frozen=True)
class Facts:
    """Everything known."""

    joints: tuple[KnownJoint, ...] = ()
    rigid: tuple[tuple[str, str], ...] = ()
    """Pairs of paths of components that move as one."""
    root: int = -1
    """Index of a component of the root link; -1 if unknown."""

    def with_joint(self, known: KnownJoint) -> "Facts":
        """These and a joint; a fixed one makes its parts a rigid pair."""
        if known.type == JointKind.FIXED:
            return replace(self, rigid=(*self.rigid, (known.a, known.b)))
        return replace(self, joints=(*self.joints, known))


NO_FACTS = Facts()


def fact_evidence(survey: Survey, facts: Facts, found: Evidence) -> None:
    """Add everything known.

    Raises:
        KeyError: A path is not that of a component with a body.
    """
    index = {part.path: i for i, part in survey.parts.items()}
    for a, b in facts.rigid:
        one, two = sorted((index[a], index[b]))
        found.welds.append(Weld(1.0, one, two, STATED, rank=Rank.STATED))
    for known in facts.joints:
        first, second = sorted((index[known.a], index[known.b]))
        axis2 = _axis(known.point, known.direction2) if known.direction2 is not None else None
        axis = _axis(known.point, known.direction)
        found.hinge(Hinge(1.0, first, second, known.type, axis, known.why, axis2=axis2, rank=Rank.STATED))


def _axis(point: Vector3, direction: Vector3 | None) -> Axis:
    return Axis(np.array(point), None if direction is None else np.array(direction))
