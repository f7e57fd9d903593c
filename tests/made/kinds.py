"""Kinds of mechanisms, each drawn at random into a :class:`~tests.made.kit.Kit` with its true joints [mm]."""

from collections.abc import Callable, Sequence
from math import atan2, cos, hypot, pi, sin
from random import Random

import numpy as np

from robot_library.moments import Array
from tests.solids import Solid, box, cylinder

from . import bought, machines
from .devices import butt_hinges, drawers, neck, stage, tube_stand, turntable
from .kit import SCREWS, Kit, at, drilled, rot
from .still import board, frame

X, Y, Z = np.eye(3)
HERE = np.eye(4)
Point = tuple[float, float]
EARS = [(x, y) for x in (-23.5, 23.5) for y in (-5.0, 5.0)]
RING = [(10 + 7 * cos(a), 7 * sin(a)) for a in np.arange(4) * pi / 2]


class Servo:
    """A servo whose top is z = 0, its output at (10, 0), its ears at z = -10 to -7.5, and its horn."""

    def __init__(self, kit: Kit) -> None:
        self.kit, self.has_horn = kit, kit.rng.random() < 0.75
        case = box(40, 20, 36).at(0, 0, -18)
        for side in (-1, 1):
            case = case + box(7, 20, 2.5).at(side * 23.5, 0, -8.75)
        self.case = drilled(case, *((x, y, 2.2) for x, y in EARS)) + cylinder(3, 4).at(10, 0, 0)
        horn = cylinder(10, 3).at(10, 0, 1) - cylinder(3 + max(0.0, kit.clearance), 3).at(10, 0, 1)
        self.horn = drilled(horn, *((x, y, 0.8) for x, y in RING))

    def place(self, host: str, driven: str, T: Array) -> None:
        """Add it at a pose, screwed into its host, and its joint."""
        self.kit.add(host, "servo", self.case, T)
        if self.has_horn:
            self.kit.add(driven, "horn", self.horn, T)
        for x, y in EARS:
            self.kit.screw(T @ at(x, y, -13), 1.5, 5.5)
        self.kit.joint("revolute", host, driven, (T @ (10, 0, 0, 1))[:3], T[:3, 2])

    def seat(self, thickness: float = 3.0) -> Solid:
        """A plate that carries it, its top at z = -10."""
        plate = (box(62, 40, thickness) - box(40.4, 20.4, thickness)).at(0, 0, -10 - thickness / 2)
        return drilled(plate, *((x, y, 1.6) for x, y in EARS), depth=60)

    def arm(self, reach: float, width: float = 22) -> Solid:
        """A bar on its horn along x, at z = 4 to 8."""
        bar = box(reach + 11, width, 4).at(10 + reach / 2 - 5.5, 0, 6)
        return drilled(bar, *((x, y, 0.8) for x, y in RING)) - cylinder(3.1, 4).at(10, 0, 4)


def servo_arm(kit: Kit) -> None:
    """A planar arm of servos, each in a plate of one link, its horn screwed to the next."""
    servo, T = Servo(kit), HERE
    base = servo.seat() + box(62, 3, 40).at(0, -18.5, -33) + box(62, 3, 40).at(0, 18.5, -33)
    kit.add("base", "base", base + box(80, 60, 4).at(0, 0, -55))
    count = kit.rng.choice((2, 3, 4))
    for n in range(count):
        here, link = "base" if n == 0 else f"link{n}", f"link{n + 1}"
        servo.place(here, link, T)
        T = T @ at(10, 0, 0) @ rot("z", kit.rng.uniform(-1, 1)) @ at(-10, 0, 0)
        reach = kit.rng.uniform(70, 120)
        bar = servo.arm(reach - 31)
        if n + 1 < count:
            bar = bar + servo.seat(4).at(10 + reach, 0, 18)
        kit.add(link, "arm", bar, T)
        for x, y in RING:
            kit.screw(T @ at(x, y, 1), 0.75, 7)
        T = T @ at(10 + reach, 0, 18)


