"""Draw the slider-crank: ``python -m robot_library.stepbot_slider_crank.build`` in the root of the checkout.

Writes slider_crank.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

import build123d as bd

from .. import shapes
from ..machine import CAST, METAL, STEEL, JointFrame, Link, Machine, draw, part, placed
from ..machine_parts import corners, drilled, pin, plate, slab
from ..moments import pose, turn
from ..shapes import at, cylinder, hull_plate, on_circle, stadium, tube
from . import closed_form
from . import dimensions as d


def draw_base() -> bd.Part:
    """A plate with rounded corners, four bolt holes and a chamfered rim."""
    x, y, z = d.BASE
    return drilled(plate(x, y, z, edge=10, rim=2), 4.5, z, corners(x - 28, y - 28))


def draw_pedestal() -> bd.Part:
    """A bearing block, seen from the front: a foot, tapering sides, a round head with the shaft's bore."""
    width, depth = d.PEDESTAL
    top = d.HEIGHT - d.BASE[2]
    cheek = slab([(-width / 2, 0), (width / 2, 0), (21, top), (-21, top)], depth)
    foot = bd.Pos(0, 5, 0) * bd.extrude(bd.RectangleRounded(width + 44, 10, 3), depth)
    body = cheek + foot + at(pin(24, depth, rim=2), (0, top, 0)) - at(cylinder(d.SHAFT_BORE, depth), (0, top, 0))
    return body - [at(cylinder(4.5, 20), (x, 0, depth / 2), (-90, 0, 0)) for x in (-43, 43)]


def draw_liner() -> bd.Part:
    """The cylinder on its saddle, along z from its open end; the quarter towards the viewer is cut away."""
    start, end = d.LINER
    length, below = end - start, d.HEIGHT - d.BASE[2]
    collar = tube(d.LINER_RADIUS + 4, d.LINER_RADIUS - 1, 6)
    body = tube(d.LINER_RADIUS, d.LINER_BORE, length) + at(collar, (0, 0, 6)) + at(collar, (0, 0, length - 12))
    saddle = at(bd.Box(below - 10, 30, length - 24), (below / 2 + 5, 0, length / 2))
    foot = at(bd.Box(10, 62, length - 24), (below - 5, 0, length / 2))
    body += saddle + foot - cylinder(d.LINER_RADIUS - 1, length)
    return body - at(bd.Box(124, 60, 2 * length), (-40, -40, 0))


def draw_web() -> bd.Part:
    """A disc, cut out beside the crank pin to be heavier opposite; the pin points to the viewer."""
    web = pin(d.WEB_RADIUS, d.WEB, rim=1.5, foot=1.5)
    web -= [at(cylinder(15, d.WEB), (d.THROW * 0.35, y, 0)) for y in (36, -36)]
    web += at(cylinder(9, d.ROD_GAP), (d.THROW, 0, d.WEB))
    return web + at(pin(d.PIN_RADIUS, d.ROD_PLATE + 3, rim=0.8), (d.THROW, 0, d.WEB + d.ROD_GAP))


def draw_shaft() -> bd.Part:
    """The shaft from the web through the pedestal to beyond the flywheel."""
    return pin(d.SHAFT_RADIUS, d.FLYWHEEL_FRONT + d.FLYWHEEL + 6 - d.WEB_FRONT - d.WEB, rim=1)


def draw_flywheel() -> bd.Part:
    """A rim, a hub, and five round openings between them."""
    recess = tube(d.FLYWHEEL_RADIUS - 10, 18, 5)
    body = pin(d.FLYWHEEL_RADIUS, d.FLYWHEEL, rim=2, foot=2) - recess - at(recess, (0, 0, d.FLYWHEEL - 5))
    return drilled(body, 11, d.FLYWHEEL, on_circle(5, 70)) - cylinder(d.SHAFT_RADIUS, d.FLYWHEEL)


