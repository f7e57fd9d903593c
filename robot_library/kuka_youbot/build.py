"""Draw the KUKA youBot: ``python -m robot_library.kuka_youbot.build`` in the root of the checkout.

Writes youbot.step beside this file; every run gives the same bytes. Each link is drawn in its own frame [mm].

Wheel places, wheel radius and the distances between joints come from the joint table and the collision shapes in
expected.json's source. The platform measures 580 x 380 x 140, as in KUKA's data sheet. The side of its joint on which
each link of the arm is follows from the poses of the meshes in that description. The profile of the rollers follows
from the wheel: every point of it touches the cylinder of the wheel's radius. Everything else, and the colours, are
drawn from photographs.
"""

from math import sqrt
from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..limb_parts import across
from ..shapes import (
    ALUMINIUM,
    BLACK,
    DARK,
    LIGHT,
    ORANGE,
    STEEL,
    at,
    block,
    cylinder,
    flange,
    housing,
    hull_plate,
    on_circle,
    turned,
)

GAP = 1.0
"""Clearance between moving and fixed parts."""

PLATFORM = (580.0, 380.0)
FLOOR, CLEARANCE, TOP = -84.0, 20.0, 46.0
"""The ground under the wheels; the platform above it; the plane that arm and plate stand on."""
WHEEL_X, WHEEL_Y, WHEEL_Z = 228.0, 158.0, -34.0
WHEEL_RADIUS, WHEEL_WIDTH = 50.0, 50.0
ROLLERS, ROLLER_PLACE, ROLLER_LENGTH = 6, 38.0, 66.0
HUB_RADIUS, DISC_RADIUS, DISC = 22.0, 34.0, 3.0
DECK = 26.0
PLATE = (240.0, 330.0, 14.0)
LASER = (50.0, 50.0, 70.0)

ARM_BASE = (166.0, 124.0, 44.0)
J1_X, J1_Z, TURN_Z = 24.0, 96.0, -26.0
J2 = (33.0, 19.0)
UPPER_ARM, FOREARM, WRIST = 155.0, 135.0, 130.0
UPPER_SIDE, FORE_SIDE, WRIST_SIDE = (-54.0, -12.0), (8.0, 50.0), (-32.0, 6.0)
"""Extent of the links across their joints: from and to, along y."""
BIG, MEDIUM, SMALL = 34.0, 30.0, 26.0
"""Radii of the drives."""
HAND, FINGERS_Z = 40.0, 46.0
"""Start of the palm behind the hand's frame, and distance of the fingers in front of it."""
PALM, RAIL, RING = (44.0, 96.0, 49.0), 10.0, 4.0
FINGER = (14.0, 18.0, 66.0)


def base_link() -> list[Body]:
    """x forward, z up, the wheels' axes below the origin."""
    length, width = PLATFORM
    low = FLOOR + CLEARANCE
    inner = 2 * (WHEEL_Y - WHEEL_WIDTH / 2) - 12
    deck = at(block(length, width, DECK, 45, only="z"), (0, 0, TOP - DECK))
    deck = bd.chamfer(deck.edges().group_by(bd.Axis.Z)[-1], 8)
    chassis = at(block(length - 30, inner, TOP - DECK - low, 12, only="z"), (0, 0, low))
    between = 2 * (WHEEL_X - WHEEL_RADIUS) - 24
    skirts = []
    for side in (-1, 1):
        depth = (width - inner) / 2 - 4
        skirt = at(block(between, depth, TOP - DECK - low - 8), (0, side * (inner + depth) / 2, low + 8))
        skirts.append(bd.chamfer(skirt.edges().filter_by(bd.Axis.X).group_by(bd.Axis.Z)[0], 14))
    cover = at(block(200, 150, 2, 10, only="z"), (J1_X, 0, TOP - 2))
    panel = at(block(6, 150, 40, 3, only="x"), (-length / 2 + 12, 0, low + 20))
    plugs = [at(block(5, 14, 12), (-length / 2 + 6.5, y, low + 34)) for y in (-50, -25, 0, 25)]
    stripe = [at(block(90, 2, 16), (0, side * (width / 2 - 3), low + 36)) for side in (-1, 1)]
    bolts = [at(cylinder(3.3, 12), (x, y, TOP - 12)) for x in (-40, 90) for y in (-60, 60)]
    deck -= cover
    for bolt in bolts:
        deck, cover = deck - bolt, cover - bolt
    front = at(block(14, inner - 30, 50, 6, only="y"), (length / 2 - 8, 0, low + 6))
    return [
        Body("deck", deck, ORANGE),
        Body("chassis", chassis, DARK),
        Body("cover", cover, BLACK),
        *(Body("skirt", skirt, ORANGE) for skirt in skirts),
        Body("rear panel", panel, BLACK),
        *(Body("socket", plug, ALUMINIUM) for plug in plugs),
        *(Body("label", label, BLACK) for label in stripe),
        Body("front panel", front, BLACK),
    ]