def pan_tilt(kit: Kit) -> None:
    """Two servos with axes at a right angle: a pan bracket carries the tilt servo, which turns a camera plate."""
    servo = Servo(kit)
    base = servo.seat() + box(62, 3, 40).at(0, -18.5, -33) + box(80, 60, 4).at(0, -10, -55)
    kit.add("base", "base", base)
    servo.place("base", "pan", HERE)
    tilt = at(10, 0, 40) @ rot("x", -pi / 2)
    wall = box(62, 40, 3).at(0, 0, -11.5) - box(40.4, 20.4, 3).at(0, 0, -11.5)
    wall = drilled(wall, *((x, y, 1.6) for x, y in EARS), depth=60)
    foot = box(62, 40, 4).at(0, 0, 6)
    kit.add("pan", "bracket", drilled(foot, *((x, y, 0.8) for x, y in RING)) - cylinder(3.1, 4).at(10, 0, 4))
    kit.add("pan", "plate", wall, tilt)
    kit.add("pan", "bracket", box(62, 3, 12).at(10, -11.5 + 1.5, 14))
    servo.place("pan", "tilt", tilt)
    kit.add("tilt", "plate", servo.arm(kit.rng.uniform(30, 50)), tilt)


def servo_legs(kit: Kit) -> None:
    """Four equal legs of two servos each on a plate, mirrored in pairs."""
    servo, (dx, dy) = Servo(kit), (kit.rng.uniform(60, 90), kit.rng.uniform(50, 70))
    body = box(2 * dx + 80, 2 * dy + 60, 3).at(0, 0, -11.5)
    spots = [(dx, dy, 0.4), (-dx, dy, pi - 0.4), (-dx, -dy, pi + 0.4), (dx, -dy, -0.4)]
    seats = [at(x, y, 0) @ rot("z", yaw) for x, y, yaw in spots]
    for T in seats:
        body = body - box(40.4, 20.4, 3).at(0, 0, -11.5).moved(T)
        for x, y in EARS:
            body = body - cylinder(1.6, 3).at(x, y, -13).moved(T)
    kit.add("base", "base", body)
    femur, shin = servo.arm(30) + servo.seat(4).at(10 + 61, 0, 18), servo.arm(70)
    for n, T in enumerate(seats):
        servo.place("base", f"coxa{n}", T)
        kit.add(f"coxa{n}", "leg", femur, T)
        knee = T @ at(71, 0, 18)
        servo.place(f"coxa{n}", f"shin{n}", knee)
        kit.add(f"shin{n}", "leg", shin, knee @ at(10, 0, 0) @ rot("z", 0.5 if n % 2 else -0.5) @ at(-10, 0, 0))


def pin_arm(kit: Kit) -> None:
    """A serial arm of bars, each with a pin at its end for the bore of the next."""
    radius, T = kit.rng.uniform(3, 9), at(0, 0, 20)
    kit.add("base", "base", box(90, 90, 20).at(0, 0, 10) + cylinder(radius, 12).at(0, 0, 20))
    for n in range(kit.rng.choice((2, 3, 4))):
        link, length = f"link{n + 1}", kit.rng.uniform(60, 150)
        kit.joint("revolute", "base" if n == 0 else f"link{n}", link, T[:3, 3], T[:3, 2])
        T = T @ rot("z", kit.rng.uniform(-1.2, 1.2))
        bar = box(length + 24, 24, 12).at(length / 2, 0, 6) + cylinder(radius, 12).at(length, 0, 12)
        kit.add(link, "arm" if n == 0 else "link", bar - cylinder(radius + max(0.0, kit.clearance), 12), T)
        T = T @ at(length, 0, 12)


def bar(kit: Kit, link: str, word: str, ends: Sequence[Point], level: float, radius: float) -> None:
    """A plate of 4 mm through points, with a bore at each, at a height; each later end is joined to the first."""
    solid: Solid | None = None
    x, y = ends[0]
    for u, v in ends[1:]:
        length, angle = hypot(u - x, v - y), atan2(v - y, u - x)
        strip = box(length + 16, 14, 4).at(length / 2, 0, level + 2).moved(at(x, y, 0) @ rot("z", angle))
        solid = strip if solid is None else solid + strip
    assert solid is not None
    kit.add(link, word, drilled(solid, *((u, v, radius) for u, v in ends)))


