"""Kinematics of the hexapod in closed form [m, rad]: where a foot is, and which positions bring it to a place."""

from math import cos, radians, sin
from typing import Any

import numpy as np

from ..expected import frame
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


def reaching(name: str, place: Array) -> tuple[float, float, float]:
    """Positions of yaw, hip and knee [rad] that bring a foot to a place in the body, shape (3,) [m].

    Raises:
        ValueError: The place is out of reach.
    """
    return d.LEGS[name].reaching(1000 * place)


def known() -> dict[str, Any]:
    """What expected.json holds beyond links and joints: the feet at some positions of the joints."""
    rng = np.random.default_rng(6)
    low, high = np.array(LOWEST), np.array(HIGHEST)
    states = [{name: d.drawn(name) for name in d.LEGS}]
    states += [{name: tuple((low + (high - low) * rng.random(3)).tolist()) for name in d.LEGS} for _ in range(20)]
    return {
        "motions": [
            {
                "joints": {f"{name}_{joint}": q for name in d.LEGS for joint, q in zip(JOINTS, at[name], strict=True)},
                "frames": {f"{name}_foot": frame(foot(name, *at[name])) for name in d.LEGS},
            }
            for at in states
        ]
    }
