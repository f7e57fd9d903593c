"""Draw the Stewart platform: ``python -m robot_library.stepbot_stewart.build`` in the root of the checkout.

Writes stewart.step and expected.json beside this file; every run gives the same bytes.
"""

from math import atan2

import build123d as bd
import numpy as np

from .. import shapes
from ..machine import CAST, METAL, STEEL, JointFrame, Link, Machine, draw, part, placed
from ..machine_parts import chamfered_top, drilled, pin, plate
from ..moments import Array, inverse, pose, turn
from ..shapes import at, cylinder, hull_plate, on_circle, tube
from . import closed_form
from . import dimensions as d


def draw_base() -> bd.Part:
    """A plate with three long and three short sides, a large opening and holes for bolts."""
    feet, _ = d.anchors()
    body = hull_plate([((x * 1.04, y * 1.04), 38) for x, y, _ in feet], d.BASE_PLATE)
    body = chamfered_top(body, 2) - cylinder(120, d.BASE_PLATE)
    return drilled(body, 5.5, d.BASE_PLATE, on_circle(3, 2 * 150)) - at(tube(132, 124, 3), (0, 0, d.BASE_PLATE - 3))


def draw_bracket() -> bd.Part:
    """The yoke that stands on the base, its pegs' bores along y through the origin."""
    floor = d.FOOT_HEIGHT - d.BASE_PLATE
    foot = at(plate(52, 60, 10, edge=8), (0, 0, -floor))
    cheeks = [_cheek(floor - 10, 15, y) for y in (d.YOKE, -d.YOKE - d.YOKE_PLATE)]
    return foot + cheeks - at(cylinder(d.PEG, 80), (0, 40, 0), (90, 0, 0))


def _cheek(height: float, radius: float, y: float) -> bd.Part:
    """A plate from ``height`` below the origin to a round end about it, its lower face at y."""
    plate_xy = hull_plate([((0, 0), radius), ((-8, -height), 8), ((8, -height), 8)], d.YOKE_PLATE)
    return at(plate_xy, (0, y + d.YOKE_PLATE, 0), (90, 0, 0))


def draw_fork() -> bd.Part:
    """The yoke at the lower end of a leg, its pegs' bores along x through the origin, a plate at its upper end."""
    cheek = hull_plate([((0, 0), 13), ((-9, d.CASE_START - 6), 6), ((9, d.CASE_START - 6), 6)], d.YOKE_PLATE)
    cheeks = [at(cheek, (x, 0, 0), (90, 0, 90)) for x in (d.YOKE, -d.YOKE - d.YOKE_PLATE)]
    top = at(cylinder(23, 6), (0, 0, d.CASE_START - 6))
    return top + cheeks - at(cylinder(d.PEG, 80), (-40, 0, 0), (0, 90, 0))


def draw_cross() -> bd.Part:
    """The cross between both yokes: two round bars and a block."""
    reach = d.YOKE + d.YOKE_PLATE + 1
    along_x = at(pin(d.PEG, 2 * reach, rim=0.8, foot=0.8), (-reach, 0, 0), (0, 90, 0))
    along_y = at(pin(d.PEG, 2 * reach, rim=0.8, foot=0.8), (0, reach, 0), (90, 0, 0))
    return along_x + along_y + bd.fillet(bd.Box(22, 22, 18).edges(), 2)


def draw_case() -> bd.Part:
    """The body of the electric cylinder with its rod's bore and a wiper on top."""
    length = d.CASE_END - d.CASE_START
    body = at(cylinder(d.CASE, length - 14), (0, 0, d.CASE_START)) + at(cylinder(23, 14), (0, 0, d.CASE_START))
    body += at(pin(23, 14, rim=2), (0, 0, d.CASE_END - 14))
    return body - at(cylinder(d.ROD, length), (0, 0, d.ROD_START - d.STROKE - 5))


def draw_motor() -> bd.Part:
    """The motor beside the cylinder, along it."""
    return plate(30, 30, 92, edge=4) + at(pin(13, 10, rim=2), (0, 0, 92))


