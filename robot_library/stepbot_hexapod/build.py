"""Draw the hexapod: ``python -m robot_library.stepbot_hexapod.build`` in the root of the checkout.

Writes hexapod.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

import build123d as bd

from .. import shapes
from ..limb_parts import across
from ..machine import DRIVE, METAL, PRINTED, RUBBER, STEEL, JointFrame, Link, Machine, Material, draw, part, placed
from ..machine_parts import chamfered_top, drilled, pin, plate
from ..moments import pose, turn
from ..shapes import at, block, cylinder, hull_plate, on_circle, tube
from . import closed_form
from . import dimensions as d

SERVO = Material("servo, as weighed", 900.0, shapes.BLACK)
"""55 g in its outer dimensions, as in the data sheet of the AX-12."""
SHELL = Material("PLA shell, hollow", 450.0, shapes.WHITE)

_AXES = [(x, y) for x, y, _ in d.CORNERS.values()]
_POSTS = [(x, y) for x in (-70, 70) for y in (-58, 58)]
_HALF = d.GAP / 2


def draw_plate() -> bd.Part:
    """A plate of the body: around all yaw axes, their horns' holes, openings."""
    body = chamfered_top(hull_plate([((x, y), 25) for x, y in _AXES], d.PLATE), 1)
    bores = [(x + dx, y + dy) for x, y in _AXES for dx, dy in [(0, 0), *on_circle(4, 16, 45)]]
    windows = [at(hull_plate([((-12, 0), 9), ((12, 0), 9)], d.PLATE), (x, y, 0), (0, 0, turned))
               for x, y, turned in ((52, 74, -22), (-52, 74, 22), (52, -74, 22), (-52, -74, -22))]  # fmt: skip
    return drilled(body, 1.6, d.PLATE, [*bores, *_POSTS]) - windows


def draw_post() -> bd.Part:
    """A hexagonal spacer between the plates."""
    return bd.extrude(bd.RegularPolygon(5, 6), d.GAP)


def draw_cover() -> bd.Part:
    """The cover on the upper plate, its edges rounded, with louvres over the computer."""
    body = hull_plate([((x, y), 16) for x, y in ((-96, -34), (-96, 34), (0, -62), (0, 62), (84, -34), (84, 34))], 30)
    body = bd.fillet(body.faces().sort_by(bd.Axis.Z)[-1].edges(), 10)
    return body - [at(block(5, 56, 8, 2.4, only="z"), (x, 0, 24)) for x in range(-78, -33, 11)]


def draw_stripe() -> bd.Part:
    """A coloured plate on the cover."""
    return plate(62, 84, 2, edge=12, rim=1)


def draw_head() -> bd.Part:
    """The head in front of the cover."""
    return bd.fillet(bd.Box(40, 84, 34).edges(), 7)


def draw_visor() -> bd.Part:
    """The dark glass in the head, x forwards."""
    return at(block(62, 18, 2, 8.9, only="z"), rpy=(90, 0, 90))


def draw_lens() -> bd.Part:
    """An eye, x forwards."""
    return at(tube(6.5, 3, 2), rpy=(0, 90, 0))


def draw_servo() -> bd.Part:
    """A servo with its horns, its axis the z axis through the origin, its longer end towards x."""
    x, y, z = d.SERVO
    body = bd.Pos(x / 2 - d.SERVO_END, 0, 0) * bd.fillet(bd.Box(x, y, z).edges(), 2)
    body -= [at(bd.Box(14, 1.4, 30), (28, side * y / 2, 0)) for side in (1, -1)]
    body -= [at(cylinder(2, 6), (x - d.SERVO_END - 4, side * 11, z / 2 - 4)) for side in (1, -1)]
    return body + at(cylinder(d.HORN_RADIUS, d.GAP), (0, 0, -_HALF))


def draw_saddle() -> bd.Part:
    """The bracket between the servos of yaw and hip, the yaw axis at the origin."""
    inner, outer = d.SERVO_END, d.COXA - d.SERVO[0] + d.SERVO_END
    return at(block(d.SERVO[1], d.SERVO[2], outer - inner, 3, only="z"), (inner, 0, 0), (0, 90, 0))


def draw_femur_plate() -> bd.Part:
    """A side of the femur, a rim around its opening, hip at the origin, knee along x."""
    body = hull_plate([((0, 0), 17), ((d.FEMUR, 0), 17)], d.FEMUR_PLATE)
    waist = [at(cylinder(60, d.FEMUR_PLATE), (d.FEMUR / 2, side * 70, 0)) for side in (1, -1)]
    body = chamfered_top(body - waist, 1)
    holes = [(x + dx, dy) for x in (0.0, d.FEMUR) for dx, dy in on_circle(4, 16, 45)]
    return drilled(body, 1.6, d.FEMUR_PLATE, holes) - hull_plate([((28, 0), 4), ((d.FEMUR - 28, 0), 4)], d.FEMUR_PLATE)


