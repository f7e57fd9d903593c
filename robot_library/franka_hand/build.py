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
from ..shapes import ALUMINIUM, BLACK, DARK, STEEL, WHITE, at, block, cylinder, flange, on_circle, rod

WIDTH, DEPTH, TOP = 204.0, 63.0, 65.8
SLOT = 23.0
"""Width of the rail's opening: the fingers' 22 mm [C] and their clearance."""
RAIL = 58.4
"""Height of the fingers' origin over the flange [T]."""


def body() -> list[Body]:
    """The housing: the intersection of its outlines from the front, from the side and from above."""
    shell = _front() & _side() & at(bd.extrude(bd.RectangleRounded(DEPTH, WIDTH, 26), TOP), (0, 0, 0))
    shell = bd.fillet(shell.edges().filter_by(lambda edge: edge.center().Z > 20 and edge.length > 60), 5)
    slot = at(block(SLOT + 3, 181, 20), (0, 0, RAIL - 1.2))
    channel = at(block(SLOT + 3, 181, TOP - RAIL + 0.7), (0, 0, RAIL - 1.2)) - at(
        block(SLOT, 178, 20), (0, 0, RAIL - 0.4)
    )
    plate = flange(31.5, 6, on_circle(4, 50, 45), 3.3)  # [F]
    plug = rod((0, -40, 21), (0, -66, 21), 7.5)
    nut = rod((0, -56, 21), (0, -62, 21), 9.5) - plug
    return [
        Body("flange", plate, ALUMINIUM),
        Body("housing", shell - at(cylinder(40, 6)) - slot - plug, WHITE),
        Body("channel", channel, DARK),
        Body("plug", plug, BLACK),
        Body("nut", nut, STEEL),
    ]


def _front() -> bd.Part:
    """The outline in y and z: a neck as wide as the flange, flanks that swing out, and upright ends."""
    flank = bd.Spline((32, 6), (38, 18), (62, 30.5), (97, 39.5), tangents=[(0.1, 1), (1, 0.2)])
    outline = [
        flank.edge(),
        bd.ThreePointArc((97, 39.5), (100.6, 41.8), (102, 46)).edge(),
        bd.Line((102, 46), (102, TOP)).edge(),
        bd.Line((102, TOP), (0, TOP)).edge(),
        bd.Line((0, TOP), (0, 6)).edge(),
        bd.Line((0, 6), (32, 6)).edge(),
    ]
    plane = bd.Plane(origin=(-DEPTH / 2, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    half = bd.extrude(plane * bd.make_face(bd.Wire(outline)), amount=DEPTH)
    return half + half.mirror(bd.Plane.XZ)


def _side() -> bd.Part:
    """The outline in x and z: as deep as the flange below, less above."""
    profile = bd.Polygon(
        (-31.5, 6), (31.5, 6), (31.5, 20), (25, 40), (23, TOP), (-23, TOP), (-25, 40), (-31.5, 20), align=None
    )
    return bd.extrude(bd.Plane(origin=(0, WIDTH / 2, 0), x_dir=(1, 0, 0), z_dir=(0, -1, 0)) * profile, amount=WIDTH)


def finger() -> list[Body]:
    """A finger in its own frame: y points outwards, the pad touches y = 0 [C]."""
    carriage = bd.Polygon(
        (2.4, 0.3), (11.2, 0.3), (11.2, 1), (26, 1), (26, 20.5), (11, 20.5), (11, 4.1), (2.4, 4.1), align=None
    )
    arm = bd.Polygon((16, 20), (24.6, 20), (15.2, 36.4), (15.2, 53.8), (2, 53.8), (2, 36.4), (7.2, 36.4), align=None)
    # The profiles lie in the plane of y and z; a tip leans back a little at its end.
    lower = _thick(carriage, 22)
    upper = _thick(arm, 17.5)
    pad = at(bd.Box(17.5, 2, 17.4), (0, 1, 45.1))
    screws = [rod((x, 26, 11), (x, 27.5, 11), 2.7) for x in (-6.0, 6.0)]
    return [
        Body("finger", lower + upper, ALUMINIUM),
        Body("pad", pad, BLACK),
        *(Body("screw", screw, STEEL) for screw in screws),
    ]


def _thick(profile: bd.Sketch, width: float) -> bd.Part:
    """A profile in (y, z), extruded along x by ``width``, symmetric about x = 0."""
    plane = bd.Plane(origin=(-width / 2, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    return bd.extrude(plane * profile, amount=width)


if __name__ == "__main__":
    draw_described(Path(__file__).parent, {"fr3_hand": body(), "fr3_leftfinger": finger(), "fr3_rightfinger": finger()})