def wheel(hand: int) -> list[Body]:
    """A mecanum wheel about y: six rollers at 45 degrees; ``hand`` is the side to which the upper ones lead.

    Each roller covers 56 of its 60 degrees, so that the wheel sinks by less than 0.1 mm between two of them.
    """
    width = WHEEL_WIDTH - 2 * GAP
    hub = across(cylinder(HUB_RADIUS, width - 2 * DISC), width / 2 - DISC)
    bodies = [Body("hub", hub, ALUMINIUM)]
    for side in (-1, 1):
        disc = flange(DISC_RADIUS, DISC, on_circle(6, 44, 30), 3.0, 6.0)
        bodies.append(Body("disc", at(disc, (0, side * width / 2, 0), (90 * side, 0, 0)), STEEL))
    for i in range(ROLLERS):
        turn = bd.Rot(0, 360 * i / ROLLERS, 0)
        bodies.append(Body("roller", turn * at(roller(), (0, 0, ROLLER_PLACE), (-90, 0, -45 * hand)), BLACK))
    return bodies


def roller() -> bd.Part:
    """A barrel around z that, tilted by 45 degrees, touches the wheel's radius along its whole length."""
    half = ROLLER_LENGTH / 2
    end = WHEEL_RADIUS - sqrt(ROLLER_PLACE**2 + half**2 / 2)
    outline = [
        bd.ThreePointArc((end, -half), (WHEEL_RADIUS - ROLLER_PLACE, 0), (end, half)).edge(),
        *bd.Polyline((end, half), (0, half), (0, -half), (end, -half)).edges(),
    ]
    return turned(bd.Wire(outline))


def plate_link() -> list[Body]:
    """The load plate on the rear; z up."""
    x, y, z = PLATE
    plate = at(block(x, y, 4, 16, only="z"), (0, 0, z - 4))
    tray = at(block(x - 24, y - 24, 2, 10, only="z"), (0, 0, z - 2))
    posts = [at(cylinder(6, z - 4), (sx * (x / 2 - 22), sy * (y / 2 - 40), 0)) for sx in (-1, 1) for sy in (-1, 1)]
    return [Body("plate", plate - tray, LIGHT), Body("mat", tray, DARK), *(Body("post", post, STEEL) for post in posts)]


def arm_link_0() -> list[Body]:
    """The foot of the arm: z up, bolted to the platform."""
    x, y, z = ARM_BASE
    foot = at(block(x, y, z, 14, only="z"), (0, 0, 0))
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot -= at(cylinder(3.3, z), (sx * (x / 2 - 12), sy * (y / 2 - 12), 0))
    tower = at(housing(52, J1_Z + TURN_Z - GAP - z, 3, 0), (J1_X, 0, z))
    label = at(block(60, 2, 20), (-10, -y / 2 - 1, 12))
    return [Body("foot", foot, DARK), Body("tower", tower, ORANGE), Body("label", label, ORANGE)]


def arm_link_1() -> list[Body]:
    """z up, the shoulder's axis y in front of and above the origin, its drive on the far side of the upper arm."""
    x, z = J2
    table = at(cylinder(52, 10), (0, 0, TURN_Z))
    near, far = UPPER_SIDE[1] + GAP, 48.0
    body = across(hull_plate([((-8, 6), 22), ((x, z), BIG), ((20, 4), 20)], far - near), far)
    body &= at(block(200, 200, 100), (0, 0, TURN_Z + 10))
    cap = at(housing(BIG - 5, 6, 3, 0), (x, far, z), (-90, 0, 0))
    return [Body("table", table, DARK), Body("bracket", body, ORANGE), Body("cap", cap, BLACK)]


def beam(length: float, side: tuple[float, float], first: float, last: float, outside: int) -> list[Body]:
    """A link up the z axis between two joints about y: a plate with round ends, and caps on its outside."""
    low, high = side
    thick = high - low
    shell = across(hull_plate([((0, 0), first), ((0, length), last)], thick), high)
    rim = shell.faces().sort_by(bd.Axis.Y)[-1 if outside > 0 else 0].edges()
    shell = bd.fillet(rim, 7)
    y, turn = (high, -90) if outside > 0 else (low, 90)
    caps = [at(housing(r - 9, 4, 2, 0), (0, y, z), (turn, 0, 0)) for r, z in ((first, 0), (last, length))]
    return [Body("shell", shell, ORANGE), *(Body("cap", cap, BLACK) for cap in caps)]


