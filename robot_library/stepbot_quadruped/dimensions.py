"""Dimensions of the quadruped [mm], and where its links lie in the drawing.

x points forwards, y to the left, z up; the floor is z = 0 and the trunk is above the assembly's origin. Each leg rolls
about an axis along x, and bends at hip and knee about axes along y, knees backwards. Zero is the straight leg.

The proportions are those of the electric dogs of 12 to 15 kg that laboratories walk with; every number is our own.
"""

from math import radians

from ..legs import Leg
from ..moments import Array, pose

HIP_X, HIP_Y = 185.0, 62.0
"""The axes of rolling, from the middle of the trunk: of their brackets, and sideways."""
HIP_OFFSET = 92.0
"""From the axis of rolling to the plane in which thigh and shank move."""
THIGH, SHANK = 210.0, 210.0
"""Hip to knee, knee to the middle of the foot."""
FOOT_RADIUS = 20.0
STANCE, STEP = 40, 14
"""[degrees] Half the angle of the knees as drawn, and how far the legs swing forwards and backwards of it."""

BODY = (236.0, 184.0, 120.0)
BODY_FLOOR = -52.0
"""Size of the body between the brackets, and height of its lower face."""
SHELL_WIDTH = 150.0
BRACKET_RADIUS, BRACKET_INSIDE, BRACKET_OUTSIDE = 44.0, 38.0, 47.0
"""Radius of the hip's drive and where it ends on both sides of the axis of rolling."""
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
"""[degrees] Positions of each leg's joints: roll, hip, knee."""


def drawn(name: str) -> tuple[float, float, float]:
    """Positions of a leg's joints in the drawing [rad]."""
    roll, hip, knee = DRAWN[name]
    return radians(roll), radians(hip), radians(knee)


def trunk_place() -> Array:
    """X_WB of the trunk: between the axes of rolling, as high as lets the feet stand on the floor."""
    foot = LEGS["front_left"].places(drawn("front_left"))[3]
    return pose((0, 0, FOOT_RADIUS - foot[2, 3]))