def pivot(kit: Kit, a: str, b: str, point: Point, low: float, high: float, radius: float) -> None:
    """A joint on a line along z, with a screw through both."""
    kit.joint("revolute", a, b, (*point, low), Z)
    kit.screw(at(*point, low), radius, high - low)


def four_bar(kit: Kit) -> None:
    """A crank, a coupler and a rocker on a ground plate."""
    r, u = kit.rng.choice((1.5, 2.0, 3.0, 3.175)), kit.rng.uniform
    a, b, c, d = (0.0, 0.0), (u(-10, 10), u(35, 60)), (u(100, 140), u(70, 90)), (u(100, 130), u(-10, 10))
    bar(kit, "base", "base", (a, d), 0, r)
    bar(kit, "crank", "crank", (a, b), 4, r)
    bar(kit, "coupler", "link", (b, c), 8, r)
    bar(kit, "rocker", "link", (d, c), 4, r)
    pairs = ("base", "crank", a, 0), ("crank", "coupler", b, 4), ("rocker", "coupler", c, 4), ("base", "rocker", d, 0)
    for one, two, point, low in pairs:
        pivot(kit, one, two, point, low, low + 8, r)


def walker(kit: Kit) -> None:
    """Two mirrored four-bar legs on one crank: a coupler to each leg, which turns on the body."""
    r, u = kit.rng.choice((1.5, 2.0, 3.0)), kit.rng.uniform
    crank, out, hip, knee = u(15, 20), u(55, 70), u(-25, -15), u(20, 30)
    bar(kit, "base", "base", ((0, 0), (-out, hip), (out, hip)), 0, r)
    end = (crank * cos(0.7), crank * sin(0.7))
    bar(kit, "crank", "crank", ((0, 0), end), 4, r)
    pivot(kit, "base", "crank", (0, 0), 0, 8, r)
    for side, level in ((-1, 8.0), (1, 12.0)):
        top, leg = (side * out * 1.05, knee), "left" if side < 0 else "right"
        bar(kit, f"rod_{leg}", "link", (end, top), level, r)
        bar(kit, leg, "leg", ((side * out, hip), top, (side * (out + 20), -90)), 4, r)
        kit.joint("revolute", "base", leg, (side * out, hip, 0), Z)
        kit.joint("revolute", leg, f"rod_{leg}", (*top, 0), Z)
        kit.joint("revolute", "crank", f"rod_{leg}", (*end, 0), Z)
        kit.screw(at(side * out, hip, 0), r, 8)
        kit.add(SCREWS, "pin", cylinder(r, level), at(*top, 4))
    kit.add(SCREWS, "pin", cylinder(r, 12), at(*end, 4))


def slider_crank(kit: Kit) -> None:
    """A crank, a rod and a piston between two guides."""
    r, length, angle = 3.0, kit.rng.uniform(90, 130), kit.rng.uniform(0.4, 2.6)
    end = (25 * cos(angle), 25 * sin(angle))
    s = end[0] + (length**2 - end[1] ** 2) ** 0.5
    base = drilled(box(300, 60, 6).at(80, 0, -3), (0, 0, r))
    for side in (-1, 1):
        base = base + box(140, 10, 16).at(150, side * 20, 8)
    kit.add("base", "base", base)
    bar(kit, "crank", "crank", ((0, 0), end), 0, r)
    bar(kit, "rod", "link", (end, (s, 0)), 16, r)
    piston = box(40, 30, 16).at(s, 0, 8)
    kit.add("piston", "carriage", drilled(piston, (s, 0, r)))
    kit.add(SCREWS, "pin", cylinder(r, 20), at(*end, 0))
    pivot(kit, "base", "crank", (0, 0), -6, 4, r)
    pivot(kit, "rod", "piston", (s, 0), 0, 20, r)
    kit.joint("revolute", "crank", "rod", (*end, 0), Z)
    kit.joint("prismatic", "base", "piston", (s, 0, 0), X)


