"""Forward kinematics of the quadruped in closed form [m, rad]; the inverse is in :mod:`robot_library.legs`."""

from math import cos, sin
from typing import Any

import numpy as np

from ..legs import known_feet
from ..moments import Array, pose, turn
from . import dimensions as d

LOWEST, HIGHEST = (-0.7, -1.2, -2.7), (0.7, 2.6, -0.35)
"""Positions [rad] of roll, hip and knee within the limits of the sidecar."""
JOINTS = ("roll", "hip", "knee")


def foot(name: str, roll: float, hip: float, knee: float) -> Array:
    """X_BF of a leg's foot in the trunk, shape (4, 4) [m]; axes as those of the shank."""
    front, left = d.CORNERS[name]
    back = d.THIGH * sin(hip) + d.SHANK * sin(hip + knee)
    down = d.THIGH * cos(hip) + d.SHANK * cos(hip + knee)
    aside = left * d.HIP_OFFSET
    place = (
        front * d.HIP_X - back,
        left * d.HIP_Y + aside * cos(roll) + down * sin(roll),
        aside * sin(roll) - down * cos(roll),
    )
    return pose(np.array(place) / 1000, turn("x", roll) @ turn("y", hip + knee))


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: the feet at some positions of the joints."""
    return known_feet(foot, JOINTS, {name: d.drawn(name) for name in d.LEGS}, (LOWEST, HIGHEST), seed=3)
