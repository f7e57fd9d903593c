"""Draw the Panda: ``python -m robot_library.franka_panda.build`` in the root of the checkout.

Writes panda.step beside this file; every run gives the same bytes. Joint origins come from expected.json. The
dimensions below are those of the shells around them; letters in brackets name their sources:

[C] The self-collision shapes in the maker's description: capsules of 60 mm radius around the arm and, 120 mm long
    across it, around shoulder and elbow; 50 mm around the wrist; 25 mm around the bow of the forearm, whose axis is
    80 mm beside that of joint 5; 40 mm around joint 7.
[F] Tool flange ISO 9409-1-50-4-M6: 63 mm across, four M6 on 50 mm, 31.5 mm centring, a 6 mm pin.
[E] Estimated from photographs, to about 4 mm.

Shoulder and elbow consist of the same shape four times: half of a barrel across the arm, and a neck from there to the
next joint. :func:`knee` draws it.
"""

from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..shapes import (
    ALUMINIUM,
    BLACK,
    BLUE,
    DARK,
    LIGHT,
    WHITE,
    at,
    cylinder,
    flange,
    housing,
    hull_plate,
    on_circle,
    rod,
    tube,
)

ARM, BARREL = 54.0, 58.0
"""Radii of necks and of the barrels of shoulder and elbow: 60 mm less their clearance [C]."""
SIDE = 118.0
"""Half length of a barrel [C]: the two links that meet there have one half each."""
WRIST, HAND = 47.0, 42.0
"""Radii of the barrels of joints 6 and 7 [C]."""
ELBOW, REACH = 82.5, 88.0
"""Offsets of elbow and flange, as in expected.json."""
FOREARM = (
    (-225.0, 0.0, 2 * ARM - 1, 2 * ARM - 1, ARM - 2),
    (-195.0, 6.0, 104.0, 100.0, 46.0),
    (-160.0, 27.0, 95.0, 82.0, 37.0),
    (-120.0, 54.0, 86.0, 62.0, 28.0),
    (-75.0, 74.0, 84.0, 50.0, 23.0),
    (-30.0, 82.0, 88.0, 44.0, 20.0),
    (0.0, 83.0, 92.0, 42.0, 19.0),
)
"""Sections of the forearm: height, distance from the axis of joint 5, width, depth and rounding. Its bow is the maker's
80 mm beside the axis [C]."""
NECK = ((0.0, -10.0, 84.0, 88.0, 34.0), (40.0, -5.0, 82.0, 80.0, 36.0), (REACH, 0.0, 80.0, 72.0, 33.0))
"""Sections of link 6: distance from joint 6, height along its axis, width, height and rounding [E]."""
GAP, SEAM = 0.75, 2.5
"""Half of the slit between two links, and the thickness of the black rings in some of them [E]."""


def knee(reach: float, shift: float = 0.0) -> list[Body]:
    """Half a barrel around z, above z = 0, and a neck along y that ends at ``reach``, its axis at x = ``shift``.

    The neck is centred on z = 0, so its shell leans over from the barrel's half.
    """
    barrel = at(housing(BARREL, SIDE - GAP, 9, 0), (0, 0, GAP))
    start, end = 12.0, 78.0 if shift == 0.0 else 96.0
    lean = bd.loft(
        [
            _across(0, start, SIDE / 2 + GAP, 2 * BARREL - 5, SIDE - 3, 34),
            _across(shift, end, 0, 2 * ARM - 1, 2 * ARM - 1, ARM - 2),
        ]
    )
    neck = rod((shift, end - 4, 0), (shift, reach, 0), ARM)  # it encloses the end of the loft
    return [
        Body("shell", barrel + lean + neck, WHITE),
        Body("ring", at(tube(BARREL - 9, BARREL - 12, 1.0), (0, 0, SIDE)), LIGHT),
        Body("lid", at(housing(BARREL - 12, 3, 2, 0), (0, 0, SIDE)), WHITE),
    ]


def _across(x: float, y: float, z: float, width: float, depth: float, edge: float) -> bd.Face:
    """A rounded rectangle across the y axis."""
    plane = bd.Plane(origin=(x, y, z), x_dir=(1, 0, 0), z_dir=(0, 1, 0))
    return (plane * bd.RectangleRounded(width, depth, edge)).face()


def _level(x: float, y: float, z: float, width: float, depth: float, edge: float) -> bd.Face:
    """A rounded rectangle across the z axis."""
    return (bd.Pos(x, y, z) * bd.RectangleRounded(width, depth, edge)).face()