def _gear(radius: float, teeth: int) -> Solid:
    """A disc of 6 mm with teeth of boxes."""
    gear = cylinder(radius - 1, 6)
    for n in range(teeth):
        tooth = box(2.2, radius * 0.08 + 1, 6).at(radius - 0.6, 0, 3)
        gear = gear + tooth.moved(rot("z", 2 * pi * n / teeth))
    return gear


def gear_gripper(kit: Kit) -> None:
    """Two meshing gears on a palm, one on a servo, each with a finger on a parallelogram."""
    servo, r = Servo(kit), 2.0
    gap, out, reach = 15.0, kit.rng.uniform(30, 40), kit.rng.uniform(45, 60)
    palm = box(70, 120, 3).at(5, 0, -11.5) - box(40.4, 20.4, 3).at(0, -gap, -11.5)
    holes = [(x, y - gap, 1.6) for x, y in EARS] + [(10, gap, r), (30, -gap - 5, r), (30, gap + 5, r)]
    kit.add("base", "base", drilled(palm, *holes, depth=60))
    servo.place("base", "gear_a", at(0, -gap, 0))
    kit.add(SCREWS, "pin", cylinder(r, 26), at(10, gap, -13))
    kit.joint("revolute", "base", "gear_b", (10, gap, 0), Z)
    for name, side in (("a", -1), ("b", 1)):
        hub = (10.0, side * gap)
        tip = (hub[0] + 18, hub[1] + side * out)
        gear = _gear(15, 24).at(*hub, 4) + box(hypot(18, out) + 8, 8, 3).at(0, 0, 11.5).moved(
            at((hub[0] + tip[0]) / 2, (hub[1] + tip[1]) / 2, 0) @ rot("z", atan2(tip[1] - hub[1], 18))
        )
        own = [(*tip, r), (*hub, r if side > 0 else 3.1)]
        kit.add(f"gear_{name}", "gear", drilled(gear, *own))
        foot, knee = (30.0, side * (gap + 5)), (48.0, side * (gap + 5 + out))
        bar(kit, f"bar_{name}", "link", (foot, knee), -10, r)
        bar(kit, f"finger_{name}", "finger", (tip, knee, (knee[0] + reach, knee[1])), 13, r)
        kit.add(SCREWS, "pin", cylinder(r, 27), at(*knee, -10))
        kit.add(SCREWS, "pin", cylinder(r, 7), at(*tip, 10))
        kit.screw(at(*foot, -13), r, 7)
        kit.joint("revolute", "base", f"bar_{name}", (*foot, 0), Z)
        kit.joint("revolute", f"bar_{name}", f"finger_{name}", (*knee, 0), Z)
        kit.joint("revolute", f"gear_{name}", f"finger_{name}", (*tip, 0), Z)


def wheeled(kit: Kit) -> None:
    """A chassis with two or four geared motors in brackets, each with a wheel of rim and tyre."""
    rng, count = kit.rng, kit.rng.choice((1, 2))
    width, length = rng.uniform(100, 150), rng.uniform(140, 200)
    kit.add("base", "base", box(length, width, 4).at(0, 0, 30))
    kit.add("base", "cover", box(length * 0.5, width * 0.6, 30).at(0, 0, 47))
    motor = cylinder(12, 40) + cylinder(2, 12).at(0, 0, 40)
    clamp = box(30, 30, 10).at(0, 0, 5) - cylinder(12, 10)
    rim = cylinder(24, 18) - cylinder(2 + max(0.0, kit.clearance), 18)
    tyre = cylinder(32, 18) - cylinder(24, 18)
    for n in range(count):
        for side in (-1, 1):
            x = 0.0 if count == 1 else (n - 0.5) * length * 0.6
            T = at(x, side * (width / 2 - 42), 13) @ rot("x", -side * pi / 2)
            kit.add("base", "motor", motor, T)
            kit.add("base", "bracket", clamp, T @ at(0, 0, 20))
            wheel = f"wheel{n}{side}"
            kit.add(wheel, "rim", rim, T @ at(0, 0, 43))
            kit.add(wheel, "tyre", tyre, T @ at(0, 0, 43))
            kit.joint("revolute", "base", wheel, T[:3, 3], T[:3, 2])


