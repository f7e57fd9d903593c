r"""Dimensions of the four-bar linkage [mm], the poses of its parts, and the equation that closes the loop.

Four bars in one vertical plane, x to the right and z up, seen along +y. The bars are in three layers, from the back to
the front: the ground bar, then crank and rocker side by side, then the coupler. Pins point to the front, each in the
bore of the next layer. ::

             __.B
      A.---""   \
     /           \
    O2 ......... O4

O2 and O4 are the pins of the ground bar that carry crank and rocker, A and B those of crank and rocker in the coupler.
"""

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, pi, radians, sin
from typing import Literal

from ..moments import Array, pose, turn

GROUND, CRANK, COUPLER, ROCKER = 160.0, 60.0, 150.0, 120.0
"""Pin to pin. Grashof: crank + ground < coupler + rocker, and the crank is the shortest, so it makes full turns."""
CRANK_ANGLE = radians(60)
"""Of the drawing, counter-clockwise from the ground bar."""

PLATE, HUB, GAP = 6.0, 2.0, 1.0
LAYER = PLATE + HUB
"""Thickness of a bar at its hubs; GAP is the distance between two layers, bridged by a spacer on each pin."""
BAR_RADIUS, HUB_RADIUS, SPACER_RADIUS, BORE_RADIUS, PIN_RADIUS = 13.0, 11.0, 9.0, 6.05, 6.0
TIP = 0.5
"""Chamfer at the end of each pin, and its length beyond the bore: half the gap to the next layer."""

HEIGHT = 120.0
"""Of O2 and O4 above the floor."""
BASE = (240.0, 110.0, 10.0)
BASE_CENTRE = (80.0, 5.0)
BOLT_RADIUS, BOLT_INSET = 4.5, 14.0
"""Holes in the corners of the base, and their distance from its edges."""
PILLAR = (24.0, 16.0, 122.0)

End = Literal["pin", "bore"]


@dataclass(frozen=True)
class Slot:
    """An opening along the middle of a bar; ``start`` and ``length`` are those of its centre line."""

    start: float
    length: float
    radius: float


@dataclass(frozen=True)
class Bar:
    """A bar with round ends: its frame has the first end at the origin, x along the bar, z towards the viewer."""

    name: str
    length: float
    ends: tuple[End, End]
    slot: Slot
    layer: int
    color: str


GROUND_BAR = Bar("ground bar", GROUND, ("pin", "pin"), Slot(40.0, 80.0, 6.0), 0, "#4a5058")
CRANK_BAR = Bar("crank", CRANK, ("bore", "pin"), Slot(24.0, 12.0, 4.0), 1, "#d1495b")
COUPLER_BAR = Bar("coupler", COUPLER, ("bore", "bore"), Slot(35.0, 80.0, 6.0), 2, "#2a9d8f")
ROCKER_BAR = Bar("rocker", ROCKER, ("bore", "pin"), Slot(30.0, 60.0, 6.0), 1, "#edae49")
BARS = (GROUND_BAR, CRANK_BAR, COUPLER_BAR, ROCKER_BAR)


@dataclass(frozen=True)
class Closed:
    """Angles [rad] of the closed linkage, counter-clockwise from the ground bar."""

    crank: float
    coupler: float
    rocker: float


def closed(crank: float) -> Closed:
    """The linkage at a crank angle [rad], on the branch on which O2 A B O4 do not cross.

    By the law of cosines in the triangle A B O4, whose side A O4 follows from the crank angle (Norton, "Design of
    Machinery", position analysis of the four-bar).
    """
    ax, az = CRANK * cos(crank), CRANK * sin(crank)
    diagonal = hypot(ax - GROUND, az)
    towards_a = atan2(az, ax - GROUND) % (2 * pi)
    at_o4 = acos((diagonal**2 + ROCKER**2 - COUPLER**2) / (2 * diagonal * ROCKER))
    rocker = towards_a - at_o4
    coupler = atan2(ROCKER * sin(rocker) - az, GROUND + ROCKER * cos(rocker) - ax)
    return Closed(crank, coupler, rocker)


def start(bar: Bar) -> tuple[float, float, float]:
    """The angle [rad] of a bar in the drawing and the position (x, z) of its first end."""
    drawn = closed(CRANK_ANGLE)
    return {
        "ground bar": (0.0, 0.0, HEIGHT),
        "crank": (drawn.crank, 0.0, HEIGHT),
        "coupler": (drawn.coupler, CRANK * cos(drawn.crank), HEIGHT + CRANK * sin(drawn.crank)),
        "rocker": (drawn.rocker, GROUND, HEIGHT),
    }[bar.name]


def placed(bar: Bar) -> Array:
    """X_WB of a bar in the drawing, shape (4, 4) [mm]."""
    angle, x, z = start(bar)
    return pose((x, -bar.layer * (LAYER + GAP), z), turn("x", pi / 2) @ turn("z", angle))


def pillar_places() -> tuple[Array, ...]:
    """X_WP of both pillars, whose frame is the middle of the foot; they stand behind the ground bar."""
    return tuple(pose((x, PILLAR[1] / 2, BASE[2])) for x in (0.0, GROUND))


def base_place() -> Array:
    """X_WP of the base, whose frame is the middle of its lower face."""
    return pose((*BASE_CENTRE, 0.0))


def bolt_places() -> tuple[tuple[float, float], ...]:
    """Centres (x, y) of the holes in the base, in its frame."""
    x, y = BASE[0] / 2 - BOLT_INSET, BASE[1] / 2 - BOLT_INSET
    return ((x, y), (-x, y), (-x, -y), (x, -y))
