"""Dimensions of the hexapod [mm], and the poses of its links in the drawing.

x points forwards, y to the left, z up; the floor is z = 0 and the body is above the assembly's origin. Each leg yaws
about an upright axis, and bends at hip and knee about axes across it. Zero is the leg straight out.

The servos have the outer dimensions of the 40 mm class that such robots are built with (50 x 32 x 40 mm with horns, as
Robotis' AX-12); all other dimensions are this project's own.
"""

from math import radians

from ..legs import Leg
from ..moments import Array, pose, turn

COXA, FEMUR, TIBIA = 54.0, 82.0, 130.0
"""Yaw axis to hip, hip to knee, knee to the middle of the foot."""
FOOT_RADIUS = 9.0
SERVO = (50.0, 32.0, 36.0)
SERVO_END = 12.0
"""Size of a servo, along its axis last, and from the axis to the nearer end."""
HORN, HORN_RADIUS = 2.0, 11.0
GAP = SERVO[2] + 2 * HORN
"""Between the plates that hold a servo's horns."""
PLATE, FEMUR_PLATE = 3.0, 4.0

HIP, KNEE, SWAY = -28, 102, 12
"""[degrees] Drawn positions; each tripod of legs is yawed by this angle from the middle between its neighbours."""

CORNERS = {
    "front_left": (125.0, 60.0, 45),
    "middle_left": (0.0, 100.0, 90),
    "rear_left": (-125.0, 60.0, 135),
    "front_right": (125.0, -60.0, -45),
    "middle_right": (0.0, -100.0, -90),
    "rear_right": (-125.0, -60.0, -135),
}
"""Position of each leg's yaw axis, and azimuth [degrees] of the leg."""
TRIPOD = ("front_left", "middle_right", "rear_left")
"""Legs that step together."""

LEGS = {
    name: Leg(
        name,
        pose((x, y, 0), turn("z", radians(azimuth))),
        first="z",
        hip=(COXA, 0.0, 0.0),
        upper=FEMUR,
        lower=TIBIA,
        straight=(1.0, 0.0, 0.0),
        knee=1,
    )
    for name, (x, y, azimuth) in CORNERS.items()
}


def _forwards(name: str) -> int:
    """The sign of the yaw that moves a leg's foot forwards: negative for left legs."""
    return -1 if name.endswith("left") else 1


DRAWN = {name: (_forwards(name) * (SWAY if name in TRIPOD else -SWAY), HIP, KNEE) for name in LEGS}
"""[degrees] Joint positions of each leg: yaw, hip, knee."""


def drawn(name: str) -> tuple[float, float, float]:
    """Positions of a leg's joints in the drawing [rad]."""
    yaw, hip, knee = DRAWN[name]
    return radians(yaw), radians(hip), radians(knee)


def body_place() -> Array:
    """X_WB of the body: the middle of the yaw axes, at the height at which the feet touch the floor."""
    foot = LEGS["front_left"].places(drawn("front_left"))[3]
    return pose((0, 0, FOOT_RADIUS - foot[2, 3]))