def drive(radius: float, start: float, end: float, z: float) -> Body:
    """The visible part of a drive about y between two links."""
    return Body("drive", across(cylinder(radius, abs(end - start)), max(start, end), z=z), DARK)


def arm_link_4() -> list[Body]:
    """The wrist: bends about y at the origin, and ends at the joint that turns the hand about z."""
    low, high = WRIST_SIDE
    end = WRIST - HAND - RING - GAP
    width = high - low
    plan = [((0, 0), SMALL), ((-16, end - 20), 10), ((12, end - 20), 10)]
    shell = across(hull_plate(plan, width), high)
    cap = across(housing(SMALL - 8, 4, 2, 0), low)
    head = at(block(56, 60, 24, 12, only="z"), (-2, 0, end - 24))
    shell -= head
    ring = at(cylinder(24, RING), (-2, 0, end))
    motor = at(block(40, 18, end - 24 - SMALL - 2 * GAP, 5, only="z"), (-2, high + 9, SMALL + GAP))
    return [
        Body("shell", shell, ORANGE),
        Body("cap", cap, BLACK),
        drive(SMALL - 4, high, FORE_SIDE[0] - GAP, 0),
        Body("head", head, ORANGE),
        Body("ring", ring, DARK),
        Body("motor", motor, DARK),
    ]


def arm_link_5() -> list[Body]:
    """The hand's turntable; z out of it."""
    shell = at(housing(28, HAND - PALM[2] + FINGERS_Z, 4, 0), (0, 0, -HAND))
    return [Body("shell", shell, BLACK)]


def gripper_palm_link() -> list[Body]:
    """The palm: the fingers slide on it along y."""
    x, y, z = PALM
    palm = at(block(x, y, z - RAIL, 8, only="x"), (0, 0, FINGERS_Z - z))
    rail = at(block(x - 16, y - 6, RAIL), (4, 0, FINGERS_Z - RAIL))
    return [Body("palm", palm, DARK), Body("rail", rail, ALUMINIUM)]


def finger() -> list[Body]:
    """One finger; it opens towards -y, and its tip faces +y."""
    x, y, z = FINGER
    carriage = at(block(x + 6, y, 14, 2, only="z"), (0, -y / 2 + 6, GAP))
    blade = at(block(x, 6, z - 14), (0, 3, 14 + GAP))
    blade = bd.chamfer(blade.edges().filter_by(bd.Axis.X).group_by(bd.Axis.Z)[-1].sort_by(bd.Axis.Y)[:1], 4)
    return [Body("carriage", carriage, STEEL), Body("blade", blade, ALUMINIUM)]


def laser() -> list[Body]:
    """A Hokuyo URG-04LX: 50 x 50 x 70."""
    x, y, z = LASER
    box = at(block(x, y, 0.5 * z, 4, only="z"), (0, 0, -0.4 * z))
    window = at(housing(20, 0.3 * z, 2, 0), (0, 0, 0.1 * z))
    top = at(housing(22, 0.2 * z, 4, 0), (0, 0, 0.4 * z))
    return [Body("box", box, BLACK), Body("window", window, DARK), Body("top", top, BLACK)]


def links() -> dict[str, list[Body]]:
    """The bodies of every link that has a shape, in the link's frame."""
    return {
        "base_link": base_link(),
        "wheel_link_fl": wheel(1),
        "wheel_link_fr": wheel(-1),
        "wheel_link_bl": wheel(-1),
        "wheel_link_br": wheel(1),
        "plate_link": plate_link(),
        "base_laser_front_link": laser(),
        "arm_link_0": arm_link_0(),
        "arm_link_1": arm_link_1(),
        "arm_link_2": [
            *beam(UPPER_ARM, UPPER_SIDE, BIG, MEDIUM, -1),
            drive(MEDIUM - 4, UPPER_SIDE[1], FORE_SIDE[0] - GAP, UPPER_ARM),
        ],
        "arm_link_3": beam(FOREARM, FORE_SIDE, MEDIUM, SMALL, 1),
        "arm_link_4": arm_link_4(),
        "arm_link_5": arm_link_5(),
        "gripper_palm_link": gripper_palm_link(),
        "gripper_finger_link_l": finger(),
        "gripper_finger_link_r": finger(),
    }


def main() -> None:
    """Draw the robot."""
    draw_described(Path(__file__).parent, links())


if __name__ == "__main__":
    main()