def draw_disc() -> bd.Part:
    """The washer with its screw on a joint, standing on z = 0."""
    return pin(9, 2, rim=0.6) + at(pin(3.2, 3, rim=0.6), (0, 0, 2))


def draw_spacer() -> bd.Part:
    """The bar between the sides of the femur, along y."""
    return across(cylinder(5, d.GAP), _HALF)


def draw_tibia() -> bd.Part:
    """The tibia's shell, from the knee's servo to the foot, thinner towards it."""
    start = d.SERVO[0] - d.SERVO_END
    sections = ((start, 0.0, 37.0, 34.0, 7.0), (start + 30, 5.0, 27.0, 27.0, 8.0), (d.TIBIA - 6, 0.0, 11.0, 11.0, 5.0))
    return shapes.loft(
        *(
            bd.Plane((x, 0, z), x_dir=(0, 1, 0), z_dir=(1, 0, 0)) * bd.RectangleRounded(wide, high, edge)
            for x, z, wide, high, edge in sections
        )
    )


def draw_foot() -> bd.Part:
    """A ball of rubber, cut where the tibia ends."""
    return bd.Sphere(d.FOOT_RADIUS) - at(bd.Box(20, 40, 40), (-16, 0, 0))


def body() -> Link:
    """Both plates with everything between and on them."""
    lens = part("lens", draw_lens(), METAL, shapes.LIGHT)
    deck = part("plate", draw_plate(), METAL, shapes.DARK)
    top = _HALF + d.PLATE
    return Link(
        "body",
        d.body_place(),
        [
            *placed(deck, pose((0, 0, _HALF)), pose((0, 0, -_HALF), turn("x", pi))),
            *placed(part("post", draw_post(), METAL), *(pose((x, y, -_HALF)) for x, y in _POSTS)),
            *placed(part("battery", bd.fillet(bd.Box(116, 46, 38).edges(), 3), DRIVE, shapes.BLUE)),
            *placed(part("cover", draw_cover(), SHELL), pose((0, 0, top))),
            *placed(part("stripe", draw_stripe(), SHELL, shapes.ORANGE), pose((18, 0, top + 30))),
            *placed(part("head", draw_head(), SHELL), pose((130, 0, top + 17))),
            *placed(part("visor", draw_visor(), SHELL, shapes.BLACK), pose((150, 0, top + 18))),
            *placed(lens, *(pose((152, y, top + 18)) for y in (-17, 17))),
        ],
    )


def machine() -> Machine:
    """The body and six equal legs of three links."""
    servo, saddle = part("servo", draw_servo(), SERVO), part("saddle", draw_saddle(), METAL)
    side, disc = (
        part("femur plate", draw_femur_plate(), METAL, shapes.ORANGE),
        part("disc", draw_disc(), STEEL, shapes.LIGHT),
    )
    spacer = part("spacer", draw_spacer(), METAL)
    shell, foot = part("tibia shell", draw_tibia(), PRINTED, shapes.WHITE), part("foot", draw_foot(), RUBBER)

    half = _HALF + d.FEMUR_PLATE
    lying = turn("x", -pi / 2)
    coxa = [
        *placed(servo, pose(rotation=turn("z", pi)), name="yaw servo"),
        *placed(servo, pose((d.COXA, 0, 0), lying @ turn("z", pi)), name="hip servo"),
        *placed(saddle),
    ]
    femur = [
        *placed(side, pose((0, _HALF, 0), lying), pose((0, -_HALF, 0), turn("x", pi / 2))),
        *placed(spacer, pose((d.FEMUR / 2, 0, 0))),
        *placed(disc, *(pose((x, y * half, 0), turn("x", -y * pi / 2)) for x in (0, d.FEMUR) for y in (1, -1))),
    ]
    tibia = [
        *placed(servo, pose(rotation=lying), name="knee servo"),
        *placed(shell),
        *placed(foot, pose((d.TIBIA, 0, 0))),
    ]

    links, joints = [body()], {}
    X_WB = d.body_place()
    for name, leg in d.LEGS.items():
        X_WC, X_WF, X_WT = (X_WB @ X for X in leg.places(d.drawn(name))[:3])
        links += [
            Link(f"{name}_coxa", X_WC, coxa),
            Link(f"{name}_femur", X_WF, femur),
            Link(f"{name}_tibia", X_WT, tibia),
        ]
        joints |= {
            f"{name}_yaw": JointFrame(X_WC),
            f"{name}_hip": JointFrame(X_WF, (0, 1, 0)),
            f"{name}_knee": JointFrame(X_WT, (0, 1, 0)),
        }
    return Machine("hexapod", links, joints, closed_form.known())


if __name__ == "__main__":
    draw(__file__, machine)
