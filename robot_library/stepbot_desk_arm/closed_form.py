"""Kinematics of the desk arm in closed form [m, rad]."""

from dataclasses import asdict, dataclass
from math import asin, atan2, cos, hypot, radians, sin
from typing import Any

import numpy as np

from ..expected import frame
from ..moments import Array, pose, turn
from . import dimensions as d

SHOULDER_X, SHOULDER_Z = d.SHOULDER_X / 1000, d.SHOULDER_Z / 1000
UPPER, FORE, HAND = d.UPPER / 1000, d.FORE / 1000, (d.WRIST + d.TIP) / 1000


@dataclass(frozen=True)
class Positions:
    """Joint positions [rad]."""

    shoulder_pan: float
    shoulder_lift: float
    elbow_flex: float
    wrist_flex: float
    wrist_roll: float


def tip(q: Positions) -> Array:
    """X_WT of the point between the ends of the jaws, shape (4, 4) [m]; x points out of the gripper.

    Angles in the side view add up: that of the upper arm from the vertical, those of forearm and gripper from the
    horizontal, downwards.
    """
    upper = q.shoulder_lift
    fore = upper + q.elbow_flex
    hand = fore + q.wrist_flex
    reach = SHOULDER_X + UPPER * sin(upper) + FORE * cos(fore) + HAND * cos(hand)
    height = SHOULDER_Z + UPPER * cos(upper) - FORE * sin(fore) - HAND * sin(hand)
    place = (reach * cos(q.shoulder_pan), reach * sin(q.shoulder_pan), height)
    return pose(place, turn("z", q.shoulder_pan) @ turn("y", hand) @ turn("x", q.wrist_roll))


def reaching(place: Array, pitch: float, roll: float) -> Positions:
    """Inverse kinematics for a tip position [m] in front of the base, pitched downwards and rolled [rad].

    The elbow is bent by less than a quarter turn from the right angle of its zero.

    Raises:
        ValueError: The pose is out of reach.
    """
    x, y, z = (float(value) for value in place)
    out = hypot(x, y) - SHOULDER_X - HAND * cos(pitch)
    up = z - SHOULDER_Z + HAND * sin(pitch)
    elbow = asin((UPPER**2 + FORE**2 - out**2 - up**2) / (2 * UPPER * FORE))
    turned = atan2(out, up) - atan2(FORE * cos(elbow), UPPER - FORE * sin(elbow))
    lift = atan2(sin(turned), cos(turned))
    return Positions(atan2(y, x), lift, elbow, pitch - lift - elbow, roll)


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: the tip at some positions of the joints."""
    rng = np.random.default_rng(9)
    drawn = {name: radians(value) for name, value in d.DRAWN.items()}
    low, high = np.array((-1.9, -1.7, -1.5, -1.6, -2.7, 0.0)), np.array((1.9, 1.7, 1.5, 1.6, 2.7, 1.7))
    some = [dict(zip(d.JOINTS, (low + (high - low) * rng.random(6)).tolist(), strict=True)) for _ in range(20)]
    return {"motions": [{"joints": q, "frames": {"tip": frame(tip(arm_of(q)))}} for q in (drawn, *some)]}


def arm_of(q: dict[str, float]) -> Positions:
    """The positions of the arm among those of all joints."""
    return Positions(**{name: value for name, value in q.items() if name in asdict(Positions(0, 0, 0, 0, 0))})
