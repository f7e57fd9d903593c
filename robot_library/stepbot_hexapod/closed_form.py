"""Forward kinematics of the hexapod in closed form [m, rad]; the inverse is in :mod:`robot_library.legs`."""

from math import cos, radians, sin
from typing import Any

import numpy as np

from ..legs import known_feet
from ..moments import Array, pose, turn
from . import dimensions as d

LOWEST, HIGHEST = (-0.65, -1.4, 0.15), (0.65, 1.0, 2.3)
"""Positions [rad] of yaw, hip and knee within the limits of the sidecar."""
JOINTS = ("yaw", "hip", "knee")


def foot(name: str, yaw: float, hip: float, knee: float) -> Array:
    """X_BF of a leg's foot in the body, shape (4, 4) [m]; axes as those of the tibia."""
    x, y, azimuth = d.CORNERS[name]
    heading = radians(azimuth) + yaw
    reach = d.COXA + d.FEMUR * cos(hip) + d.TIBIA * cos(hip + knee)
    down = d.FEMUR * sin(hip) + d.TIBIA * sin(hip + knee)
    place = (x + reach * cos(heading), y + reach * sin(heading), -down)
    return pose(np.array(place) / 1000, turn("z", heading) @ turn("y", hip + knee))


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: the feet at some positions of the joints."""
    return known_feet(foot, JOINTS, {name: d.drawn(name) for name in d.LEGS}, (LOWEST, HIGHEST), seed=6)
