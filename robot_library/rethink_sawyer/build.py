"""Draw Sawyer on its pedestal: ``python -m robot_library.rethink_sawyer.build`` in the root of the checkout.

Writes sawyer.step beside this file; every run gives the same bytes. Each link is drawn in its own frame [mm].

Distances between joints come from the joint table in expected.json. The controller's box, the footprint and the height
of the pedestal are those of the collision shapes in the same description (sawyer_description/urdf). Radii and lengths
of barrels and tubes are those of the capsules around the maker's meshes in MuJoCo Menagerie, rethink_robotics_sawyer;
the maker's own collision shapes are wider than its links, by 5 to 15 mm. Where links and shells end, how far the ends
of barrels are round, and the flat end of the forearm's tube, which passes the shoulder by a millimetre, are measured on
the maker's meshes of right_l0, right_l1, right_l3 and right_l4. Width and height of the head are those of its mesh,
those of the display those of its visual. Transitions between barrels, bolts, face and colours are from photographs.
"""

from dataclasses import dataclass
from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..limb_parts import across
from ..shapes import (
    ALUMINIUM,
    BLACK,
    DARK,
    WHITE,
    at,
    block,
    cylinder,
    flange,
    housing,
    hull_plate,
    lathe,
    on_circle,
    tube,
)

RED = "#9c1c1f"
"""Of the shells."""
GREY = "#55585d"
"""Of caps and cuffs."""
GAP = 1.5
"""Clearance between turning and fixed shells."""
RECESS = 5.0
"""Depth of the black rings between shells."""

TURRET, TURRET_START, TURRET_RING = 68.0, 80.0, 13.0
SHOULDER, SHOULDER_PLACE, NECK, HEAD = 70.0, (81.0, 50.0, 237.0), 42.0, 296.5
FLOOR = -914.9
COLUMN, COLUMN_X, PLINTH = 130.0, -20.0, 110.0
LEG_FLOOR = 95.0
BOX, BOX_PLACE = (220.0, 400.0, 530.0), (-325.0, 0.0, -380.0)
FOOTPRINT, FOOTPRINT_X = (770.0, 700.0), -122.5
DISPLAY = (240.0, 140.0, 2.0)


@dataclass(frozen=True)
class Segment:
    """A pair of links: one bends about its barrel, the other turns at its end about its own tube."""

    barrel: float
    """Radius."""
    start: float
    """From the bending joint's origin along its axis to the barrel; the barrel's other end is past the boss."""
    boss: float
    """Radius of the boss that carries the next joint."""
    height: float
    """From the bending joint's origin along its axis to the axis of the turning joint; negative behind the origin."""
    boss_end: float
    """From the bending joint's axis to the end of the boss."""
    ring_end: float
    """And to the end of the ring on it, where the turning link starts."""


UPPER = Segment(barrel=67, start=23, boss=54, height=142.5, boss_end=108, ring_end=138)
MIDDLE = Segment(barrel=52, start=-12.5, boss=44, height=-126.5, boss_end=101.5, ring_end=122.5)
LOWER = Segment(barrel=42, start=GAP, boss=42, height=105.3, boss_end=70, ring_end=82)


@dataclass(frozen=True)
class Tube:
    """The tube of a turning link, along z."""

    start: float
    """Radius at its start."""
    middle: float
    back: float
    """From its joint back to the bending joint's axis."""
    reach: float
    """From its joint forth to the next one."""
    across: float
    """From its axis to the plane of the next joint, along y."""
    end: tuple[float, float, float]
    """At its end: half widths along x and y, and the y of its middle."""


UPPER_ARM = Tube(start=54, middle=48, back=140, reach=260, across=42, end=(48, 48, 0))
FOREARM = Tube(start=41, middle=36, back=125, reach=275, across=-31, end=(36, 30.5, -4))
CROWN, DOME = 0.72, 0.82
"""Height of a barrel's free end above the axis of the tube that it crosses, and its rounding; shares of its radius."""
FLANGE_END, FLANGE_RADIUS, FLANGE_BOLTS, FLANGE_BOLT = 24.5, 38.0, 63.0, 3.0


