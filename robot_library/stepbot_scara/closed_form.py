"""Forward and inverse kinematics of the SCARA in closed form [m, rad]."""

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, pi, sin
from typing import Any

import numpy as np

from ..expected import frame
from ..moments import Array, pose, turn
from . import dimensions as d

UPPER, FORE, TOOL_HEIGHT = d.UPPER / 1000, d.FORE / 1000, d.TOOL_HEIGHT / 1000
LEAD = d.PITCH / 1000 / (2 * pi)
"""Advance of the quill [m/rad]."""


@dataclass(frozen=True)
class Positions:
    """Joint positions [rad]; the screw's is the angle of its nut."""

    shoulder: float
    elbow: float
    quill: float
    wrist: float


def tool(q: Positions) -> Array:
    """X_WT of the flange's face, shape (4, 4) [m]: z down; quill and wrist turn about it, opposite to the arm."""
    heading = q.shoulder + q.elbow
    place = (
        UPPER * cos(q.shoulder) + FORE * cos(heading),
        UPPER * sin(q.shoulder) + FORE * sin(heading),
        TOOL_HEIGHT - LEAD * q.quill,
    )
    return pose(place, turn("z", heading - q.quill - q.wrist) @ turn("x", pi))


def inverse(place: tuple[float, float, float], yaw: float, elbow_left: bool) -> Positions:
    """Inverse kinematics for a flange position [m] with its x axis at an angle ``yaw`` [rad].

    Raises:
        ValueError: The pose is out of reach.
    """
    x, y, z = place
    cosine = (x * x + y * y - UPPER**2 - FORE**2) / (2 * UPPER * FORE)
    elbow = acos(cosine) * (-1 if elbow_left else 1)
    shoulder = atan2(y, x) - atan2(FORE * sin(elbow), UPPER + FORE * cos(elbow))
    quill = (TOOL_HEIGHT - z) / LEAD
    return Positions(shoulder, elbow, quill, shoulder + elbow - yaw - quill)


def reach() -> tuple[float, float]:
    """Least and greatest distance [m] of the quill from the shoulder, for the elbow's limit of 145 degrees."""
    folded = hypot(UPPER + FORE * cos(145 * pi / 180), FORE * sin(145 * pi / 180))
    return folded, UPPER + FORE


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: the tool at some positions of the joints."""
    rng = np.random.default_rng(7)
    drawn = Positions(d.SHOULDER_DRAWN, d.ELBOW_DRAWN, 0.0, 0.0)
    low, high = np.array((-2.3, -2.5, 0.0, -3.1)), np.array((2.3, 2.5, d.STROKE / 1000 / LEAD, 3.1))
    some = [Positions(*(low + (high - low) * rng.random(4)).tolist()) for _ in range(20)]
    return {
        "drawn": vars(drawn),
        "lead": LEAD,
        "reach": list(reach()),
        "tool": [{"joints": vars(q), "pose": frame(tool(q))} for q in (drawn, *some)],
    }
