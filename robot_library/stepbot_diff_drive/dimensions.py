"""Dimensions of the differential-drive base [mm], and the poses of its links in the drawing.

x points forwards, y to the left, z up; the floor is z = 0, and the drive's axle is above the assembly's origin.
"""

from math import pi

from ..moments import Array, pose, turn

WHEEL_RADIUS, WHEEL_WIDTH = 60.0, 28.0
TRACK = 300.0
"""Distance between the middle planes of the wheels."""
CASTER_RADIUS = 22.0
CASTERS = {"caster": (-125.0, 0.0), "front_caster": (125.0, 1.5)}
"""x of the balls, and their height above the floor.

The base rests on the rear one, its centre of mass being just behind the axle. The front one catches it before it tilts
by more than a degree, when it brakes or starts backwards."""

DECK_RADIUS, DECK = 180.0, 6.0
LOWER_DECK, UPPER_DECK = 34.0, 150.0
"""Heights of the lower faces of both decks."""
WELL = (140.0, 22.0)
"""Openings of the lower deck for the wheels: length along x, and width inwards from the wheels' middle planes."""
MOTOR_RADIUS, MOTOR_LENGTH, GEAR_RADIUS, GEAR_LENGTH = 17.0, 62.0, 19.0, 24.0
LIDAR_RADIUS, LIDAR_HEIGHT, LIDAR_X = 38.0, 52.0, 0.0
BATTERY_X, COMPUTER_X = -106.0, 30.0
RAIL = 6.0
"""Height of the battery above the lower deck, on rails: the ball of the caster is below."""
SIDES = {"left": 1, "right": -1}


def base_place() -> Array:
    """X_WB of ``base_link``: the middle of the axle."""
    return pose((0, 0, WHEEL_RADIUS))


def wheel_place(side: int) -> Array:
    """X_WL of a wheel: its centre, z to the left, so that positive rotation drives forwards; x forwards."""
    return pose((0, side * TRACK / 2, WHEEL_RADIUS), turn("x", -pi / 2))


def caster_place(name: str) -> Array:
    """X_WC of a caster's ball."""
    x, height = CASTERS[name]
    return pose((x, 0, CASTER_RADIUS + height))


def camera_place() -> Array:
    """X_WK of the camera: its lens, x forwards."""
    return pose((DECK_RADIUS - 28, 0, LOWER_DECK + DECK + 62))