def draw_rod(length: float) -> bd.Part:
    """The rod of a leg of this length, the ball at its end at the origin, z along the leg."""
    start = d.ROD_START - length
    body = at(pin(d.ROD, -start - d.BALL - 10, foot=1), (0, 0, start)) + at(
        shapes.cone(d.ROD, 6, 10), (0, 0, -d.BALL - 10)
    )
    return body + at(cylinder(6, d.BALL + 2), (0, 0, -d.BALL - 2)) + bd.Sphere(d.BALL)


def draw_socket() -> bd.Part:
    """The cup that holds a ball, hanging below the platform."""
    below = d.PLATFORM_BELOW
    body = at(cylinder(20, below + 1), (0, 0, -1)) - bd.Sphere(d.BALL + 0.05)
    return body - at(shapes.cone(19, d.BALL - 2, 8), (0, 0, -5)) + at(cylinder(26, 6), (0, 0, below - 6))


def draw_platform() -> bd.Part:
    """A hexagonal plate with an opening and a grid of threads."""
    _, heads = d.anchors()
    body = hull_plate([((x, y), 36) for x, y, _ in heads], d.PLATFORM_PLATE)
    body = chamfered_top(body, 2) - cylinder(48, d.PLATFORM_PLATE)
    body = drilled(body, 3.3, d.PLATFORM_PLATE, [*on_circle(6, 150, 30), *on_circle(12, 240)])
    return at(body, (0, 0, d.PLATFORM_BELOW))


def foot_frame(leg: int) -> Array:
    """X_WF of a leg's bracket: the origin in the cross, y as the leg's, z up."""
    X_WL = d.leg_place(leg)
    y = X_WL[:3, 1]
    return pose(X_WL[:3, 3], np.column_stack((np.cross(y, (0.0, 0.0, 1.0)), y, (0.0, 0.0, 1.0))))


def machine() -> Machine:
    """Base, six cylinders with their rods, platform."""
    length = float(d.leg_lengths(d.platform_place())[0])
    plate_part = part("base plate", draw_base(), CAST)
    bracket = part("bracket", draw_bracket(), METAL, shapes.STEEL)
    fork = part("fork", draw_fork(), METAL, shapes.STEEL)
    cross = part("cross", draw_cross(), STEEL, shapes.LIGHT)
    case = part("case", draw_case(), METAL, shapes.BLUE)
    motor = part("motor", draw_motor(), CAST, shapes.BLACK)
    rod = part("rod", draw_rod(length), STEEL, shapes.LIGHT)
    top = part("platform plate", draw_platform(), METAL, shapes.ORANGE)
    socket = part("socket", draw_socket(), METAL, shapes.DARK)

    _, heads = d.anchors()
    links = [Link("base", pose(), [*placed(plate_part), *placed(bracket, *(foot_frame(leg) for leg in range(6)))])]
    joints = {}
    for leg in range(6):
        number, X_WL, X_WR = leg + 1, d.leg_place(leg), d.rod_place(leg)
        beside = pose((0, 38 if leg % 2 else -38, d.CASE_START + 26), turn("z", 0))
        cylinder_parts = [*placed(fork), *placed(cross), *placed(case), *placed(motor, beside)]
        links += [Link(f"cylinder_{number}", X_WL, cylinder_parts), Link(f"rod_{number}", X_WR, placed(rod))]
        joints |= {
            f"foot_{number}": JointFrame(X_WL, (1, 0, 0)),
            f"leg_{number}": JointFrame(X_WR),
            f"head_{number}": JointFrame(X_WR),
        }
    X_WP, X_WB = d.platform_place(), d.rod_place(0)
    X_BP = inverse(X_WB) @ X_WP
    sockets = [X_BP @ pose(head, turn("z", atan2(head[1], head[0]))) for head in heads]
    links.append(Link("platform", X_WB, [*placed(top, X_BP), *placed(socket, *sockets)]))
    return Machine("stewart", links, joints, closed_form.known())


if __name__ == "__main__":
    draw(__file__, machine)
