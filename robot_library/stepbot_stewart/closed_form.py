"""Inverse kinematics of the Stewart platform in closed form [m]: the leg lengths at a pose of the platform."""

from typing import Any

import numpy as np

from ..expected import frame
from ..moments import Array, pose, turn
from . import dimensions as d


def legs(X_WP: Array) -> dict[str, float]:
    """Position of each leg's slide [m], 0 in the drawing, at a pose of the platform, shape (4, 4) [m]."""
    moved = pose(1000 * X_WP[:3, 3], X_WP[:3, :3])
    change = d.leg_lengths(moved) - d.leg_lengths(d.platform_place())
    return {f"leg_{i}": float(q) / 1000 for i, q in enumerate(change, start=1)}


def platform(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> Array:
    """X_WP, shape (4, 4) [m], moved from the drawing by a shift [m] and rotations [rad] about fixed x, y, z."""
    drawn = d.platform_place()[:3, 3] / 1000
    return pose(drawn + np.array((x, y, z)), turn("z", yaw) @ turn("y", pitch) @ turn("x", roll))


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: legs at some poses of the platform."""
    rng = np.random.default_rng(11)
    ends = np.array((0.03, 0.03, 0.03, 0.15, 0.15, 0.2))
    some = [platform(*(ends * rng.uniform(-1, 1, 6)).tolist()) for _ in range(12)]
    return {"poses": [{"platform": frame(X), "legs": legs(X)} for X in (platform(0, 0, 0, 0, 0, 0), *some)]}
