"""The joint table of a robot file: positions of its joints from an observation."""

from collections.abc import Mapping

import numpy as np

from stepbot.engines.observation import Observation, Request
from stepbot.engines.reference import observe_robot
from stepbot.geometry.spatial import Pose, Vector3, vector3
from stepbot.robot.joint_table import JointRow
from stepbot.robot.model import Robot

_DECIMALS = 9


def joint_rows_of(robot: Robot) -> tuple[JointRow, ...]:
    """Where each joint of a robot is, with all joints at 0."""
    return joint_rows(observe_robot(robot, Request("", "", configurations=({},)), dynamics=False))


def joint_rows(observation: Observation) -> tuple[JointRow, ...]:
    """Every joint, then every closure, in the frame of the base.

    Args:
        observation: An observation of the file; its first configuration has all joints at 0.
    """
    poses: Mapping[str, Pose] = observation.poses[0] if observation.poses else {}
    rows = []
    for joint in observation.joints:
        X_BC = poses.get(joint.child)
        origin = None if X_BC is None else _tidy(X_BC.apply(joint.anchor))
        axis, axis2 = (_turned(X_BC, direction) for direction in (joint.axis, joint.axis2))
        rows.append(JointRow(joint.name, joint.kind, joint.parent, joint.child, origin, axis, axis2))
    for closure in observation.closures or ():
        X_BA = poses.get(closure.link_a)
        X_BF = None if X_BA is None or closure.X_AF is None else X_BA @ closure.X_AF
        origin = None if X_BF is None else _tidy(X_BF.position)
        axis = _turned(X_BF, closure.axis)
        ends = closure.link_a, closure.link_b
        rows.append(JointRow(closure.name, closure.kind, *ends, origin, axis, is_closure=True))
    return tuple(rows)


def _turned(X_BF: Pose | None, direction: Vector3 | None) -> Vector3 | None:
    return None if X_BF is None or direction is None else _tidy(X_BF.turn(direction))


def _tidy(vector: object) -> Vector3:
    """Rounded to a nanometre, to remove differences between machines, and without minus zero."""
    return vector3(np.round(np.asarray(vector, dtype=np.float64), _DECIMALS) + 0.0)
