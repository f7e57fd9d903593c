"""How accurate drafted axes are, and whether the faces of the CAD have the reference axis at all.

A reference may have rounded numbers, such as 1.5708 rad for a right angle, and so may the placements in a STEP. An axis
that is exactly that of a face differs from such a reference by the rounding.
"""

import numpy as np

from stepbot.draft.draft_robot import Origins
from stepbot.draft.inference import InferredMechanism
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind
from stepbot.step.faces import FaceKind

from .truth import TrueJoint, Truth, unit_distance

DISTANCE, ANGLE = 1e-6, 1e-6
"""[m] and [rad] up to which an axis is exact."""
_NEAR = (2e-5, 1e-3)
"""The same within which a face shows an axis."""
_REVOLVED = (FaceKind.CYLINDER, FaceKind.CONE, FaceKind.TORUS)


class AxisAccuracy:
    """Compares axes as the draft writes them with the true ones."""

    def __init__(self, inferred: InferredMechanism, truth: Truth) -> None:
        self._scene, self._truth = inferred.survey.scene, truth
        self._origins = Origins(inferred.survey.assembly)
        self._link_of = {i: n for n, members in enumerate(inferred.links) for i in members}

    def is_exact(self, arc: TreeJoint, joint: TrueJoint) -> bool:
        """Whether the axis that the draft writes is within 1e-6 m and 1e-6 rad of the true one."""
        hinge = arc.evidence
        child = hinge.a if self._link_of[hinge.a] == arc.child else hinge.b
        return _agree(self._origins.of(hinge, child).axis, joint)

    def is_drawn(self, joint: TrueJoint) -> bool:
        """Whether the faces that show a true joint have its axis, within the same tolerances, on both of its links.

        Where those of one link are all farther off, as after an export with rounded placements, it has another axis.
        """
        kinds = {JointKind.BALL: (FaceKind.SPHERE,), JointKind.PRISMATIC: (*_REVOLVED, FaceKind.PLANE)}.get(
            joint.kind, _REVOLVED
        )
        for link in (joint.a, joint.b):
            near = [
                axis
                for kind in kinds
                for placed in self._scene.faces(kind)
                if self._truth.link_of.get(placed.part) == link
                and _agree(
                    axis := Axis(placed.point, None if kind == FaceKind.SPHERE else placed.direction), joint, *_NEAR
                )
            ]
            if near and not any(_agree(axis, joint) for axis in near):
                return False
        return True


def _agree(axis: Axis, joint: TrueJoint, distance: float = DISTANCE, angle: float = ANGLE) -> bool:
    if axis.direction is None or joint.kind == JointKind.UNIVERSAL:
        return float(np.linalg.norm(axis.point - joint.point)) <= distance
    if float(np.linalg.norm(np.cross(axis.d, joint.axis))) > angle:
        return False
    return joint.kind == JointKind.PRISMATIC or unit_distance(joint.point, axis.point, axis.d) <= distance
