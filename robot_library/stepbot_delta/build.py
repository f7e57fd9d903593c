"""Draw the delta robot: ``python -m robot_library.stepbot_delta.build`` in the root of the checkout.

Writes delta.step and expected.json beside this file; every run gives the same bytes.
"""

from math import cos, sin

import build123d as bd

from .. import shapes
from ..machine import CARBON, CAST, DRIVE, METAL, PLASTIC, STEEL, JointFrame, Link, Machine, draw, part, placed
from ..machine_parts import chamfered_top, drilled, pin, plate
from ..moments import inverse, pose, turn
from ..shapes import at, cone, cylinder, flange, hull_plate, lathe, on_circle
from . import closed_form
from . import dimensions as d

_CHEEK = d.ARM_WIDTH / 2 + 2
"""Distance of the plates beside an arm from its middle."""
_SHAFT, _BAR = 16.0, 4.5
"""Radii of a shoulder's shaft and of the bars that hold the balls."""


def draw_plate() -> bd.Part:
    """A plate with three lobes, each around the bearings of an arm, and holes for the bolts that it is mounted with."""
    lobes = [((170 * cos(d.azimuth(i)), 170 * sin(d.azimuth(i))), 66.0) for i in range(3)]
    body = chamfered_top(hull_plate(lobes, d.PLATE), 3)
    body = drilled(body, 5.5, d.PLATE, on_circle(6, 2 * 150, 30))
    return at(body, (0, 0, d.PLATE_ABOVE))


def draw_dome() -> bd.Part:
    """The cover in the middle of the plate, with the cables' socket on top."""
    return at(lathe([(112, 0), (112, 14), (96, 44), (40, 58), (34, 84), (0, 84)]), (0, 0, d.PLATE_ABOVE + d.PLATE))


def draw_cheek() -> bd.Part:
    """One of the two plates that carry a shoulder: the axis at the origin along y, the plate's upper end above."""
    upper = d.PLATE_ABOVE
    outline = hull_plate([((0, 0), 36), ((-14, upper - 20), 20), ((14, upper - 20), 20)], d.BEARING)
    block = at(bd.Box(86, 14, d.BEARING), (0, upper - 7, d.BEARING / 2))
    return at(outline + block, (0, d.BEARING, 0), (90, 0, 0)) - at(cylinder(_SHAFT + 0.05, 40), (0, 20, 0), (90, 0, 0))


def draw_motor() -> bd.Part:
    """A gear, a motor and its plug, along y from the plate."""
    body = cylinder(d.MOTOR_RADIUS, 22) + at(plate(60, 60, d.MOTOR_LENGTH - 34, edge=8), (0, 0, 22))
    body += at(pin(26, 12, rim=4), (0, 0, d.MOTOR_LENGTH - 12)) + at(bd.Box(18, 22, 14), (0, 40, 64))
    return at(body, rpy=(-90, 0, 0))


def draw_arm() -> bd.Part:
    """A hub and a tapered bar of two sides with openings between, x along the arm, y along the axes."""
    width = d.ARM_WIDTH
    body = hull_plate([((0, 0), d.HUB_RADIUS), ((d.UPPER, 0), 15)], width)
    body -= hull_plate([((52, 0), 14), ((d.UPPER - 34, 0), 9)], width)
    body -= [cylinder(_SHAFT, width), at(cylinder(_BAR, width), (d.UPPER, 0, 0))]
    return at(body, (0, width / 2, 0), (90, 0, 0))


def draw_shaft() -> bd.Part:
    """The shaft through the hub and both plates, along y."""
    reach = _CHEEK + d.BEARING
    return at(pin(_SHAFT, 2 * reach, rim=1, foot=1), (0, reach, 0), (90, 0, 0))


def draw_bar() -> bd.Part:
    """A bar with a ball at either end, along y."""
    reach = d.HALF_WIDTH
    body = at(cylinder(_BAR, 2 * reach), (0, reach, 0), (90, 0, 0))
    return body + [at(bd.Sphere(d.BALL), (0, y, 0)) for y in (reach, -reach)]


