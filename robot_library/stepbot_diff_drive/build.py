"""Draw the differential-drive base: ``python -m robot_library.stepbot_diff_drive.build`` in the root of the checkout.

Writes diff_drive.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

import build123d as bd

from .. import shapes
from ..machine import DRIVE, METAL, PLASTIC, RUBBER, STEEL, JointFrame, Link, Machine, draw, part, placed
from ..machine_parts import chamfered_top, corners, drilled, pin, plate
from ..moments import inverse, pose, turn
from ..shapes import at, cylinder, housing, lathe, on_circle, tube
from . import closed_form
from . import dimensions as d

_POSTS = corners(200, 190)


def draw_lower_deck() -> bd.Part:
    """A round plate with wells for the wheels and an openings above the casters."""
    body = cylinder(d.DECK_RADIUS, d.DECK)
    body -= [at(bd.Box(d.WELL[0], 80, 40), (0, side * (d.TRACK / 2 - d.WELL[1] + 40), 0)) for side in (1, -1)]
    body -= [at(cylinder(d.CASTER_RADIUS + 8, 20), (x, 0, 0)) for x, _ in d.CASTERS.values()]
    return drilled(body, 2.2, d.DECK, _POSTS)


def draw_upper_deck() -> bd.Part:
    """A round plate with rows of mounting slots."""
    body = chamfered_top(cylinder(d.DECK_RADIUS, d.DECK), 1.5)
    slots = [at(plate(34, 5, d.DECK, edge=2.4), (x, y, 0)) for x in (-110, -65) for y in (-80, -40, 40, 80)]
    return drilled(body, 2.2, d.DECK, _POSTS) - slots - at(cylinder(16, d.DECK), (-20, 0, 0))


def draw_post() -> bd.Part:
    """A hexagonal spacer between the decks."""
    return bd.extrude(bd.RegularPolygon(6, 6), d.UPPER_DECK - d.LOWER_DECK - d.DECK)


def draw_bumper() -> bd.Part:
    """The front half of a ring around the lower deck, with a window for the camera."""
    inner, height = d.DECK_RADIUS, 84.0
    ring = tube(inner + 10, inner, height)
    ring = bd.fillet(ring.edges().group_by(bd.Axis.Z)[-1] + ring.edges().group_by(bd.Axis.Z)[0], 3)
    front = ring & at(bd.Box(300, 600, 300), (150 + 100, 0, 0))
    return front - at(bd.Box(120, 120, 34), (d.DECK_RADIUS, 0, 62))


def draw_motor() -> bd.Part:
    """Gear and motor, along z from the wheel inwards, with the output shaft."""
    body = cylinder(d.GEAR_RADIUS, d.GEAR_LENGTH) + at(
        pin(d.MOTOR_RADIUS, d.MOTOR_LENGTH, rim=2), (0, 0, d.GEAR_LENGTH)
    )
    return body + at(cylinder(4, 10), (0, 0, -10))


def draw_mount() -> bd.Part:
    """A block on the lower deck that holds a motor; the axle at the origin, along y."""
    below = d.WHEEL_RADIUS - d.LOWER_DECK - d.DECK
    body = at(plate(54, 14, below + 24), (0, 0, -below))
    return body - at(cylinder(d.MOTOR_RADIUS, 40), (0, 20, 0), (90, 0, 0))


def draw_battery() -> bd.Part:
    """A pack with a handle, on two rails."""
    body = at(plate(90, 130, 56, edge=6, rim=2), (0, 0, d.RAIL))
    body += [at(bd.Box(80, 12, d.RAIL), (0, side * 50, d.RAIL / 2)) for side in (1, -1)]
    return body + at(plate(16, 60, 8, edge=3), (0, 0, 56 + d.RAIL))


def draw_computer() -> bd.Part:
    """A computer with cooling fins."""
    body = plate(96, 84, 30, edge=4)
    return body - [at(bd.Box(4, 70, 12), (x, 0, 30)) for x in range(-36, 37, 9)]


def draw_caster_housing() -> bd.Part:
    """A cup around the upper half of the ball, its flange under the lower deck; the origin is the ball's centre."""
    up = d.LOWER_DECK - d.CASTER_RADIUS
    body = at(cylinder(d.CASTER_RADIUS + 6, up + 6), (0, 0, -6)) + at(cylinder(d.CASTER_RADIUS + 20, 5), (0, 0, up - 5))
    body = drilled(body, 2.2, up, on_circle(3, 2 * (d.CASTER_RADIUS + 13)))
    return body - bd.Sphere(d.CASTER_RADIUS + 0.4)


def draw_lidar() -> bd.Part:
    """A laser scanner: foot, turning head with its window."""
    body = lathe([(d.LIDAR_RADIUS, 0), (d.LIDAR_RADIUS, 18), (d.LIDAR_RADIUS - 4, 22), (d.LIDAR_RADIUS - 4, 26)])
    return body + at(housing(d.LIDAR_RADIUS - 2, d.LIDAR_HEIGHT - 26, 4, 0), (0, 0, 26))


def draw_camera() -> bd.Part:
    """A depth camera, x forwards through its lens."""
    body = bd.fillet(bd.Box(22, 92, 24).edges(), 4)
    eyes = [at(cylinder(r, 2), (10, y, 0), (0, 90, 0)) for y, r in ((-32, 7), (0, 5), (32, 7))]
    return body + eyes


