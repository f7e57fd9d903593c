"""A floating joint as three prismatic joints, along the axes of the parent's side, and a ball joint."""

from dataclasses import replace

from ..model import Joint, JointKind, Robot
from .chain import Steps, chained, slide


def floating_to_slides_and_ball(robot: Robot) -> Robot:
    """The robot with three prismatic joints and a ball joint in place of every floating joint."""
    return chained(robot, JointKind.FLOATING, _steps)


def _steps(joint: Joint) -> Steps:
    return {
        "_x": slide(joint, (1.0, 0.0, 0.0)),
        "_y": slide(joint, (0.0, 1.0, 0.0)),
        "_z": slide(joint, (0.0, 0.0, 1.0)),
        "_turn": replace(joint, kind=JointKind.BALL),
    }
