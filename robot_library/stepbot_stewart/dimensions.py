"""Dimensions of the Stewart platform [mm], and the poses of its links in the drawing.

Six legs stand in three pairs on the base and end in three pairs under the platform, each base pair between two platform
pairs. Each leg has a universal joint at its foot, an electric cylinder, and a ball at its head.
"""

from math import cos, pi, radians, sin

import numpy as np

from ..moments import Array, pose

BASE_RADIUS, PLATFORM_RADIUS = 250.0, 160.0
"""Circles of the feet and of the heads."""
BASE_SPREAD, PLATFORM_SPREAD = radians(11), radians(13)
"""Half the angle between the two feet, and the two heads, of a pair."""
FOOT_HEIGHT, HEAD_HEIGHT = 70.0, 430.0
"""Heights of the centres of the universal joints and, as drawn, of the balls."""
STROKE = 70.0
"""Travel of a leg to either side of the drawn length."""

BASE_PLATE, BASE_EDGE = 18.0, 300.0
PLATFORM_PLATE, PLATFORM_EDGE, PLATFORM_BELOW = 14.0, 196.0, 34.0
"""Thickness and radius of the platform, and height of its lower face above the centres of the balls."""
PEG, YOKE, YOKE_PLATE = 5.0, 15.0, 7.0
"""Radius of the cross' pegs, half the gap of each yoke, thickness of its cheeks."""
CASE, CASE_START, CASE_END = 19.0, 24.0, 205.0
"""Radius of the cylinder, and its start and end along the leg."""
ROD, ROD_START, BALL = 10.0, 110.0, 12.0
"""Radius of the rod, its start along the drawn leg, radius of the ball at its end."""


def anchors() -> tuple[Array, Array]:
    """Feet in the base's frame and heads in the platform's, each (6, 3) [mm]; the frames lie in their planes."""
    feet, heads = [], []
    for leg in range(6):
        pair, side = divmod(leg, 2)
        sign = 1 if side else -1
        at_base = 2 * pi / 3 * pair + sign * BASE_SPREAD
        at_platform = 2 * pi / 3 * pair + sign * (pi / 3 - PLATFORM_SPREAD)
        feet.append((BASE_RADIUS * cos(at_base), BASE_RADIUS * sin(at_base), FOOT_HEIGHT))
        heads.append((PLATFORM_RADIUS * cos(at_platform), PLATFORM_RADIUS * sin(at_platform), 0.0))
    return np.array(feet), np.array(heads)


def platform_place() -> Array:
    """X_WP: the middle of the plane of the balls, as drawn."""
    return pose((0, 0, HEAD_HEIGHT))


def leg_lengths(X_WP: Array) -> Array:
    """Inverse kinematics: from foot to head of each leg, shape (6,) [mm], at a pose of the platform."""
    feet, heads = anchors()
    lengths: Array = np.linalg.norm(heads @ X_WP[:3, :3].T + X_WP[:3, 3] - feet, axis=1)
    return lengths


def leg_place(leg: int) -> Array:
    """X_WL: the origin at the foot, z along the leg, y level."""
    feet, heads = anchors()
    along = heads[leg] + platform_place()[:3, 3] - feet[leg]
    z = along / np.linalg.norm(along)
    y = np.cross((0.0, 0.0, 1.0), z)
    y /= np.linalg.norm(y)
    return pose(feet[leg], np.column_stack((np.cross(y, z), y, z)))


def rod_place(leg: int) -> Array:
    """X_WR: the origin in the ball's centre, axes as those of the leg."""
    return leg_place(leg) @ pose((0, 0, leg_lengths(platform_place())[leg]))