def quadruped(kit: Kit) -> None:
    """A torso with four legs of thigh and shank on pins, left ones mirrored; one leg may be placed 0.3 mm off."""
    c, sloppy = max(0.0, kit.clearance), kit.rng.random() < 0.5
    long, wide, thigh = kit.rng.uniform(160, 240), kit.rng.uniform(70, 110), kit.rng.uniform(60, 90)
    torso = box(long + 40, wide, 50)
    spots = [(s * long / 2, t) for s in (-1, 1) for t in (-1, 1)]
    for x, t in spots:
        torso = torso - cylinder(5 + c, 14).moved(at(x, t * wide / 2, 0) @ rot("x", t * pi / 2))
    kit.add("base", "base", torso)
    for n, (x, t) in enumerate(spots):
        off = at(0.3, 0, 0.2) if sloppy and n == 3 else HERE
        T = off @ at(x, t * wide / 2, 0) @ rot("y", 0.4 if x > 0 else -0.4)
        out = rot("x", -t * pi / 2)
        upper = box(24, 10, thigh + 24).at(0, t * 5, -thigh / 2)
        upper = upper + cylinder(5, 12).moved(rot("x", t * pi / 2))
        upper = upper - cylinder(4 + c, 10).moved(at(0, 0, -thigh) @ out)
        kit.add(f"thigh{n}", "leg", upper, T)
        K = T @ at(0, t * 10, -thigh) @ rot("y", -0.8 if x > 0 else 0.8)
        lower = box(18, 8, 90).at(0, t * 4, -36) + cylinder(4, 10).moved(rot("x", t * pi / 2))
        kit.add(f"shank{n}", "leg", lower, K)
        kit.joint("revolute", "base", f"thigh{n}", T[:3, 3], Y)
        kit.joint("revolute", f"thigh{n}", f"shank{n}", K[:3, 3], Y)


def rods(kit: Kit) -> None:
    """A carriage with two bores, with or without bushings, on two rods between two blocks on a plate."""
    r, length = kit.rng.choice((3.0, 4.0, 6.0)), kit.rng.uniform(200, 320)
    gap = kit.rng.uniform(40, 60)
    kit.add("base", "base", box(length + 20, 110, 8).at(0, 0, -4))
    block = box(15, 100, 40)
    for side in (-1, 1):
        block = block - cylinder(r, 15).moved(at(-7.5, side * gap / 2, 0) @ rot("y", pi / 2))
    for side in (-1, 1):
        kit.add("base", "bracket", block, at(side * length / 2, 0, 20))
        kit.add("base", "rail", cylinder(r, length + 15), at(-length / 2 - 7.5, side * gap / 2, 20) @ rot("y", pi / 2))
    carriage = box(60, gap + 6 * r, 5 * r + 4)
    bush = kit.rng.random() < 0.5
    bore = 2 * r if bush else r + max(0.0, kit.clearance)
    for side in (-1, 1):
        carriage = carriage - cylinder(bore, 60).moved(at(-30, side * gap / 2, 0) @ rot("y", pi / 2))
    T = at(kit.rng.uniform(-50, 50), 0, 20)
    kit.add("carriage", "carriage", carriage, T)
    for side in (-1, 1) if bush else ():
        liner = cylinder(2 * r, 40) - cylinder(r + max(0.0, kit.clearance), 40)
        kit.add("carriage", "bearing", liner, T @ at(-20, side * gap / 2, 0) @ rot("y", pi / 2))
    kit.joint("prismatic", "base", "carriage", T[:3, 3], X)


