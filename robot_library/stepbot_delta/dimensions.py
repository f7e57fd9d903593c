"""Dimensions of the delta robot [mm], and the poses of its links in the drawing.

The base is at the top, its frame in the plane of the shoulders, z up. Each of three arms carries two parallel rods,
which keep the platform level.
"""

from math import cos, pi, radians, sin, sqrt

import numpy as np

from ..moments import Array, pose, turn

SHOULDER_RADIUS, WRIST_RADIUS = 130.0, 48.0
"""From the centre to the shoulder axes, and to the balls of the platform."""
UPPER, FORE = 200.0, 440.0
"""Shoulder to elbow, elbow to platform."""
HALF_WIDTH = 34.0
"""Half the distance of the two rods of an arm."""
DRAWN = radians(25)
"""Of all upper arms below the horizontal in the drawing."""
HEIGHT = 620.0
"""Of the shoulders above the floor of the cell, which is the assembly's origin."""

PLATE, PLATE_ABOVE = 16.0, 52.0
"""Thickness of the base's plate, and how far its lower face is above the shoulders."""
HUB_RADIUS, ARM_WIDTH = 30.0, 30.0
BEARING, MOTOR_RADIUS, MOTOR_LENGTH = 12.0, 34.0, 96.0
"""Thickness of the plates beside a shoulder; the motor behind one of them."""
BALL, CUP, ROD = 8.0, 12.5, 5.0
"""Radii of the balls, of the cups around them, of the rods."""
SIDES = {"left": HALF_WIDTH, "right": -HALF_WIDTH}


def base_place() -> Array:
    """X_WB: the middle of the shoulders' circle."""
    return pose((0, 0, HEIGHT))


def azimuth(arm: int) -> float:
    """Direction [rad] of an arm, 0 to 2."""
    return 2 * pi / 3 * arm


def shoulder_frame(arm: int) -> Array:
    """X_BS: the origin on the shoulder's axis, x outwards, y along the axis."""
    return pose(rotation=turn("z", azimuth(arm))) @ pose((SHOULDER_RADIUS, 0, 0))


def arm_place(arm: int) -> Array:
    """X_WA: the shoulder's frame, x turned down along the arm."""
    return base_place() @ shoulder_frame(arm) @ pose(rotation=turn("y", DRAWN))


def depth(angle: float) -> float:
    """Depth of the platform's balls below the shoulders with all arms at the same angle [rad]."""
    gap = SHOULDER_RADIUS + UPPER * cos(angle) - WRIST_RADIUS
    return UPPER * sin(angle) + sqrt(FORE**2 - gap**2)


def platform_centre() -> Array:
    """Centre of the platform's balls in the drawing, in W."""
    return np.array((0.0, 0.0, HEIGHT - depth(DRAWN)))


def wrist_offset(arm: int, y: float) -> Array:
    """Position of a ball of the platform from the centre of all."""
    offset: Array = turn("z", azimuth(arm)) @ np.array((WRIST_RADIUS, y, 0.0))
    return offset


def rod_place(arm: int, y: float) -> Array:
    """X_WR of the rod at ``y`` along the elbow: the origin at its upper ball, z towards the lower, y as the elbow's."""
    X_WA = arm_place(arm)
    elbow = X_WA[:3, :3] @ np.array((UPPER, y, 0.0)) + X_WA[:3, 3]
    along = (platform_centre() + wrist_offset(arm, y) - elbow) / FORE
    across = X_WA[:3, 1]
    return pose(elbow, np.column_stack((np.cross(across, along), across, along)))


def platform_place() -> Array:
    """X_WP: the origin at the first ball, axes as the assembly's."""
    return pose(platform_centre() + wrist_offset(0, HALF_WIDTH))
