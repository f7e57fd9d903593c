"""Kinematics of the delta robot in closed form [m, rad]."""

from math import acos, atan2, hypot
from typing import Any

import numpy as np

from ..moments import Array, turn
from . import dimensions as d


def arm_angle(arm: int, centre: Array) -> float:
    """Angle [rad] of an upper arm below the horizontal, elbow outwards, for the platform's centre [m] in W.

    The elbow is the intersection of a circle around the shoulder and a sphere around the wrist: (x - U cos a)^2 + y^2
    + (z - U sin a)^2 = F^2, that is x cos a + z sin a = k.

    Raises:
        ValueError: The platform is out of reach.
    """
    p = turn("z", -d.azimuth(arm)) @ (1000 * np.asarray(centre) - np.array((0.0, 0.0, d.HEIGHT)))
    x, y, z = float(p[0]) + d.WRIST_RADIUS - d.SHOULDER_RADIUS, float(p[1]), float(-p[2])
    k = (x * x + y * y + z * z + d.UPPER**2 - d.FORE**2) / (2 * d.UPPER)
    return atan2(z, x) - acos(k / hypot(x, z))


def shoulders(centre: Array) -> dict[str, float]:
    """Positions of the three shoulders [rad], 0 in the drawing, for a position of the platform's centre [m]."""
    return {f"shoulder_{arm + 1}": arm_angle(arm, centre) - d.DRAWN for arm in range(3)}


def centre_at(angles: tuple[float, float, float]) -> Array:
    """Forward kinematics: the platform's centre [m] in W for the arms' angles [rad] below the horizontal.

    The elbows, moved inwards by the platform's radius, are the centres of three spheres whose radius is the length of
    the rods. The platform's centre is the lower of their two intersections.
    """
    centres = []
    for arm, angle in enumerate(angles):
        radius = d.SHOULDER_RADIUS + d.UPPER * np.cos(angle) - d.WRIST_RADIUS
        centres.append(turn("z", d.azimuth(arm)) @ np.array((radius, 0.0, -d.UPPER * np.sin(angle))))
    a, b, c = centres
    x = (b - a) / np.linalg.norm(b - a)
    along = float(x @ (c - a))
    y = c - a - along * x
    across = float(np.linalg.norm(y))
    y /= across
    u = float(np.linalg.norm(b - a)) / 2
    v = (along**2 + across**2 - 2 * along * u) / (2 * across)
    w = float(np.sqrt(d.FORE**2 - u**2 - v**2))
    normal = np.cross(x, y)
    point: Array = a + u * x + v * y - np.sign(normal[2]) * w * normal
    return (point + np.array((0.0, 0.0, d.HEIGHT))) / 1000


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: shoulders at some places of the platform."""
    rng = np.random.default_rng(5)
    drawn = d.platform_centre() / 1000
    places = [drawn, *(drawn + np.array((0.12, 0.12, 0.06)) * rng.uniform(-1, 1, 3) for _ in range(12))]
    return {"places": [{"centre": place, "shoulders": shoulders(place)} for place in places]}