def profile_rail(kit: Kit) -> None:
    """A rail screwed to a plate, and a carriage around it."""
    length = kit.rng.uniform(150, 300)
    kit.add("base", "base", box(length + 40, 80, 10).at(0, 0, -5))
    rail = box(length, 12, 5).at(0, 0, 2.5) + box(length, 8, 4).at(0, 0, 7) + box(length, 12, 4).at(0, 0, 11)
    kit.add("base", "rail", drilled(rail, *((x, 0, 1.6) for x in (-length / 3, 0.0, length / 3))))
    c, T = max(0.0, kit.clearance), at(kit.rng.uniform(-40, 40), 0, 0)
    carriage = box(40, 30, 14).at(0, 0, 13) - box(40, 12 + 2 * c, 4 + c).at(0, 0, 11 + c / 2)
    carriage = carriage - box(40, 8 + 2 * c if kit.rng.random() < 0.6 else 12 + 2 * c, 3).at(0, 0, 7.5)
    kit.add("carriage", "carriage", carriage, T)
    kit.add("carriage", "plate", box(60, 60, 5).at(0, 0, 22.5), T)
    kit.joint("prismatic", "base", "carriage", T[:3, 3], X)


def telescope(kit: Kit) -> None:
    """Square tubes in each other."""
    kit.add("base", "base", box(120, 120, 10).at(0, 0, -5))
    width, z, stages = kit.rng.uniform(40, 60), 0.0, kit.rng.choice((2, 3))
    for n in range(stages):
        link = "base" if n == 0 else f"tube{n}"
        kit.add(link, "tube", (box(width, width, 200) - box(width - 6, width - 6, 200)).at(0, 0, 100), at(0, 0, z))
        if n:
            kit.joint("prismatic", "base" if n == 1 else f"tube{n - 1}", link, (0, 0, z), Z)
        width, z = width - 6 - 2 * max(0.0, kit.clearance), z + kit.rng.uniform(60, 140)


def hinged_lid(kit: Kit) -> None:
    """A box and a lid with knuckles on one pin."""
    r, width = kit.rng.uniform(2, 4), kit.rng.uniform(80, 140)
    case = box(width, 80, 50).at(0, 0, 25) - box(width - 8, 72, 46).at(0, 0, 27)
    lid = box(width, 80, 5).at(0, 0, 52.5)
    knuckle = cylinder(3 * r, width / 5).moved(rot("y", pi / 2))
    for n in range(5):
        place = at(-width / 2 + n * width / 5, 40 + 3 * r, 50)
        web = box(width / 5, 3 * r, 3).at(width / 10, -1.6 * r, 1.5 if n % 2 else -1.5)
        piece = (knuckle + web - cylinder(r, width / 5).moved(rot("y", pi / 2))).moved(place)
        case, lid = (case, lid + piece) if n % 2 else (case + piece, lid)
    kit.add("base", "base", case)
    kit.add("lid", "cover", lid)
    kit.add(SCREWS, "pin", cylinder(r, width).moved(rot("y", pi / 2)), at(-width / 2, 40 + 3 * r, 50))
    kit.joint("revolute", "base", "lid", (0, 40 + 3 * r, 50), X)


def belt(kit: Kit) -> None:
    """Two shafts in bearings in two plates, each with a pulley; the second carries an arm."""
    away = kit.rng.uniform(80, 120)
    posts = [(x, y, 2.0) for x in (-20, away + 20) for y in (-20, 20)]
    plate = drilled(box(away + 60, 60, 7).at(away / 2, 0, 3.5), (0, 0, 11), (away, 0, 11), *posts)
    kit.add("base", "base", plate)
    kit.add("base", "plate", plate, at(0, 0, 47))
    for x, y, r in posts:
        kit.add("base", "bracket", cylinder(5, 40) - cylinder(r, 40), at(x, y, 7))
    bearing = cylinder(11, 7) - cylinder(4, 7)
    for n, x in enumerate((0.0, away)):
        link = f"shaft{n}"
        for z in (0, 47):
            kit.add(SCREWS, "bearing", bearing, at(x, 0, z))
        kit.add(link, "shaft", cylinder(4, 75), at(x, 0, -5))
        kit.add(link, "pulley", cylinder(15 + 6 * n, 10) - cylinder(4, 10), at(x, 0, 20))
        kit.joint("revolute", "base", link, (x, 0, 0), Z)
    arm = box(90, 20, 8).at(35, 0, 4) - cylinder(4, 8)
    kit.add("shaft1", "arm", arm, at(away, 0, 58) @ rot("z", kit.rng.uniform(-1, 1)))


