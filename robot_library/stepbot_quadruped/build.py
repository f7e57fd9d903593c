"""Draw the quadruped: ``python -m robot_library.stepbot_quadruped.build`` in the root of the checkout.

Writes quadruped.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

import build123d as bd

from .. import shapes
from ..limb_parts import across, rounded_rims
from ..machine import DRIVE, METAL, RUBBER, STEEL, JointFrame, Link, Machine, Material, draw, part, placed
from ..machine_parts import chamfered_top, drilled, plate, slab
from ..moments import pose, turn
from ..shapes import at, cylinder, hull_plate, tube
from . import closed_form
from . import dimensions as d

SHELL = Material("ABS shell, hollow", 420.0, shapes.WHITE)
"""Walls of 3 mm, weighed."""
BODY = Material("body, as weighed", 900.0, shapes.DARK)
"""Frame, battery, computer and the drives of the roll axes."""
HOLLOW = Material("cast aluminium, hollow", 1100.0, shapes.LIGHT)

_TOP = d.BODY_FLOOR + d.BODY[2]
_SHELL_OUTLINE = [
    (-242, _TOP), (-242, -26), (-262, -34), (-280, 24), (-270, 90), (-232, 106), (178, 106), (262, 92),
    (330, 46), (330, -10), (306, -46), (242, -46), (242, _TOP),
]  # fmt: skip
"""Of the shell seen from the right (x, z): the back above the body, the head in front, the tail behind."""


def draw_body() -> bd.Part:
    """The box between the brackets, its long edges rounded."""
    return at(
        plate(d.BODY[2], d.BODY[1], d.BODY[0], edge=26), (-d.BODY[0] / 2, 0, d.BODY_FLOOR + d.BODY[2] / 2), (0, 90, 0)
    )


def draw_shell() -> bd.Part:
    """Back, head and tail in one piece, all edges rounded."""
    body = slab(_SHELL_OUTLINE, d.SHELL_WIDTH, 12)
    rims = body.edges().group_by(bd.Axis.Z)
    return across(bd.fillet(rims[0] + rims[-1], 9), d.SHELL_WIDTH / 2)


def draw_face() -> bd.Part:
    """The dark glass in front of the head."""
    return at(plate(40, 116, 3, edge=16, rim=1), (330, 0, 18), (0, 90, 0))


def draw_lens() -> bd.Part:
    """An eye of the stereo camera, x forwards."""
    return at(tube(11, 6, 3), rpy=(0, 90, 0))


def draw_side() -> bd.Part:
    """The cover of a side, with its louvres, standing on z = 0."""
    body = chamfered_top(plate(178, 62, 5, edge=14), 1.5)
    return body - [at(plate(7, 34, 5, edge=3), (x, 0, 2.5)) for x in (-60, -44, -28, 28, 44, 60)]


def draw_battery() -> bd.Part:
    """The pack below the body, with a grip."""
    body = at(plate(196, 118, 24, edge=12, rim=5), rpy=(180, 0, 0))
    return body - at(plate(70, 20, 20, edge=8), (0, 0, -30))


def draw_roll_drive() -> bd.Part:
    """The visible part of a roll drive, along z from the body outwards."""
    return shapes.housing(30, 18, 2, 0)


def draw_rail() -> bd.Part:
    """A mounting rail on the back, along x."""
    body = chamfered_top(plate(290, 16, 9, edge=4), 1)
    return drilled(body, 2.6, 9, [(x, 0) for x in range(-120, 121, 40)])


def draw_lidar() -> bd.Part:
    """The laser scanner on the back: foot, window, lid."""
    return cylinder(36, 8) + at(cylinder(31, 24), (0, 0, 8)) + at(shapes.housing(35, 14, 6, 0), (0, 0, 32))


def draw_bracket() -> bd.Part:
    """The hip of a front left leg: the flange on the roll axis, x backwards, and the drive of the hip across it."""
    length = d.BRACKET_INSIDE + d.BRACKET_OUTSIDE
    body = across(shapes.housing(d.BRACKET_RADIUS, length, 5, 5), d.BRACKET_OUTSIDE)
    flange = at(cylinder(34, 40), (-48, 0, 0), (0, 90, 0)) + at(cylinder(26, 6), (-30, 0, 0), (0, 90, 0))
    return body + flange


def draw_lid() -> bd.Part:
    """The ribbed lid at the inner end of a hip's drive, standing on z = 0."""
    return shapes.housing(34, 4, 1.5, 0) - [bd.Rot(0, 0, 60 * i) * at(bd.Box(18, 3, 3), (18, 0, 4)) for i in range(6)]


def draw_thigh() -> bd.Part:
    """The thigh of a left leg: a hub beside the hip's drive, a blade to the knee, the slot for the shank."""
    half = d.BLADE / 2
    hub = across(shapes.housing(46, d.HIP_OFFSET - d.BRACKET_OUTSIDE - 1 - half + 4, 4, 4), -half + 4)
    blade = rounded_rims(hull_plate([((0, 0), 46), ((0, -d.THIGH), 26)], d.BLADE), 5)
    slot = hull_plate([((0, -d.THIGH), 25), ((0, -d.THIGH - 60), 40)], d.SLOT)
    slot += hull_plate([((-8, -d.THIGH + 34), 10), ((8, -d.THIGH + 34), 10), ((0, -d.THIGH), 25)], d.SLOT)
    window = hull_plate([((0, -78), 16), ((0, -d.THIGH + 72), 10)], 5)
    body = hub + across(blade, half) - across(slot, d.SLOT / 2) - across(window, half)
    return body - across(cylinder(d.KNEE_PIN, 60), 30, z=-d.THIGH)


