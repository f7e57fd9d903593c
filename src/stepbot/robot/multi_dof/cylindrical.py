"""A cylindrical joint as a prismatic and a revolute joint with the same axis."""

from ..model import Joint, JointKind, Robot
from .chain import Steps, chained, slide, turn


def cylindrical_to_two(robot: Robot) -> Robot:
    """The robot with a prismatic and a revolute joint in place of every cylindrical joint."""
    return chained(robot, JointKind.CYLINDRICAL, _steps)


def _steps(joint: Joint) -> Steps:
    return {"_slide": slide(joint, joint.axis), "_turn": turn(joint, joint.axis)}
