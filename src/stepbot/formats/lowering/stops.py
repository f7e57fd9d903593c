"""Limits of joints for formats whose hinges have stops around 0, and whose motors alone limit effort and velocity."""

from dataclasses import replace
from math import inf, isfinite, isinf, pi

from stepbot.robot.model import Joint, JointKind, Robot


def has_stops(joint: Joint) -> bool:
    """Whether a joint has limits that stops can represent: those of a hinge include 0 and lie within ±180°."""
    lower, upper = joint.limit.lower, joint.limit.upper
    if not joint.kind.bounded or (isinf(lower) and isinf(upper)):
        return False
    return joint.kind is JointKind.PRISMATIC or -pi <= lower <= 0.0 <= upper <= pi


def far_limits(robot: Robot) -> list[str]:
    """Hinges with limits that stops cannot represent."""
    return [f"'{joint.name}'" for joint in robot.joints if _is_far(joint)]


def without_far_limits(robot: Robot) -> Robot:
    """The robot without these limits, except where a motor has them."""
    driven = _driven(robot)
    free = {joint.name for joint in robot.joints if _is_far(joint)} - driven

    def freed(joint: Joint) -> Joint:
        return replace(joint, limit=replace(joint.limit, lower=-inf, upper=inf)) if joint.name in free else joint

    return replace(robot, joints=tuple(map(freed, robot.joints)))


def passive_limits(robot: Robot) -> list[str]:
    """Joints without a motor that have an effort or a velocity limit."""
    return [f"'{joint.name}'" for joint in robot.joints if _is_passive(joint, _driven(robot))]


def without_passive_limits(robot: Robot) -> Robot:
    """The robot without these limits."""
    driven = _driven(robot)

    def freed(joint: Joint) -> Joint:
        unlimited = replace(joint.limit, effort=inf, velocity=inf)
        return replace(joint, limit=unlimited) if _is_passive(joint, driven) else joint

    return replace(robot, joints=tuple(map(freed, robot.joints)))


def _is_far(joint: Joint) -> bool:
    bounded = not (isinf(joint.limit.lower) and isinf(joint.limit.upper))
    return joint.kind is JointKind.REVOLUTE and bounded and not has_stops(joint)


def _is_passive(joint: Joint, driven: set[str]) -> bool:
    limited = isfinite(joint.limit.effort) or isfinite(joint.limit.velocity)
    return joint.kind is not JointKind.FIXED and limited and joint.name not in driven


def _driven(robot: Robot) -> set[str]:
    """Joints with an actuator, and those that follow them."""
    driven = {actuator.joint for actuator in robot.actuators}
    followers = {joint.name: joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    while more := {name for name, leader in followers.items() if leader in driven} - driven:
        driven |= more
    return driven
