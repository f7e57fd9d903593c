"""Odometry of the differential drive in closed form [m, rad], for wheels that roll without slip."""

from math import cos, sin
from typing import Any

from . import dimensions as d

RADIUS, TRACK = d.WHEEL_RADIUS / 1000, d.TRACK / 1000


def twist(left: float, right: float) -> tuple[float, float]:
    """Forward speed [m/s] and yaw rate [rad/s], positive to the left, of the base at wheel speeds [rad/s]."""
    return RADIUS * (left + right) / 2, RADIUS * (right - left) / TRACK


def wheels(forwards: float, turning: float) -> tuple[float, float]:
    """Wheel speeds [rad/s], left and right, for a forward speed [m/s] and a yaw rate [rad/s], positive to the left."""
    return (forwards - turning * TRACK / 2) / RADIUS, (forwards + turning * TRACK / 2) / RADIUS


def place(left: float, right: float, time: float) -> tuple[float, float, float]:
    """x, y [m] and heading [rad] of the axle's middle after a time [s] at constant wheel speeds."""
    forwards, turning = twist(left, right)
    heading = turning * time
    if abs(heading) < 1e-9:
        return forwards * time, 0.0, heading
    return forwards / turning * sin(heading), forwards / turning * (1 - cos(heading)), heading


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: paths over the floor."""
    drives = ((2.0, 2.0), (-2.0, -2.0), (2.0, 3.0), (-1.5, 1.5))
    return {
        "wheel_radius": RADIUS,
        "track": TRACK,
        "drives": [{"left": a, "right": b, "time": 2.0, "place": list(place(a, b, 2.0))} for a, b in drives],
    }