def _forward(x: float, z: float, width: float, height: float, edge: float) -> bd.Face:
    """A rounded rectangle across the x axis, ``width`` along y and ``height`` along z."""
    plane = bd.Plane(origin=(x, 0, z), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    return (plane * bd.RectangleRounded(width, height, edge)).face()


def _moved(bodies: list[Body], xyz: tuple[float, float, float], rpy: tuple[float, float, float]) -> list[Body]:
    return [Body(body.name, at(body.shape, xyz, rpy), body.color) for body in bodies]


def base() -> list[Body]:
    """The foot with its four screws, the column of joint 1, the plugs at its back and the light around it [E]."""
    foot = bd.loft([_level(-38, 0, 0, 186, 190, 46), _level(-34, 0, 78, 150, 118, 40)])
    neck = bd.loft([_level(-34, 0, 70, 148, 116, 39), _level(0, 0, 122, 2 * ARM + 1, 2 * ARM + 1, ARM - 1)])
    body = foot + neck + at(cylinder(ARM + 1, 141 - 118 - GAP), (0, 0, 118))
    for x in (40.0, -112.0):
        for y in (68.0, -68.0):
            body -= at(cylinder(3.3, 40), (x, y, -1)) + at(cylinder(8, 70), (x, y, 14))
    plugs = [at(bd.Box(12, 26, 24), (-128, y, 30)) - body for y in (-30.0, 12.0)]
    light = at(tube(ARM + 1.8, ARM - 3, 3), (0, 0, 130))
    return [
        Body("foot", body - light, WHITE),
        Body("light", light, BLUE),
        *(Body("plug", plug.solids().sort_by(bd.Axis.X)[0], BLACK) for plug in plugs),
    ]


def link_1() -> list[Body]:
    """From the base to the shoulder: half a barrel towards -y, the neck towards -z."""
    seam = rod((0, 0, 141 - 333 + GAP), (0, 0, 141 - 333 + GAP + SEAM), ARM - 1.5)
    return [*_moved(knee(333 - 141 - GAP - SEAM), (0, 0, 0), (-90, 0, 180)), Body("seam", seam, BLACK)]


def link_2() -> list[Body]:
    """From the shoulder up to joint 3: half a barrel towards +z, the neck towards -y."""
    seam = rod((0, -194 + GAP, 0), (0, -194 - GAP, 0), ARM - 1.5)
    return [*_moved(knee(194 - GAP), (0, 0, 0), (0, 0, 180)), Body("seam", seam, BLACK)]


def link_3() -> list[Body]:
    """From joint 3 to the elbow, whose axis is in front: half a barrel towards +y, the neck towards -z."""
    return _moved(knee(122 - GAP, -ELBOW), (ELBOW, 0, 0), (-90, 0, 0))


def link_4() -> list[Body]:
    """From the elbow back to joint 5: half a barrel towards +z, the neck towards +y."""
    seam = rod((-ELBOW, 124 - GAP, 0), (-ELBOW, 124 + GAP, 0), ARM - 1.5)
    return [*knee(124 - GAP, -ELBOW), Body("seam", seam, BLACK)]


def link_5() -> list[Body]:
    """The forearm: from joint 5 down, in a bow beside the axis, to joint 6."""
    top = rod((0, 0, -260 + GAP), (0, 0, -221), ARM)
    forearm = bd.loft([_level(0, y, z, width, depth, edge) for z, y, width, depth, edge in FOREARM])
    joint = at(housing(WRIST, 42, 3, 0), (0, 62, 0), (-90, 0, 0))
    return [
        Body("shell", top + forearm + joint, WHITE),
        Body("ring", at(tube(WRIST - 7, WRIST - 9, 1), (0, 104, 0), (-90, 0, 0)), LIGHT),
        Body("lid", at(housing(WRIST - 9, 3, 2, 0), (0, 104, 0), (-90, 0, 0)), WHITE),
        Body("seam", rod((0, 62, 0), (0, 62 - SEAM, 0), WRIST - 2), BLACK),
    ]


def link_6() -> list[Body]:
    """Between the wrist axes: the barrel of joint 6, that of joint 7 in front of it, the disc of the pilot."""
    barrel = at(housing(WRIST, 62 + 40 - SEAM - GAP, 9, 0), (0, 0, -62 + SEAM + GAP))
    arm = bd.loft([_forward(x, z, width, height, edge) for x, z, width, height, edge in NECK])
    head = at(housing(HAND, 100, 8, 12), (REACH, -50, 0), (-90, 0, 0))
    return [
        Body("shell", barrel + arm + head, WHITE),
        Body("ring", at(tube(WRIST - 9, WRIST - 11, 1), (0, 0, 40)), LIGHT),
        Body("lid", at(housing(WRIST - 11, 3, 2, 0), (0, 0, 40)), WHITE),
        Body("pilot", at(housing(30, 4, 2, 0), (REACH, 50, 0), (-90, 0, 0)), LIGHT),
        Body("button", at(housing(9, 2, 1, 0), (REACH, 54, 0), (-90, 0, 0)), BLUE),
        Body("seam", rod((REACH, -50, 0), (REACH, -50 - SEAM, 0), HAND - 3), BLACK),
    ]


def link_7() -> list[Body]:
    """The tool flange, and the connector beside it."""
    collar = at(housing(HAND, 38, 6, 3), (0, 0, 50 + SEAM + GAP)) + at(cylinder(34, 9), (0, 0, 86))
    plate = flange(31.5, 12, on_circle(4, 50, 45), 2.5) - at(cylinder(15.75, 6.2), (0, 0, 5.8))  # [F]
    plate -= at(cylinder(3, 6), (0, 25, 6))
    nose = bd.fillet(hull_plate([((0, 0), 28), ((62, 0), 22)], 30).edges(), 5)  # [C] 60 mm beside the axis
    sockets = [at(rod((80, y, 15), (85.5, y, 15), 7), (0, 0, 59), (0, 0, 45)) for y in (-8.5, 8.5)]
    nose = at(nose, (0, 0, 59), (0, 0, 45))
    for socket in sockets:
        nose -= socket
    return [
        Body("collar", collar + nose, WHITE),
        Body("flange", at(plate, (0, 0, 95)), ALUMINIUM),
        *(Body("socket", socket, DARK) for socket in sockets),
    ]


if __name__ == "__main__":
    links = (base(), link_1(), link_2(), link_3(), link_4(), link_5(), link_6(), link_7())
    draw_described(Path(__file__).parent, {f"fer_link{number}": bodies for number, bodies in enumerate(links)})
