"""Dimensions of the quadruped [mm], and the poses of its links in the drawing.

x points forwards, y to the left, z up; the floor is z = 0 and the trunk is above the assembly's origin. Each leg rolls
about an axis along x, and bends at hip and knee about axes along y, knees backwards. Zero is the straight leg.

The proportions are those of electric research quadrupeds of 12 to 15 kg; all dimensions are this project's own.
"""

from math import radians

from ..legs import Leg
from ..moments import Array, pose

HIP_X, HIP_Y = 185.0, 62.0
"""The roll axes, from the centre of the trunk: of their brackets, and sideways."""
HIP_OFFSET = 92.0
"""From the roll axis to the plane in which thigh and shank move."""
THIGH, SHANK = 210.0, 210.0
"""Hip to knee, knee to the middle of the foot."""
FOOT_RADIUS = 20.0
STANCE, STEP = 40, 14
"""[degrees] Half the knee angle as drawn, and the swing of the legs forwards and backwards from it."""

BODY = (236.0, 184.0, 120.0)
BODY_FLOOR = -52.0
"""Size of the body between the brackets, and height of its lower face."""
SHELL_WIDTH = 150.0
BRACKET_RADIUS, BRACKET_INSIDE, BRACKET_OUTSIDE = 44.0, 38.0, 47.0
"""Radius of the hip's drive, and its ends on both sides of the roll axis."""
BLADE, SLOT, SHIN = 28.0, 19.0, 17.0
"""Thickness of the thigh, of the slot in it at the knee, and of the shank."""
KNEE_PIN = 6.0

CORNERS = {"front_left": (1, 1), "front_right": (1, -1), "rear_left": (-1, 1), "rear_right": (-1, -1)}
"""Signs of x and y."""
FORWARD = ("front_left", "rear_right")
"""Legs whose feet are ahead: as in a trot, those of a diagonal."""

LEGS = {
    name: Leg(
        name,
        pose((front * HIP_X, left * HIP_Y, 0)),
        first="x",
        hip=(0.0, left * HIP_OFFSET, 0.0),
        upper=THIGH,
        lower=SHANK,
        straight=(0.0, 0.0, -1.0),
        knee=-1,
    )
    for name, (front, left) in CORNERS.items()
}
DRAWN = {name: (0, STANCE - STEP if name in FORWARD else STANCE + STEP, -2 * STANCE) for name in LEGS}
"""[degrees] Joint positions of each leg: roll, hip, knee."""


def drawn(name: str) -> tuple[float, float, float]:
    """Positions of a leg's joints in the drawing [rad]."""
    roll, hip, knee = DRAWN[name]
    return radians(roll), radians(hip), radians(knee)


def trunk_place() -> Array:
    """X_WB of the trunk: between the roll axes, at the height at which the feet touch the floor."""
    foot = LEGS["front_left"].places(drawn("front_left"))[3]
    return pose((0, 0, FOOT_RADIUS - foot[2, 3]))