def pedestal() -> list[Body]:
    """z up, its top at z = 0."""
    low = FLOOR + LEG_FLOOR
    end = low + PLINTH
    column = at(block(2 * COLUMN, 2 * COLUMN, -end - 24, 45, only="z"), (COLUMN_X, 0, end))
    top = at(block(2 * COLUMN + 60, 2 * COLUMN + 60, 24, 40, only="z"), (COLUMN_X, 0, -24))
    for x, y in on_circle(8, 230, 22.5):
        top -= bd.Pos(x, y, -12) * cylinder(4.5, 12)
    x, y, z = BOX
    px, py, pz = BOX_PLACE
    box = at(block(x - 45, y, z, 15), (px - 22.5, py, pz - z / 2))
    vents = [at(block(4, 0.7 * y, 9), (px - x / 2 - 2, 0, pz - 150 + 30 * i)) for i in range(6)]
    bracket = at(block(45 + 20, 180, 400, 0), (px + x / 2 - 12.5, 0, pz - 200)) - column - box
    width, depth = FOOTPRINT[1] - 90, FOOTPRINT[0] - 90
    plinth = at(block(330, 330, PLINTH, 20, only="z"), (COLUMN_X, 0, low))
    bodies = [Body("column", column, DARK), Body("top", top, BLACK), Body("plinth", plinth, BLACK)]
    bodies += [Body("controller", box, GREY), Body("bracket", bracket, BLACK)]
    bodies += [Body("vent", vent, BLACK) for vent in vents]
    for sx in (-1, 1):
        for sy in (-1, 1):
            tip = (FOOTPRINT_X + sx * depth / 2, sy * width / 2)
            root = (COLUMN_X + sx * 110, sy * 110)
            leg = at(hull_plate([(root, 45), (tip, 34)], 70), (0, 0, low + 20)) - plinth
            foot = at(lathe([(45, 0), (45, 8), (20, 22), (12, 24), (12, LEG_FLOOR + 20)]), (*tip, FLOOR))
            bodies += [Body("leg", leg, DARK), Body("foot", foot, ALUMINIUM)]
    return bodies


def right_arm_base_link() -> list[Body]:
    """z up: the plate bolted to the pedestal, and the seat of the turret."""
    plate = flange(115, 16, on_circle(8, 200, 0), 4.5)
    seat = at(lathe([(100, 0), (92, 40), (84, TURRET_START - 16 - GAP)], smooth=False), (0, 0, 16))
    return [Body("plate", plate, BLACK), Body("seat", seat, DARK)]


def right_l0() -> list[Body]:
    """z up: the turret, the drum of the shoulder, which faces +y, and the neck."""
    x, y, z = SHOULDER_PLACE
    inner, outer = -92.0, y - GAP
    turret = lathe([(TURRET, TURRET_RING), (TURRET, 60), (66, 110), (60, 150)])
    leaning = across(hull_plate([((0, 95), 62), ((x, z), SHOULDER - 6)], outer - inner - 40), outer - 20)
    drum = across(housing(SHOULDER, outer - inner, 20, 0), outer, x, z)
    neck = at(lathe([(62, 0), (56, 60), (NECK, 110), (NECK, HEAD - 130 - GAP)]), (0, 0, 130))
    cap = across(housing(48, 8, 4, 0), inner, x, z)
    shell = turret + leaning + drum + neck
    rings = [cylinder(TURRET - 2 * RECESS, TURRET_RING)]
    rings.append(across(cylinder(SHOULDER - 3 * RECESS, UPPER.start), y - GAP + UPPER.start, x, z))
    return [Body("shell", shell, RED), Body("cap", cap, GREY), *(Body("ring", ring, BLACK) for ring in rings)]


def head() -> list[Body]:
    """z up: a display that faces x, the light on top, the camera above the display."""
    stem = lathe([(NECK, 0), (NECK, 14), (34, 24), (34, 60)])
    back = at(block(52, 236, 168, 24, only="x"), (-8, 0, 26))
    bezel = at(block(11, 262, 176, 9, only="x"), (23.5, 0, 22))
    panel = at(block(DISPLAY[2] + 8, DISPLAY[0], DISPLAY[1]), (29, 0, 105 - DISPLAY[1] / 2))
    bezel -= panel
    brow = at(block(34, 66, 34, 10), (6, 0, 194))
    lens = at(cylinder(9, 5), (23, 0, 216), (0, 90, 0))
    light = at(housing(24, 12, 6, 0), (4, 0, 228))
    return [
        Body("stem", stem, DARK),
        Body("back", back - stem, RED),
        Body("bezel", bezel - back, BLACK),
        Body("brow", brow, RED),
        Body("lens", lens - brow, BLACK),
        Body("light", light, "#58c26a"),
    ]


def screen() -> list[Body]:
    """x to the robot's left, y up, z out of the display: its face."""
    panel = at(block(*DISPLAY), (0, 0, -DISPLAY[2] / 2))
    top = DISPLAY[2] / 2
    bodies = [Body("panel", panel, "#1b2733")]
    for side in (-1, 1):
        eye = at(bd.extrude(bd.Ellipse(30, 36), 0.4), (side * 52, -4, top))
        iris = at(cylinder(17, 0.4), (side * 48, -12, top + 0.4))
        pupil = at(cylinder(8.5, 0.4), (side * 48, -12, top + 0.8))
        brow = at(block(58, 7, 0.4, 3, only="z"), (side * 54, 50, top), (0, 0, -side * 10))
        bodies += [Body("eye", eye, WHITE), Body("iris", iris, "#4f8fb0"), Body("pupil", pupil, BLACK)]
        bodies.append(Body("brow", brow, WHITE))
    return bodies


