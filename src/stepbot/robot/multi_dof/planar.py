"""A planar joint as two prismatic joints in its plane and a revolute one about its normal."""

from stepbot.geometry.spatial import perpendicular_frame, vector3

from ..model import Joint, JointKind, Robot
from .chain import Steps, chained, slide, turn


def planar_to_three(robot: Robot) -> Robot:
    """The robot with three joints in place of every planar joint."""
    return chained(robot, JointKind.PLANAR, _steps)


def _steps(joint: Joint) -> Steps:
    x, y, _ = perpendicular_frame(joint.axis).T
    return {"_x": slide(joint, vector3(x)), "_y": slide(joint, vector3(y)), "_turn": turn(joint, joint.axis)}
