"""Kinematics of the upper body's arms in closed form [m, rad].

An arm has seven joints, one more than a pose of the hand requires: the elbow can move on a circle about the line from
shoulder to wrist. The angle on that circle is the swivel, 0 at the lowest position of the elbow.
"""

from dataclasses import dataclass
from math import acos, asin, atan2, cos, radians, sin
from typing import Any

import numpy as np

from ..expected import frame
from ..moments import Array, pose, turn
from . import dimensions as d

UPPER, FORE, PALM = d.UPPER / 1000, d.FORE / 1000, d.PALM / 1000
_LOW = (-2.9, -0.2, -1.5, -2.3, -1.5, -0.75, -0.6)
_HIGH = (1.0, 1.4, 1.5, -0.1, 1.5, 0.75, 0.6)


@dataclass(frozen=True)
class Arm:
    """Joint positions of an arm [rad]."""

    shoulder_pitch: float
    shoulder_roll: float
    shoulder_yaw: float
    elbow: float
    wrist_yaw: float
    wrist_pitch: float
    wrist_roll: float


def shoulder(side: str) -> Array:
    """The point of the shoulder's axes in the torso, shape (3,)."""
    return np.array((0.0, d.SIDES[side] * d.SHOULDER_Y, d.SHOULDER_Z)) / 1000


def palm(side: str, q: Arm) -> Array:
    """X_TP of the middle of the palm in the torso, shape (4, 4) [m]; -z along the fingers."""
    R_TU = turn("y", q.shoulder_pitch) @ turn("x", q.shoulder_roll) @ turn("z", q.shoulder_yaw)
    R_TF = R_TU @ turn("y", q.elbow)
    R_TH = R_TF @ turn("z", q.wrist_yaw) @ turn("y", q.wrist_pitch) @ turn("x", q.wrist_roll)
    return pose(shoulder(side) - UPPER * R_TU[:, 2] - FORE * R_TF[:, 2] - PALM * R_TH[:, 2], R_TH)


def swivel(q: Arm) -> float:
    """Angle of the elbow on its circle [rad]."""
    R_TU = turn("y", q.shoulder_pitch) @ turn("x", q.shoulder_roll) @ turn("z", q.shoulder_yaw)
    elbow = -UPPER * R_TU[:, 2]
    _, lowest, aside = _circle(elbow - FORE * (R_TU @ turn("y", q.elbow))[:, 2])
    return atan2(float(aside @ elbow), float(lowest @ elbow))


def reaching(side: str, X_TP: Array, angle: float) -> Arm:
    """Inverse kinematics for a pose of the palm in the torso [m] and a swivel of the elbow [rad].

    The solution with less than a quarter turn of abduction and of bending at the wrist.

    Raises:
        ValueError: The pose is out of reach.
    """
    R_TH = X_TP[:3, :3]
    wrist = X_TP[:3, 3] + PALM * R_TH[:, 2] - shoulder(side)
    distance = float(np.linalg.norm(wrist))
    bent = -acos((distance**2 - UPPER**2 - FORE**2) / (2 * UPPER * FORE))
    # In the triangle of shoulder, elbow and wrist: along the line between shoulder and wrist, and perpendicular to it.
    along = (distance**2 + UPPER**2 - FORE**2) / (2 * distance)
    away = UPPER * sin(acos(along / UPPER))
    line, lowest, aside = _circle(wrist)
    elbow = along * line + away * (cos(angle) * lowest + sin(angle) * aside)

    z = -elbow / UPPER
    x = (wrist - elbow) - z * float(z @ (wrist - elbow))
    x /= np.linalg.norm(x)
    R_TU = np.column_stack((x, np.cross(z, x), z))
    R_FH = turn("y", bent).T @ R_TU.T @ R_TH
    return Arm(
        shoulder_pitch=atan2(R_TU[0, 2], R_TU[2, 2]),
        shoulder_roll=-asin(R_TU[1, 2]),
        shoulder_yaw=atan2(R_TU[1, 0], R_TU[1, 1]),
        elbow=bent,
        wrist_yaw=atan2(R_FH[1, 0], R_FH[0, 0]),
        wrist_pitch=-asin(R_FH[2, 0]),
        wrist_roll=atan2(R_FH[2, 1], R_FH[2, 2]),
    )


def _circle(wrist: Array) -> tuple[Array, Array, Array]:
    """Unit vectors: from shoulder to wrist, from that line to the lowest position of the elbow, and across both."""
    line = wrist / np.linalg.norm(wrist)
    lowest = np.array((0.0, 0.0, -1.0)) + line[2] * line
    lowest /= np.linalg.norm(lowest)
    return line, lowest, np.cross(line, lowest)


def random_arm(side: str, rng: np.random.Generator) -> Arm:
    """Positions within the limits of the sidecar; the right arm's are those of the left one, mirrored."""
    q = np.array(_LOW) + (np.array(_HIGH) - np.array(_LOW)) * rng.random(7)
    mirrored = np.array((1, d.SIDES[side], d.SIDES[side], 1, d.SIDES[side], 1, d.SIDES[side]))
    return Arm(*(mirrored * q).tolist())


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints: palms and eyes at some positions of the joints."""
    rng = np.random.default_rng(17)
    arms = {side: Arm(*(radians(value) for value in d.ARMS[side])) for side in d.SIDES}
    motions = [_motion({name: radians(value) for name, value in d.BODY.items()}, arms, d.CLOSED)]
    for _ in range(20):
        turned = dict(zip(d.BODY, rng.uniform((-1.3, -1.3, -0.5), (1.3, 1.3, 0.7)).tolist(), strict=True))
        motions.append(_motion(turned, {side: random_arm(side, rng) for side in d.SIDES}, {"left": 20, "right": 20}))
    return {"motions": motions}


def _motion(body: dict[str, float], arms: dict[str, Arm], fingers: dict[str, int]) -> dict[str, Any]:
    X_WT = pose((0, 0, d.WAIST_Z / 1000), turn("z", body["waist_yaw"]))
    X_TH = pose((0, 0, d.NECK_Z / 1000), turn("z", body["neck_yaw"])) @ pose(
        (0, 0, d.NOD_Z / 1000), turn("y", body["neck_pitch"])
    )
    q = dict(body)
    frames = {"eyes": frame(X_WT @ X_TH @ pose(np.array(d.EYES) / 1000))}
    for side, arm in arms.items():
        q |= {f"{side}_{joint}": value for joint, value in vars(arm).items()}
        q[f"{side}_grip"] = radians(fingers[side])
        q[f"{side}_thumb_grip"] = d.GRIP * radians(fingers[side])
        frames[f"{side}_palm"] = frame(X_WT @ palm(side, arm))
    return {"joints": q, "frames": frames}
