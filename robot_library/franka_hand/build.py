"""Draw the Franka Hand: ``python -m robot_library.franka_hand.build`` in the root of the checkout.

Writes hand.step beside this file; every run gives the same bytes. Joint origins come from expected.json. The
dimensions below are those of the shells around them; letters in brackets name their sources:

[C] The collision boxes of the fingers in the maker's description, edge by edge.
[F] Mounting flange to ISO 9409-1-50-4-M6: 63 mm across, four M6 on 50 mm.
[T] Height of the fingers' rail and of the fingertips: 58.4 mm and 58.4 + 53.8 mm, from the joint origins and [C].
[E] Estimated from photographs, to about 2 mm; the width of 204 mm and the depth of 63 mm are the maker's.
"""

from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..shapes import ALUMINIUM, BLACK, DARK, STEEL, WHITE, at, cylinder, flange, on_circle, rod, screw

WIDTH, DEPTH, TOP = 204.0, 63.0, 65.8
SLOT = 23.0
"""Width of the rail's opening: the fingers' 22 mm [C] and their clearance."""
SECTIONS = (
    (6.0, DEPTH, DEPTH + 2),
    (14.0, DEPTH, 72),
    (24.0, 58, 100),
    (33.0, 53, 160),
    (42.0, 50, 194),
    (52.0, 48, 203),
    (TOP, 47, WIDTH),
)
"""Height, depth and width of sections of the housing [E]."""
RAIL = 58.4
"""Height of the fingers' origin over the flange [T]."""


def body() -> list[Body]:
    """The housing, a loft from the round neck to the wide rail, with flange, rail and connector."""
    shell = bd.loft([_level(*section) for section in SECTIONS])
    shell = bd.fillet(shell.edges().filter_by(lambda edge: abs(edge.center().Z - TOP) < 0.1), 3)
    slot = at(bd.extrude(bd.RectangleRounded(SLOT + 3, 180, 8), 20), (0, 0, RAIL - 1.2))
    channel = bd.extrude(bd.RectangleRounded(SLOT + 2.8, 179.8, 7.9), 5.5)
    channel -= at(bd.extrude(bd.RectangleRounded(SLOT, 176, 6.5), 20), (0, 0, 0.8))
    guides = [rod((x, -86, RAIL + 1.4), (x, 86, RAIL + 1.4), 1.4) for x in (-7.0, 7.0)]
    plate = flange(31.5, 6, on_circle(4, 50, 45), 3.3)  # [F]
    socket = at(cylinder(13, 30), (0, -58, 20), (90, 0, 0))
    plug = rod((0, -30, 20), (0, -66, 20), 7.5)
    nut = bd.fillet(rod((0, -54, 20), (0, -63, 20), 9.5).edges(), 0.8) - plug
    return [
        Body("flange", plate, ALUMINIUM),
        Body("housing", shell - at(cylinder(40, 6)) - slot - plug - socket, WHITE),
        Body("channel", at(channel, (0, 0, RAIL - 1.2)), DARK),
        *(Body("guide", guide, STEEL) for guide in guides),
        Body("plug", plug, BLACK),
        Body("nut", nut, STEEL),
    ]


def _level(z: float, depth: float, width: float) -> bd.Face:
    """A section of the housing at a height: a rectangle in x and y with round ends."""
    return (bd.Pos(0, 0, z) * bd.RectangleRounded(depth, width, depth / 2 - 0.1)).face()


def finger() -> list[Body]:
    """A finger in its own frame: y points outwards, the pad touches y = 0 [C]."""
    carriage = bd.Polygon(
        (2.4, 0.3), (11.2, 0.3), (11.2, 1), (26, 1), (26, 21), (11, 21), (11, 4.1), (2.4, 4.1), align=None
    )
    carriage = bd.fillet(carriage.vertices().filter_by(lambda v: v.Y > 20), 2)
    # The diagonal leans by 30 degrees from the screw mount to the tip.
    arm = bd.Polygon((13.5, 18), (24, 18), (15.2, 35.5), (15.2, 54.5), (2.2, 54.5), (2.2, 36), (6.5, 34), align=None)
    arm = bd.fillet(arm.vertices().filter_by(lambda v: v.X > 14 and v.Y > 30), 3)
    body = _thick(carriage, 22) + bd.fillet(_thick(arm, 17.5).edges().filter_by(bd.Axis.Z), 1)
    body -= _thick(bd.Rectangle(8, 6).moved(bd.Location((14.5, 10))), 12)
    pad = bd.fillet(at(bd.Box(17.5, 2.2, 18.5), (0, 1.1, 45.25)).edges().filter_by(bd.Axis.Y), 2)
    for groove in range(5):
        pad -= at(bd.Box(17.5, 0.8, 1), (0, 0.4, 38.9 + 3.2 * groove))
    screws = [at(screw(4), (x, 26, 11), (-90, 0, 0)) for x in (-6.0, 6.0)]
    return [Body("finger", body, ALUMINIUM), Body("pad", pad, BLACK), *(Body("screw", head, STEEL) for head in screws)]


def _thick(profile: bd.Sketch, width: float) -> bd.Part:
    """A profile in (y, z), extruded along x by ``width``, symmetric about x = 0."""
    plane = bd.Plane(origin=(-width / 2, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    return bd.extrude(plane * profile, amount=width)


if __name__ == "__main__":
    draw_described(Path(__file__).parent, {"fr3_hand": body(), "fr3_leftfinger": finger(), "fr3_rightfinger": finger()})