def scara(kit: Kit) -> None:
    """A column, two arms on bosses, and a quill that slides in the second."""
    r, a, b = 12.0, kit.rng.uniform(100, 140), kit.rng.uniform(80, 120)
    column = cylinder(25, 150).at(0, 0, 15) + cylinder(r, 20).at(0, 0, 165)
    kit.add("base", "base", box(120, 120, 15).at(0, 0, 7.5) + column)
    c = max(0.0, kit.clearance)
    first = box(a + 50, 50, 20).at(a / 2, 0, 10) - cylinder(r + c, 20) + cylinder(r, 20).at(a, 0, 20)
    T = at(0, 0, 165) @ rot("z", kit.rng.uniform(-1, 1))
    kit.add("upper", "arm", first, T)
    U = T @ at(a, 0, 20) @ rot("z", kit.rng.uniform(-1, 1))
    second = box(b + 40, 40, 20).at(b / 2, 0, 10) - cylinder(r + c, 20)
    kit.add("fore", "arm", second - box(12 + 2 * c, 12 + 2 * c, 20).at(b, 0, 10), U)
    kit.add("quill", "shaft", box(12, 12, 120), U @ at(b, 0, 10))
    kit.joint("revolute", "base", "upper", T[:3, 3], Z)
    kit.joint("revolute", "upper", "fore", U[:3, 3], Z)
    kit.joint("prismatic", "fore", "quill", (U @ at(b, 0, 0))[:3, 3], Z)


_FIRST = (
    *(servo_arm, pan_tilt, servo_legs, pin_arm, four_bar, walker, slider_crank, gear_gripper, wheeled, quadruped),
    *(rods, profile_rail, telescope, hinged_lid, belt, scara, frame, board),
)
_FURTHER = (
    *(machines.cheek_quadruped, machines.box_hexapod, machines.harmonic_arm, machines.forked_wheels, drawers, neck),
    *(machines.side_by_side, stage, machines.five_bar, machines.excavator, turntable, butt_hinges),
    *(machines.rocker_bogie, tube_stand),
)
_BOUGHT = (
    *(bought.corexy, bought.v_slot, bought.rack_gripper, bought.coaxial_legs, bought.spline_scara),
    *(bought.bearing_pan_tilt, bought.knee_brace, bought.dovetail_stage, bought.printed_arm, bought.hub_drive),
)
_LATEST = (machines.module_arm,)
KINDS: dict[str, Callable[[Kit], None]] = {one.__name__: one for one in (*_FIRST, *_FURTHER, *_BOUGHT, *_LATEST)}
ASIDE = frozenset(Random(20261124).sample(sorted(one.__name__ for one in _FIRST), len(_FIRST) // 3))
ASIDE_LATER = frozenset(Random(112420262).sample(sorted(one.__name__ for one in _FURTHER), 4))
ASIDE_BOUGHT = frozenset(Random(181120263).sample(sorted(one.__name__ for one in _BOUGHT), 3))
"""Of the first kinds, of the further ones and of robots of bought parts, by lot, before any of these was drafted."""
ASIDE_LATEST = frozenset(one.__name__ for one in _LATEST)
"""Drawn, to be looked at once, before rules were set on those of ``ASIDE_BOUGHT``, too."""
MESSY = frozenset(one.__name__ for one in (*_BOUGHT, *_LATEST))
"""Kinds whose tree may be an import."""
VARIED = frozenset(one.__name__ for one in _FURTHER) | MESSY
"""Kinds in further styles: one coordinate system, bodies of one product, subassemblies of what is bought."""
