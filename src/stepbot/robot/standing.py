"""Where a robot stands: the height of a floating base on a floor, and the height of the floor below a fixed one."""

import re
from collections.abc import Iterable

import numpy as np

from .bounding_boxes import robot_bounds
from .kinematics import Configuration, initial_configuration, rigid_bodies
from .model import Base, Robot

_DIGITS = 9
"""Decimals [m] of heights: vertices lie on a grid of one nanometre."""


def standing_height(robot: Robot, q: Configuration) -> float:
    """Height [m] of the base's frame above a floor at z = 0 that the lowest point of a floating robot touches.

    The lowest point is that of the collisions, or of the visuals of a robot without collisions. 0 for a fixed base, and
    for a robot without shapes.
    """
    around = robot_bounds(robot, q) if robot.base is Base.FLOATING else None
    return 0.0 if around is None else round(-around[0][2], _DIGITS) + 0.0


def floor_height(robot: Robot) -> float:
    """Height [m] of the floor in the frame of the base, or in the world of a floating robot.

    A robot with a fixed base stands on the lowest point of the links that do not move. If a link that moves is lower in
    the drawn pose, the robot hangs, and the floor is a whole height of the robot below its lowest point.
    """
    drawn = initial_configuration(robot)
    around = robot_bounds(robot, drawn)
    if robot.base is Base.FLOATING or around is None:
        return 0.0
    root = robot.root.name
    still = [link for link, body in rigid_bodies(root, robot.joints).items() if body == root]
    standing = robot_bounds(robot, drawn, still)
    (_, _, lowest), (_, _, highest) = around
    if standing is not None and standing[0][2] <= lowest:
        return round(lowest, _DIGITS) + 0.0
    return round(lowest - (highest - lowest), _DIGITS) + 0.0


def extent(robot: Robot) -> tuple[tuple[float, float, float], float]:
    """Centre [m] and half diagonal [m] of the box around the robot in the drawn pose, where it stands."""
    drawn = initial_configuration(robot)
    around = robot_bounds(robot, drawn)
    low, high = around or ((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0))
    x, y, z = (0.5 * (np.array(low) + np.array(high))).tolist()
    return (x, y, z + standing_height(robot, drawn)), 0.5 * float(np.linalg.norm(np.array(high) - np.array(low)))


_JAW = re.compile(r"(?<![a-z])(?:jaw|gripper|finger|claw|pincer|thumb)s?(?![a-z])", re.IGNORECASE)
_WIDEST = 2.5
"""Largest range [rad] or [m] of a jaw; the wrist that turns a gripper has more."""


def is_jaw(names: Iterable[str], lower: float, upper: float) -> bool:
    """Whether the last joint of an arm is that of a single jaw.

    Args:
        names: Names of the joint and of the link below.
        lower: Lower limit [rad] or [m].
        upper: Upper limit [rad] or [m].
    """
    return upper - lower <= _WIDEST and any(_JAW.search(name) for name in names)