def draw_rod() -> bd.Part:
    """A tube between two cups, z along it from the upper ball."""
    body = at(cylinder(d.ROD, d.FORE - 2 * d.CUP - 8), (0, 0, d.CUP + 4))
    for z, up in ((0.0, 1), (d.FORE, -1)):
        cup = cylinder(d.CUP, d.CUP + 6) + at(cone(d.CUP, d.ROD, 8), (0, 0, d.CUP + 6))
        body += at(cup - bd.Sphere(d.BALL + 0.05), (0, 0, z), (0 if up > 0 else 180, 0, 0))
    return body


def draw_platform() -> bd.Part:
    """A plate with three ends, a flange below; its origin is the centre of the balls."""
    body = at(cylinder(34, 12), (0, 0, -6)) + at(flange(25, 14, on_circle(4, 38), 2.6), (0, 0, -20))
    for arm in range(3):
        tongue = at(bd.Box(d.WRIST_RADIUS - 10, 26, 12), ((d.WRIST_RADIUS - 10) / 2, 0, 0))
        end = at(bd.Box(20, 2 * d.HALF_WIDTH - 34, 16), (d.WRIST_RADIUS, 0, 0))
        body += bd.Rot(0, 0, 120 * arm) * (tongue + end)
    return (
        body
        - at(cylinder(12, 60), (0, 0, -30))
        - [bd.Rot(0, 0, 120 * arm) * at(cylinder(_BAR, 60), (d.WRIST_RADIUS, 30, 0), (90, 0, 0)) for arm in range(3)]
    )


def machine() -> Machine:
    """Base, three arms, six rods, platform."""
    top = part("base plate", draw_plate(), CAST)
    dome = part("dome", draw_dome(), PLASTIC)
    cheek = part("bearing plate", draw_cheek(), METAL, shapes.LIGHT)
    motor = part("motor", draw_motor(), DRIVE)
    arm_body = part("arm body", draw_arm(), CARBON, shapes.ORANGE)
    shaft = part("shaft", draw_shaft(), STEEL)
    bar = part("bar", draw_bar(), STEEL)
    rod = part("rod", draw_rod(), CARBON)
    star = part("star", draw_platform(), METAL, shapes.LIGHT)

    X_WB, X_WP = d.base_place(), d.platform_place()
    shoulders = [d.shoulder_frame(arm) for arm in range(3)]
    base = [
        *placed(top),
        *placed(dome),
        *placed(cheek, *(X @ pose((0, y, 0)) for X in shoulders for y in (_CHEEK, -_CHEEK - d.BEARING))),
        *placed(motor, *(X @ pose((0, _CHEEK + d.BEARING, 0)) for X in shoulders)),
    ]
    links = [Link("base", X_WB, base)]
    joints = {}
    for arm in range(3):
        X_WA, number = d.arm_place(arm), arm + 1
        elbow = placed(bar, pose((d.UPPER, 0, 0)))
        links.append(Link(f"arm_{number}", X_WA, [*placed(arm_body), *placed(shaft), *elbow]))
        joints[f"shoulder_{number}"] = JointFrame(X_WA, (0, 1, 0))
        for side, y in d.SIDES.items():
            X_WR = d.rod_place(arm, y)
            links.append(Link(f"rod_{number}_{side}", X_WR, placed(rod)))
            joints[f"elbow_{number}_{side}"] = JointFrame(X_WR, (0, 1, 0))
            joints[f"wrist_{number}_{side}"] = JointFrame(X_WR @ pose((0, 0, d.FORE)))
    X_PC = inverse(X_WP) @ pose(d.platform_centre())
    turned = [X_PC @ pose(rotation=turn("z", d.azimuth(arm))) @ pose((d.WRIST_RADIUS, 0, 0)) for arm in range(3)]
    links.append(Link("platform", X_WP, [*placed(star, X_PC), *placed(bar, *turned)]))
    return Machine("delta", links, joints, closed_form.known())


if __name__ == "__main__":
    draw(__file__, machine)
