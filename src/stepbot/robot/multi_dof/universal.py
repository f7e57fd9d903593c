"""A universal (Cardan) joint as two revolute joints: about the axis on the parent, then about that on the child."""

from ..model import Joint, JointKind, Robot
from .chain import Steps, chained, turn


def universal_to_revolutes(robot: Robot) -> Robot:
    """The robot with two revolute joints in place of every universal joint."""
    return chained(robot, JointKind.UNIVERSAL, _steps)


def _steps(joint: Joint) -> Steps:
    return {"_1": turn(joint, joint.axis), "_2": turn(joint, joint.axis2)}
