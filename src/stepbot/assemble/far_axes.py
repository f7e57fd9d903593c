"""Axes far from the robot: coordinates in another unit, or in another frame."""

import numpy as np

from stepbot.geometry.spatial import cross
from stepbot.robot.model import JointKind
from stepbot.sidecar.document import ExplicitOrigin, JointSection
from stepbot.step.features.axes import millimetres

from .binder import Binder
from .frames import Frames

_POINTS = {JointKind.BALL, JointKind.UNIVERSAL}
_LINES = {JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.SCREW, JointKind.CYLINDRICAL}
_FARTHEST = 1.0
"""Distance from the sphere around the assembly, as a share of its diameter, up to which an axis is plausible."""


def report_far_axes(binder: Binder, frames: Frames) -> None:
    """Report SB423: nothing of the assembly is near the axis of a turning joint."""
    given = {name: joint for name, joint in binder.document.joints.items() if _is_given(joint)}
    box = binder.assembly.bounds(0) if given else None
    if box is None:
        return
    low, high = np.array(box)
    center, diagonal = 0.5 * (low + high), float(np.linalg.norm(high - low))
    for name, joint in given.items():
        X_WJ = frames.joint(name)
        if X_WJ is None:
            continue
        arm = center - np.array(X_WJ.position)
        if joint.type in _LINES:
            arm = cross(arm, X_WJ.turn(joint.axis))
        distance = float(np.linalg.norm(arm)) - 0.5 * diagonal
        if distance > _FARTHEST * diagonal:
            binder.report(
                "SB423",
                ("joints", name, "origin"),
                f"its axis is {millimetres(distance)} from the assembly, which is {millimetres(diagonal)} large",
                help=(
                    "write coordinates with their unit, such as `12 mm` or `4 in`; plain numbers are metres",
                    "coordinates are those of the assembly, unless `relative_to` names a link or a component",
                ),
            )


def _is_given(joint: JointSection) -> bool:
    """Whether a turning joint has coordinates in its origin."""
    if joint.type not in _POINTS | _LINES or isinstance(joint.origin, str):
        return False
    return isinstance(joint.origin, ExplicitOrigin) or joint.origin.offset is not None