def draw_camera_foot() -> bd.Part:
    """The post of the camera on the lower deck."""
    height = float(d.camera_place()[2, 3]) - 12 - d.LOWER_DECK - d.DECK
    return plate(14, 40, height, edge=3)


def draw_rim() -> bd.Part:
    """The wheel's hub and disc with five openings, along z."""
    half = d.WHEEL_WIDTH / 2
    body = at(tube(d.WHEEL_RADIUS - 9, d.WHEEL_RADIUS - 14, d.WHEEL_WIDTH - 4), (0, 0, 2 - half))
    body += at(drilled(cylinder(d.WHEEL_RADIUS - 13, 8), 9, 8, on_circle(5, 56)), (0, 0, -4))
    return body + at(pin(13, d.WHEEL_WIDTH, rim=2, foot=2), (0, 0, -half)) - at(cylinder(4, 60), (0, 0, -30))


def draw_tyre() -> bd.Part:
    """A tyre with a tread of grooves."""
    half = d.WHEEL_WIDTH / 2
    body = bd.fillet(
        tube(d.WHEEL_RADIUS, d.WHEEL_RADIUS - 9, d.WHEEL_WIDTH)
        .edges()
        .filter_by(bd.GeomType.CIRCLE)
        .sort_by(bd.SortBy.RADIUS)[-2:],
        3,
    )
    grooves = [
        bd.Rot(0, 0, 15 * i) * at(bd.Box(4, 3, 9), (d.WHEEL_RADIUS, 0, z))
        for i in range(24)
        for z in (4.5, d.WHEEL_WIDTH - 4.5)
    ]
    return at(body - grooves, (0, 0, -half))


def machine() -> Machine:
    """The base with everything bolted to it, two wheels, the balls of the casters."""
    deck = part("lower deck", draw_lower_deck(), METAL, shapes.DARK)
    top = part("upper deck", draw_upper_deck(), METAL, shapes.LIGHT)
    post = part("post", draw_post(), METAL)
    bumper = part("bumper", draw_bumper(), PLASTIC, shapes.ORANGE)
    motor = part("gear motor", draw_motor(), DRIVE)
    mount = part("motor mount", draw_mount(), METAL, shapes.LIGHT)
    battery = part("battery", draw_battery(), DRIVE, shapes.BLUE)
    computer = part("computer", draw_computer(), METAL, shapes.BLACK)
    cup = part("caster housing", draw_caster_housing(), PLASTIC, shapes.DARK)
    lidar = part("lidar", draw_lidar(), PLASTIC, shapes.BLACK)
    camera = part("camera", draw_camera(), METAL, shapes.WHITE)
    camera_foot = part("camera foot", draw_camera_foot(), PLASTIC, shapes.DARK)
    rim = part("rim", draw_rim(), METAL, shapes.LIGHT)
    tyre = part("tyre", draw_tyre(), RUBBER)
    ball = part("ball", bd.Sphere(d.CASTER_RADIUS), STEEL, shapes.LIGHT)

    floor = d.LOWER_DECK + d.DECK
    inside = d.TRACK / 2 - d.WHEEL_WIDTH / 2 - 6
    drives = [pose((0, side * inside, d.WHEEL_RADIUS), turn("x", side * pi / 2)) for side in d.SIDES.values()]
    # The cup of the front caster is let into the deck as far as its ball is above the floor.
    cups = [d.caster_place("caster"), d.caster_place("front_caster")]
    fixed = [
        (deck, [pose((0, 0, d.LOWER_DECK))]),
        (top, [pose((0, 0, d.UPPER_DECK))]),
        (post, [pose((x, y, floor)) for x, y in _POSTS]),
        (bumper, [pose((0, 0, d.LOWER_DECK - 6))]),
        (motor, drives),
        (mount, [pose((0, side * (inside - d.GEAR_LENGTH - 14), d.WHEEL_RADIUS)) for side in d.SIDES.values()]),
        (battery, [pose((d.BATTERY_X, 0, floor))]),
        (computer, [pose((d.COMPUTER_X, 0, floor))]),
        (cup, cups),
        (lidar, [pose((d.LIDAR_X, 0, d.UPPER_DECK + d.DECK))]),
        (camera, [d.camera_place()]),
        (camera_foot, [pose((float(d.camera_place()[0, 3]), 0, floor))]),
    ]
    X_WB = d.base_place()
    base = [one for product, places in fixed for one in placed(product, *(inverse(X_WB) @ X for X in places))]
    wheels = [
        Link(f"{name}_wheel", d.wheel_place(side), [*placed(rim), *placed(tyre)]) for name, side in d.SIDES.items()
    ]
    balls = [Link(f"{name}_ball", d.caster_place(name), placed(ball)) for name in d.CASTERS]
    joints = {f"{name}_axle": JointFrame(d.wheel_place(side)) for name, side in d.SIDES.items()}
    return Machine(
        "diff_drive",
        (Link("base_link", X_WB, base), *wheels, *balls),
        {**joints, **{name: JointFrame(d.caster_place(name)) for name in d.CASTERS}},
        closed_form.known(),
    )


if __name__ == "__main__":
    draw(__file__, machine)
