r"""Dimensions of the slider-crank [mm], the poses of its parts, and the equations of its motion.

Seen along +y, x to the right and z up: the shaft turns in a pedestal, the piston slides along +x
in a cylinder that is cut open towards the viewer. ::

         A
        / ``--..__  rod
       / a        ``--..
      O ................ P ->

O is the axis of the shaft, A the crank pin, P the piston pin.
"""

from math import asin, cos, radians, sin, sqrt

from ..moments import Array, pose, turn

THROW, ROD = 30.0, 100.0
"""O to A and A to P."""
CRANK_DRAWN = radians(60)
"""Angle a of the crank in the drawing, counter-clockwise from +x."""
HEIGHT = 92.0
"""Of O and P above the floor."""

BASE = (300.0, 150.0, 12.0)
BASE_CENTRE = (40.0, 22.0)
ROD_PLATE, ROD_GAP = 10.0, 1.0
"""Thickness of the rod, whose middle plane is y = 0, and the gap between it and the web."""
PIN_RADIUS, BORE_RADIUS = 6.0, 6.05
BIG_END, SMALL_END = 15.0, 9.5
WEB, WEB_RADIUS = 14.0, 42.0
SHAFT_RADIUS, SHAFT_BORE = 10.0, 10.05
PEDESTAL = (64.0, 34.0)
"""Along x and y; the pedestal is behind the web, with a gap of 2 mm."""
FLYWHEEL_RADIUS, FLYWHEEL = 62.0, 16.0
PISTON_RADIUS, LINER_BORE, LINER_RADIUS = 20.0, 20.05, 27.0
PISTON_SKIRT, PISTON_CROWN = 13.0, 17.0
"""Extent of the piston from its pin towards the shaft and away from it."""
LINER = (60.0, 152.0)
"""Ends of the cylinder along x."""

WEB_FRONT = ROD_PLATE / 2 + ROD_GAP
PEDESTAL_FRONT = WEB_FRONT + WEB + 2.0
FLYWHEEL_FRONT = PEDESTAL_FRONT + PEDESTAL[1] + 2.0


def rod_angle(crank: float) -> float:
    """Angle [rad] of the rod from +x, for the angle of the crank."""
    return -asin(THROW * sin(crank) / ROD)


def piston_place(crank: float) -> float:
    """Distance [mm] of the piston's pin from the shaft's axis."""
    return THROW * cos(crank) + sqrt(ROD**2 - (THROW * sin(crank)) ** 2)


def upright(x: float, z: float, angle: float) -> Array:
    """A frame at (x, 0, z) [mm] from the shaft, z towards the viewer, rotated counter-clockwise by an angle [rad]."""
    return pose((x, 0.0, HEIGHT + z), turn("x", radians(90)) @ turn("z", angle))


def crank_place() -> Array:
    """X_WC: the origin on the shaft's axis in the rod's plane, x towards the crank pin."""
    return upright(0.0, 0.0, CRANK_DRAWN)


def rod_place() -> Array:
    """X_WR: the origin at the crank pin, x towards the piston pin."""
    return upright(THROW * cos(CRANK_DRAWN), THROW * sin(CRANK_DRAWN), rod_angle(CRANK_DRAWN))


def piston_frame() -> Array:
    """X_WP: the origin at the piston pin, x along the cylinder."""
    return upright(piston_place(CRANK_DRAWN), 0.0, 0.0)
