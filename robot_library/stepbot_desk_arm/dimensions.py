"""Dimensions of the desk arm [mm], and the poses of its links in the drawing.

x points forwards, y to the left, z up; the origin is on the desk, on the axis of the pan. Zero is the upper arm upright
with forearm and gripper level in front of it, the gripper closed.

An arm of the size of TheRobotStudio's SO-101: five joints and a gripper, six bus servos in printed parts. The servo is
Feetech's STS3215 (45.2 x 24.7 x 35 mm and 55 g in its data sheet; the position of its axis is measured in pictures).
Upper arm and forearm are about as long as the SO-101's, 116 and 135 mm; all other dimensions are this project's own.
"""

from math import radians

from ..moments import Array, pose, turn

SHOULDER_X, SHOULDER_Z = 20.0, 106.0
"""The axis of the lift, ahead of the pan's and above the desk."""
UPPER, FORE = 116.0, 135.0
"""Lift to elbow, elbow to wrist."""
WRIST = 64.0
"""From the wrist's axis to the face of the horn of the roll servo."""
TIP = 98.0
"""From there to the middle between the ends of the jaws."""

SERVO = (45.2, 24.7, 31.0)
"""Size of a servo along its longer side, across, and along its axis without horns."""
SERVO_END, HORN, HORN_RADIUS = 10.4, 2.0, 10.0
PLATE = 4.0
"""Thickness of the printed plates on the horns."""
PAN_FLOOR = 14.0
"""Height of the pan servo's lower face."""
JAW_X, JAW_Y = 30.0, 14.0
"""The jaw's axis in the frame of the gripper."""

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
DRAWN = {"shoulder_pan": 0, "shoulder_lift": -22, "elbow_flex": 38, "wrist_flex": 38, "wrist_roll": 0, "gripper": 32}
"""[degrees] Joint positions in the drawing."""

HALF = SERVO[2] / 2
"""From the middle of a servo to its faces."""
GAP = HALF + HORN
"""From there to the faces of its horns, on which plates lie."""


def places() -> dict[str, Array]:
    """X_WL of every link in the drawing."""
    q = {name: radians(value) for name, value in DRAWN.items()}
    X_WS = pose((0, 0, pan_height()), turn("z", q["shoulder_pan"]))
    X_WU = X_WS @ pose((SHOULDER_X, 0, SHOULDER_Z - pan_height()), turn("y", q["shoulder_lift"]))
    X_WF = X_WU @ pose((0, 0, UPPER), turn("y", q["elbow_flex"]))
    X_WH = X_WF @ pose((FORE, 0, 0), turn("y", q["wrist_flex"]))
    X_WG = X_WH @ pose((WRIST, 0, 0), turn("x", q["wrist_roll"]))
    return {
        "base": pose(),
        "shoulder": X_WS,
        "upper_arm": X_WU,
        "forearm": X_WF,
        "wrist": X_WH,
        "gripper_body": X_WG,
        "jaw": X_WG @ pose((JAW_X, JAW_Y, 0), turn("z", q["gripper"])),
    }


def pan_height() -> float:
    """Of the face of the pan's horn, above the desk."""
    return PAN_FLOOR + SERVO[2] + HORN
