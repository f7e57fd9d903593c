"""A ball joint as three revolute joints: yaw, pitch, roll.

The chain loses a degree of freedom at a pitch of +-90 deg (gimbal lock), which a ball joint does not.
"""

from ..model import Joint, JointKind, Robot
from .chain import Steps, chained, turn


def ball_to_revolutes(robot: Robot) -> Robot:
    """The robot with three revolute joints in place of every ball joint."""
    return chained(robot, JointKind.BALL, _steps)


def _steps(joint: Joint) -> Steps:
    return {
        "_yaw": turn(joint, (0.0, 0.0, 1.0)),
        "_pitch": turn(joint, (0.0, 1.0, 0.0)),
        "_roll": turn(joint, (1.0, 0.0, 0.0)),
    }