def draw_rod() -> bd.Part:
    """Big end, shank with a groove on both sides, small end."""
    height = d.ROD_PLATE
    body = hull_plate([((0, 0), 9), ((d.ROD, 0), 6.5)], height) + pin(d.BIG_END, height, rim=1, foot=1)
    body += at(cylinder(d.SMALL_END, height), (d.ROD, 0, 0))
    groove = stadium((22, 0), (d.ROD - 22, 0), 4, 3)
    body -= [groove, at(groove, (0, 0, height - 3))]
    body -= [cylinder(d.BORE_RADIUS, height), at(cylinder(d.BORE_RADIUS, height), (d.ROD, 0, 0))]
    return at(body, (0, 0, -height / 2))


def draw_piston() -> bd.Part:
    """Along z, its pin at the origin: two ring grooves, a slot for the small end, the pin's bore along x."""
    length = d.PISTON_SKIRT + d.PISTON_CROWN
    body = at(pin(d.PISTON_RADIUS, length, rim=1.5), (0, 0, -d.PISTON_SKIRT))
    body -= [at(tube(d.PISTON_RADIUS, d.PISTON_RADIUS - 1.5, 2), (0, 0, z)) for z in (6.0, 10.5)]
    body -= at(plate(d.ROD_PLATE + 1, 26, d.PISTON_SKIRT + 11), (0, 0, -d.PISTON_SKIRT))
    return body - at(cylinder(d.PIN_RADIUS, 60), (-30, 0, 0), (0, 90, 0))


def draw_pin() -> bd.Part:
    """The piston's pin."""
    return at(pin(d.PIN_RADIUS, 34, rim=0.8, foot=0.8), (0, 0, -17))


def machine() -> Machine:
    """A fixed frame, crank, rod and piston."""
    base = part("base", draw_base(), CAST)
    pedestal = part("pedestal", at(draw_pedestal(), rpy=(90, 0, 0)), CAST, shapes.STEEL)
    liner = part("cylinder", at(draw_liner(), rpy=(0, 90, 0)), METAL, shapes.LIGHT)
    web = part("web", draw_web(), STEEL, shapes.RED)
    shaft = part("shaft", draw_shaft(), STEEL)
    flywheel = part("flywheel", draw_flywheel(), CAST, shapes.RED)
    rod = part("rod", draw_rod(), METAL, shapes.BLUE)
    piston = part("piston", draw_piston(), METAL, shapes.YELLOW)
    piston_pin = part("piston pin", draw_pin(), STEEL)

    behind = turn("x", pi)
    frame = [
        *placed(base, pose((*d.BASE_CENTRE, 0))),
        *placed(pedestal, pose((0, d.PEDESTAL_FRONT + d.PEDESTAL[1], d.BASE[2]))),
        *placed(liner, pose((d.LINER[0], 0, d.HEIGHT))),
    ]
    crank = [
        *placed(web, pose((0, 0, -d.WEB_FRONT - d.WEB))),
        *placed(shaft, pose((0, 0, -d.WEB_FRONT - d.WEB), behind)),
        *placed(flywheel, pose((0, 0, -d.FLYWHEEL_FRONT), behind)),
    ]
    X_WR, X_WP = d.rod_place(), d.piston_frame()
    return Machine(
        "slider_crank",
        (
            Link("frame", pose(), frame),
            Link("crank", d.crank_place(), crank),
            Link("rod", X_WR, placed(rod)),
            Link("piston", X_WP, [*placed(piston, pose(rotation=turn("y", pi / 2))), *placed(piston_pin)]),
        ),
        {
            "shaft": JointFrame(d.crank_place()),
            "big_end": JointFrame(X_WR),
            "stroke": JointFrame(X_WP, (1, 0, 0)),
            "small_end": JointFrame(X_WP),
        },
        closed_form.known(),
    )


if __name__ == "__main__":
    draw(__file__, machine)