def draw_knee_drive() -> bd.Part:
    """The knee's drive on the outer face of the thigh, standing on z = 0."""
    body = shapes.housing(39, 19, 5, 0) - at(tube(33, 30, 3), (0, 0, 17))
    return body - [at(cylinder(2.2, 4), (x, y, 15)) for x, y in shapes.on_circle(6, 46)]


def draw_cap() -> bd.Part:
    """The coloured cap in the middle of the knee's drive."""
    return shapes.housing(16, 3, 1.5, 0)


def draw_shank() -> bd.Part:
    """A slender blade from the knee to the foot's neck."""
    blade = rounded_rims(hull_plate([((0, 0), 22), ((0, -d.SHANK + 40), 12)], d.SHIN), 4)
    body = across(blade, d.SHIN / 2) + at(cylinder(8.5, 50), (0, 0, -d.SHANK + 8))
    return body - across(cylinder(d.KNEE_PIN + 0.05, 60), 30)


def draw_foot() -> bd.Part:
    """A ball of rubber, the neck of the shank in it."""
    return bd.Sphere(d.FOOT_RADIUS) - at(cylinder(8.5, 40), (0, 0, 8))


def draw_knee_pin() -> bd.Part:
    """The pin through the thigh's cheeks and the shank, along y."""
    return across(cylinder(d.KNEE_PIN, d.BLADE + 4), d.BLADE / 2 + 2)


def trunk() -> Link:
    """The body with everything bolted to it."""
    side, drive = part("side cover", draw_side(), SHELL, shapes.ORANGE), part("roll drive", draw_roll_drive(), DRIVE)
    rail, lens = part("rail", draw_rail(), METAL), part("lens", draw_lens(), METAL, shapes.LIGHT)
    middle = d.BODY_FLOOR + d.BODY[2] / 2
    return Link(
        "trunk",
        d.trunk_place(),
        [
            *placed(part("body", draw_body(), BODY)),
            *placed(part("shell", draw_shell(), SHELL)),
            *placed(part("face", draw_face(), SHELL, shapes.BLACK)),
            *placed(lens, *(pose((333, y, 18)) for y in (-34, 34))),
            *placed(side, *(pose((0, y * d.BODY[1] / 2, middle), turn("x", -y * pi / 2)) for y in (1, -1))),
            *placed(part("battery", draw_battery(), DRIVE), pose((0, 0, d.BODY_FLOOR))),
            *placed(
                drive,
                *(pose((x * d.BODY[0] / 2, y * d.HIP_Y, 0), turn("y", x * pi / 2)) for x, y in d.CORNERS.values()),
            ),
            *placed(rail, *(pose((-80, y, 106)) for y in (-46, 46))),
            *placed(part("lidar", draw_lidar(), DRIVE), pose((130, 0, 106))),
        ],
    )


def machine() -> Machine:
    """The trunk and four legs of three links; the others are the front left one, rotated by half turns."""
    bracket, lid = (
        part("hip drive", draw_bracket(), HOLLOW, shapes.DARK),
        part("lid", draw_lid(), METAL, shapes.ALUMINIUM),
    )
    thigh, knee_drive = (
        part("thigh shell", draw_thigh(), HOLLOW, shapes.WHITE),
        part("knee drive", draw_knee_drive(), DRIVE),
    )
    cap, pin = part("cap", draw_cap(), METAL, shapes.ORANGE), part("knee pin", draw_knee_pin(), STEEL)
    shank, foot = part("shank blade", draw_shank(), HOLLOW, shapes.DARK), part("foot", draw_foot(), RUBBER)

    links, joints = [trunk()], {}
    X_WB = d.trunk_place()
    for name, leg in d.LEGS.items():
        front, left = d.CORNERS[name]
        X_WC, X_WT, X_WS = (X_WB @ X for X in leg.places(d.drawn(name))[:3])
        corner = pose(rotation=turn("x", 0 if left > 0 else pi) @ turn("y", 0 if front > 0 else pi))
        side = pose(rotation=turn("z", 0 if left > 0 else pi))
        inside = corner @ pose((0, -d.BRACKET_INSIDE, 0), turn("x", pi / 2))
        outside = [side @ pose((0, y, 0), turn("x", -pi / 2)) for y in (d.BLADE / 2, d.BLADE / 2 + 19)]
        links += [
            Link(f"{name}_bracket", X_WC, [*placed(bracket, corner), *placed(lid, inside)]),
            Link(
                f"{name}_thigh",
                X_WT,
                [
                    *placed(thigh, side),
                    *placed(knee_drive, outside[0]),
                    *placed(cap, outside[1]),
                    *placed(pin, pose((0, 0, -d.THIGH))),
                ],
            ),
            Link(f"{name}_shank", X_WS, [*placed(shank), *placed(foot, pose((0, 0, -d.SHANK)))]),
        ]
        joints |= {
            f"{name}_roll": JointFrame(X_WC, (1, 0, 0)),
            f"{name}_hip": JointFrame(X_WT, (0, 1, 0)),
            f"{name}_knee": JointFrame(X_WS, (0, 1, 0)),
        }
    return Machine("quadruped", links, joints, closed_form.known())


if __name__ == "__main__":
    draw(__file__, machine)
