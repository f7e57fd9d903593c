"""The joints of a Drake plant, as Drake has read them."""

from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from stepbot.geometry.spatial import Array, vector3
from stepbot.robot.model import JointDynamics, Limit

from ..observation import ObservedJoint

if TYPE_CHECKING:
    from .plant import Built

_KINDS = {
    "weld": "fixed",
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "screw",
    "universal": "universal",
    "ball_rpy": "ball",
    "planar": "planar",
}
_NO_LIMIT = 1e15
"""Limits beyond this are SDFormat's value for unlimited, 1e16."""


def observed_joints(built: "Built") -> tuple[ObservedJoint, ...]:
    """The joint above each link; a joint of the root to the world means that the base is fixed."""
    drives, springs = _drives(built), _springs(built)
    inside = [joint for joint in built.joints if joint.parent_body().name() != "world"]
    return tuple(_joint(built, joint, drives, springs) for joint in inside)


def _drives(built: "Built") -> dict[str, float]:
    """Effort limit of every joint that has an actuator."""
    actuators = [built.plant.get_joint_actuator(index) for index in built.plant.GetJointActuatorIndices()]
    return {actuator.joint().name(): float(actuator.effort_limit()) for actuator in actuators}


def _springs(built: "Built") -> dict[str, tuple[float, float]]:
    """Stiffness and rest position of every joint that has a spring."""
    from pydrake.multibody.tree import ForceElementIndex, PrismaticSpring, RevoluteSpring

    found = {}
    for index in range(built.plant.num_force_elements()):
        element = built.plant.get_force_element(ForceElementIndex(index))
        if isinstance(element, RevoluteSpring):
            found[element.joint().name()] = (float(element.default_stiffness()), float(element.default_nominal_angle()))
        elif isinstance(element, PrismaticSpring):
            found[element.joint().name()] = (float(element.stiffness()), float(element.nominal_position()))
    return found


def _joint(
    built: "Built", joint: Any, drives: dict[str, float], springs: dict[str, tuple[float, float]]
) -> ObservedJoint:
    name, kind = joint.name(), _KINDS.get(joint.type_name(), joint.type_name())
    parent, child = joint.parent_body().name(), joint.child_body().name()
    sdf = built.request.format.endswith("sdf")
    if kind == "fixed" and built.request.format == "mjcf":
        name = ""  # MJCF has no fixed joints: this one is Drake's own
    if kind in ("fixed", "ball", "planar"):
        return ObservedJoint(name, kind, parent, child)
    axis, axis2 = _axes(built, joint, kind)
    lower, upper = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
    limit = Limit(lower, upper, float(joint.velocity_upper_limits()[0]), drives.get(name, 0.0))
    limit = limit.without_beyond(_NO_LIMIT)
    damping = joint.default_damping_vector()
    stiffness, reference = springs.get(name, (0.0, 0.0))
    sprung = sdf and kind in ("revolute", "prismatic")
    return ObservedJoint(
        name,
        "continuous" if kind == "revolute" and limit.lower == -inf and limit.upper == inf else kind,
        parent,
        child,
        axis=vector3(axis),
        axis2=None if axis2 is None else vector3(axis2),
        # Drake's pitch is the advance per turn.
        pitch=float(joint.screw_pitch()) / (2.0 * np.pi) if kind == "screw" else None,
        limit=limit,
        limit_fields=_limit_fields(built, kind, name in drives),
        dynamics=JointDynamics(
            float(damping[0]) if len(set(damping.tolist())) == 1 else nan,
            stiffness=stiffness,
            spring_reference=reference,
        ),
        dynamics_fields=("damping", *(("stiffness", "spring_reference") if sprung else ())),
    )


def _limit_fields(built: "Built", kind: str, driven: bool) -> tuple[str, ...]:
    """Effort limits from actuators, where Drake keeps them: one per joint of SDFormat and per transmission of URDF."""
    if kind == "universal":
        return ("lower", "upper")
    if kind == "screw":  # Drake sets no limit
        return ("effort",)
    sdf = built.request.format.endswith("sdf")
    return ("lower", "upper", "velocity", *(("effort",) if sdf or (driven and built.request.format == "urdf") else ()))


def _axes(built: "Built", joint: Any, kind: str) -> tuple[Array, Array | None]:
    """Axes in the child's frame; Drake turns about x and y of a universal joint's own frame."""
    R_CM: Array = joint.frame_on_child().GetFixedPoseInBodyFrame().rotation().matrix()
    if kind == "universal":
        return R_CM[:, 0], R_CM[:, 1]
    if kind == "screw":  # its axis is not reported: it is the direction that a rotation leaves unchanged
        built.place({joint.name(): 1.0})
        X_FM = built.plant.CalcRelativeTransform(built.context, joint.frame_on_parent(), joint.frame_on_child())
        R_FM: Array = X_FM.rotation().matrix()
        return R_CM @ (np.array([R_FM[2, 1], R_FM[0, 2], R_FM[1, 0]]) - [R_FM[1, 2], R_FM[2, 0], R_FM[0, 1]]), None
    getter = {"revolute": "revolute_axis", "prismatic": "translation_axis"}.get(kind)
    return (R_CM @ np.array(getattr(joint, getter)()) if getter else np.full(3, nan)), None