def bending_link(s: Segment) -> list[Body]:
    """A link that turns about its barrel, z, and carries the next joint on a boss along -y."""
    far = s.height + (CROWN if s.height > 0 else -CROWN) * s.barrel
    low, high = sorted((s.start, far))
    dome = DOME * s.barrel
    rims = (dome, 12.0) if s.height > 0 else (12.0, dome)
    barrel = at(housing(s.barrel, high - low, *rims), (0, 0, low))
    boss = across(housing(s.boss, s.boss_end, 3, 0), 0, z=s.height)
    ring = across(cylinder(s.boss - RECESS, s.ring_end - s.boss_end), -s.boss_end, z=s.height)
    end = high if s.height > 0 else low
    cap = at(housing(0.25 * s.barrel, 6, 3, 0), (0, 0, end), (0 if s.height > 0 else 180, 0, 0))
    return [Body("shell", barrel + boss, RED), Body("cap", cap, GREY), Body("ring", ring, BLACK)]


def turning_link(before: Segment, bend: Segment, t: Tube) -> list[Body]:
    """A link that turns about its tube, z, and ends in a drum about y, on the side of the next joint."""
    first = before.ring_end + GAP - t.back
    side = 1 if t.across > 0 else -1
    stem = lathe([(t.start, first), (t.start, first + 40), (t.middle, first + 90)])
    half_x, half_y, y = t.end
    flat = ((0.7 * t.reach, half_x), (t.reach, min(half_x, bend.barrel - 6)))
    sections = [bd.Plane((0, 0, first + 90)) * bd.Circle(t.middle)]
    sections += [bd.Plane((0, y, z)) * bd.Ellipse(x, half_y) for z, x in flat]
    stem += bd.loft(sections, ruled=True)
    depth = abs(t.across) - GAP
    radius, crown = bend.barrel - 5, CROWN * bend.barrel
    drum = at(housing(radius, depth + crown, DOME * radius, 9), (0, 0, 0), (-90 * side, 0, 0))
    drum = at(drum, (0, -side * depth, t.reach))
    cap = at(housing(0.25 * bend.barrel, 6, 3, 0), (0, side * crown, t.reach), (-90 * side, 0, 0))
    ring = at(tube(t.start + 1.5, t.start, 12), (0, 0, first))
    return [Body("shell", stem + drum, RED), Body("cap", cap, GREY), Body("ring", ring, BLACK)]


def right_l5() -> list[Body]:
    """The wrist: as the other bending links, with the camera of the hand."""
    bodies = bending_link(LOWER)
    camera = at(cylinder(8, 10), (37, -33, 69.5), (0, 90, 0)) - bodies[0].shape
    return [*bodies, Body("camera", camera, BLACK)]


def right_l6() -> list[Body]:
    """The last link, with the cuff for hand guiding: z out of the flange."""
    start = LOWER.ring_end + GAP - 110
    body = at(lathe([(45, 0), (45, 26), (FLANGE_RADIUS, 34), (FLANGE_RADIUS, FLANGE_END - 6 - start)]), (0, 0, start))
    plate = at(flange(FLANGE_RADIUS + 2, 6, on_circle(4, FLANGE_BOLTS, 45), FLANGE_BOLT, 12), (0, 0, FLANGE_END - 6))
    button = at(housing(9, 5, 2, 0), (0, 44, start + 13), (-90, 0, 0)) - body
    return [Body("cuff", body, DARK), Body("flange", plate, ALUMINIUM), Body("button", button, "#58c26a")]


def links() -> dict[str, list[Body]]:
    """The bodies of every link that has a shape, in the link's frame."""
    return {
        "pedestal": pedestal(),
        "right_arm_base_link": right_arm_base_link(),
        "right_l0": right_l0(),
        "head": head(),
        "screen": screen(),
        "right_l1": bending_link(UPPER),
        "right_l2": turning_link(UPPER, MIDDLE, UPPER_ARM),
        "right_l3": bending_link(MIDDLE),
        "right_l4": turning_link(MIDDLE, LOWER, FOREARM),
        "right_l5": right_l5(),
        "right_l6": right_l6(),
    }


def main() -> None:
    """Draw the robot."""
    draw_described(Path(__file__).parent, links())


if __name__ == "__main__":
    main()
