"""Dimensions of the humanoid upper body [mm], and the poses of its links in the drawing.

x points forwards, y to the left, z up; the origin is on the floor, below the axis of the waist. Zero is upright, arms
and hands hanging straight down, the axes of all links along those of the base.

The three axes of each shoulder meet in a point, and so do those of each wrist. The proportions are those of an adult
of about 1.6 m; all dimensions are this project's own.
"""

from math import radians

from ..moments import Array, pose, turn

WAIST_Z = 170.0
"""Height above the floor of the face that carries the torso."""
NECK_Z, NOD_Z = 452.0, 58.0
"""Height above the waist of the face that carries the neck; height above that of the nodding axis."""
EYES = (104.0, 0.0, 114.0)
"""In the frame of the head."""
SHOULDER_Y, SHOULDER_Z = 217.0, 372.0
"""Intersection of the shoulder's axes, in the frame of the torso."""
UPPER, FORE, PALM = 280.0, 250.0, 76.0
"""Shoulder to elbow, elbow to wrist, wrist to the middle of the palm."""
KNUCKLES, THUMB = -122.0, (36.0, 0.0, -64.0)
"""Heights of the fingers' axis and place of the thumb's, in the frame of the hand."""

ROLL_HALF, ELBOW_HALF = 47.0, 29.0
"""Half the lengths of the drives of the shoulder's roll and of the elbow."""
FORK = 12.0
"""Thickness of the shoulder's fork."""
FINGERS_X = (-27.0, -9.0, 9.0, 27.0)
"""Of the fingers along their axis."""

SIDES = {"left": 1, "right": -1}
BODY = {"waist_yaw": 10, "neck_yaw": -14, "neck_pitch": 6}
"""[degrees] Joint positions in the drawing."""
SHOULDER = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw")
WRIST = ("wrist_yaw", "wrist_pitch", "wrist_roll")
ARM = (*SHOULDER, "elbow", *WRIST)
ARMS = {"left": (-22, 14, 10, -72, -20, 0, 0), "right": (-12, -72, -84, -88, 12, 0, -14)}
"""[degrees] In the order of ``ARM``: the left forearm is level, the right hand waves."""
CLOSED = {"left": 34, "right": 8}
"""[degrees] Closing angle of the fingers; the thumb follows by half of it."""
GRIP = 0.5


def arm_frames(side: str, q: tuple[float, ...]) -> dict[str, Array]:
    """X_TL of the links of an arm in the torso, at positions [rad] in the order of ``ARM``."""
    pitch, roll, yaw, elbow, wrist_yaw, wrist_pitch, wrist_roll = q
    steps = {
        "shoulder": pose((0, SIDES[side] * SHOULDER_Y, SHOULDER_Z), turn("y", pitch)),
        "shoulder_fork": pose(rotation=turn("x", roll)),
        "upper_arm": pose(rotation=turn("z", yaw)),
        "forearm": pose((0, 0, -UPPER), turn("y", elbow)),
        "wrist": pose((0, 0, -FORE), turn("z", wrist_yaw)),
        "wrist_cross": pose(rotation=turn("y", wrist_pitch)),
        "hand": pose(rotation=turn("x", wrist_roll)),
    }
    found, X = {}, pose()
    for name, step in steps.items():
        X = X @ step
        found[name] = X
    return found


def places() -> dict[str, Array]:
    """X_WL of every link in the drawing."""
    body = {name: radians(value) for name, value in BODY.items()}
    X_WT = pose((0, 0, WAIST_Z), turn("z", body["waist_yaw"]))
    X_WN = X_WT @ pose((0, 0, NECK_Z), turn("z", body["neck_yaw"]))
    found = {"base": pose(), "torso": X_WT, "neck": X_WN}
    found["head"] = X_WN @ pose((0, 0, NOD_Z), turn("y", body["neck_pitch"]))
    for side, inwards in SIDES.items():
        frames = arm_frames(side, tuple(radians(value) for value in ARMS[side]))
        found |= {f"{side}_{name}": X_WT @ X for name, X in frames.items()}
        closed = -inwards * radians(CLOSED[side])
        X_WH = found[f"{side}_hand"]
        found[f"{side}_fingers"] = X_WH @ pose((0, 0, KNUCKLES), turn("x", closed))
        found[f"{side}_thumb"] = X_WH @ pose(THUMB, turn("x", GRIP * closed))
    return found
