"""Further kinds of machines, unlike those that the first rules were set on, and drawn in more styles.

Each was written, with its truth, before any of them was drafted.
"""

from math import cos, hypot, pi, sin

import numpy as np

from robot_library.moments import Array
from tests.solids import box, cylinder

from .kit import SCREWS, TO_X, Kit, across, at, bolt, circle, drilled, rot

X, Y, Z = np.eye(3)


def cheek_quadruped(kit: Kit) -> None:
    """Four equal legs: a thigh between two cheeks of the body, a shank between those of the thigh, a screw in each."""
    r, t, w, c = kit.rng.choice((1.5, 2.0, 2.5)), 4.0, kit.rng.uniform(8, 14), max(0.0, kit.clearance)
    L, long, wide = kit.rng.uniform(60, 90), kit.rng.uniform(140, 200), kit.rng.uniform(80, 120)
    side = w / 2 + kit.gap + t / 2
    body = box(long + 40, wide + 40, 20).at(0, 0, 30)
    spots = [(s * long / 2, u * wide / 2) for s in (-1, 1) for u in (-1, 1)]
    for x, y in spots:
        for u in (-1, 1):
            body = body + box(20, t, 32).at(x, y + u * side, 4)
        body = body - across(r + c, 40).at(x, y, 0)
    kit.add("base", "body", body)
    thigh = box(20, w, L - 12).at(0, 0, -(L - 12) / 2 + 6) + box(20, 2 * side + t, 8).at(0, 0, -(L - 14))
    for u in (-1, 1):
        thigh = thigh + box(20, t, 29).at(0, u * side, -(L + 10) + 14.5)
    thigh = thigh - across(r + c, 60) - across(r + c, 60).at(0, 0, -L)
    shank = box(16, w, 90).at(0, 0, -37) - across(r + c, 60)
    for n, (x, y) in enumerate(spots):
        T = at(x, y, 0) @ rot("y", kit.rng.uniform(0.2, 0.5) * (1 if x > 0 else -1))
        K = T @ at(0, 0, -L) @ rot("y", kit.rng.uniform(-0.6, -0.2) * (1 if x > 0 else -1))
        kit.add(f"thigh{n}", "leg", thigh, T)
        kit.add(f"shank{n}", "link", shank, K)
        kit.joint("revolute", "base", f"thigh{n}", T[:3, 3], Y)
        kit.joint("revolute", f"thigh{n}", f"shank{n}", K[:3, 3], Y)
        bolt(kit, T, r, 2 * side + t)
        bolt(kit, K, r, 2 * side + t)


def box_hexapod(kit: Kit) -> None:
    """Legs of two servos each: plain boxes with a disk; a bracket on each disk carries the next box."""
    rng, count, has_boss = kit.rng, kit.rng.choice((4, 6)), kit.rng.random() < 0.5
    case = box(40, 20, 38).at(0, 0, -19) + (
        cylinder(6, kit.gap + 0.5).at(10, 0, 0) if has_boss else box(4, 4, 0.5).at(-12, 0, 0.25)
    )
    disk = drilled(cylinder(10, 3).at(10, 0, 0.5 + kit.gap), *((10 + x, y, r) for x, y, r in circle(4, 7, 0.8)))
    radius = 45 + 12 * count
    body = cylinder(radius + 25, 4).at(0, 0, -34)
    seats = [rot("z", 2 * pi * n / count) @ at(radius, 0, 0) for n in range(count)]
    for T in seats:
        body = body - box(40, 20, 4).at(0, 0, -32).moved(T)
    kit.add("base", "body", body)
    high = 3.5 + kit.gap
    bracket = drilled(box(24, 24, 3).at(10, 0, high + 1.5), *((10 + x, y, r) for x, y, r in circle(4, 7, 0.8)))
    bracket = bracket + box(3, 24, 46).at(23.5, 0, high + 23)
    bar = drilled(box(90, 18, 3).at(45, 0, high + 1.5), *((10 + x, y, r) for x, y, r in circle(4, 7, 0.8)))
    for n, seat in enumerate(seats):
        kit.add("base", "servo", case, seat, unit=f"servo A{n}")
        kit.add(f"coxa{n}", "horn", disk, seat, unit=f"servo A{n}")
        P = seat @ at(10, 0, 0) @ rot("z", rng.uniform(-0.3, 0.3)) @ at(-10, 0, 0)
        kit.add(f"coxa{n}", "bracket", bracket, P)
        for x, y, _ in circle(4, 7, 0.8):
            kit.screw(P @ at(10 + x, y, high - 2), 0.8, 5)
        kit.joint("revolute", "base", f"coxa{n}", (seat @ (10, 0, 0, 1))[:3], seat[:3, 2])
        F = P @ at(25, 0, high + 26) @ rot("x", -pi / 2) @ at(20, 0, 10)
        kit.add(f"coxa{n}", "servo", case, F, unit=f"servo B{n}")
        kit.add(f"femur{n}", "horn", disk, F, unit=f"servo B{n}")
        kit.add(f"femur{n}", "leg", bar, F @ at(10, 0, 0) @ rot("z", rng.uniform(0, 0.8)) @ at(-10, 0, 0))
        kit.joint("revolute", f"coxa{n}", f"femur{n}", (F @ (10, 0, 0, 1))[:3], F[:3, 2])


def harmonic_arm(kit: Kit) -> None:
    """Reducers with an output flange each, bolted to a base, and to tubes with flanges and cheeks for the next one."""
    T, count = at(0, 0, 12), kit.rng.choice((2, 3))
    kit.add("base", "base", drilled(box(160, 160, 12).at(0, 0, 6), *circle(8, 40, 2.5)))
    unit = drilled(cylinder(46, 8) + cylinder(34, 44).at(0, 0, 8), *circle(8, 40, 2.5)) - cylinder(
        26 + kit.clearance, 6
    ).at(0, 0, 46)
    output = drilled(cylinder(26, 12 - kit.gap).at(0, 0, 46 + kit.gap), *circle(6, 18, 2.0))
    for n in range(count):
        here, link = "base" if n == 0 else f"link{n}", f"link{n + 1}"
        kit.add(here, "gearbox", unit, T, unit=f"reducer {n}")
        kit.add(link, "flange", output, T, unit=f"reducer {n}")
        for x, y, _ in circle(8, 40, 2.5):
            kit.screw(T @ at(x, y, -8), 2.5, 16)
        kit.joint("revolute", here, link, T[:3, 3], T[:3, 2])
        length = kit.rng.uniform(90, 160)
        U = T @ at(0, 0, 58) @ rot("z", kit.rng.uniform(-1, 1))
        tube = drilled(cylinder(30, 10), *circle(6, 18, 2.0)) + cylinder(24, length).at(0, 0, 10)
        if n + 1 < count:
            plate = cylinder(46, 10).moved(at(34, 0, length) @ TO_X)
            for x, y, r in circle(8, 40, 2.5):
                plate = plate - cylinder(r, 10).moved(at(34, 0, length) @ TO_X @ at(x, y, 0))
            tube = tube + box(34, 30, 30).at(17, 0, length - 5) + plate
        kit.add(link, "tube", tube, U)
        for x, y, _ in circle(6, 18, 2.0):
            kit.screw(U @ at(x, y, -8), 2.0, 18)
        T = U @ at(44, 0, length) @ TO_X


def forked_wheels(kit: Kit) -> None:
    """A cart: wheels on bolts in forks, some of which turn on a vertical bolt."""
    rng, r, c = kit.rng, 4.0, max(0.0, kit.clearance)
    long, wide = rng.uniform(180, 260), rng.uniform(120, 180)
    corners = [(x * long / 2, y * wide / 2) for x in (-1, 1) for y in (-1, 1)]
    swivels = rng.choice((0, 1, 2))
    deck = box(long + 80, wide + 60, 6).at(0, 0, 3)
    holes = [(x + u, y + v, 2.6) for x, y in corners[swivels:] for u in (-14, 14) for v in (-14, 14)]
    deck = drilled(deck, *holes, *((x, y, r + c) for x, y in corners[:swivels]))
    kit.add("base", "body", deck)
    half, out = 12.0 + kit.gap, rng.uniform(0, 25)
    fork = drilled(
        box(40, 2 * half + 6, 4).at(0, 0, -2 - kit.gap), *((u, v, 2.6) for u in (-14, 14) for v in (-14, 14))
    )
    for side in (-1, 1):
        fork = fork + box(26, 3, 50).at(0, side * (half + 1.5), -29 - kit.gap)
    fork = fork - across(r + c, 60).at(0, 0, -44)
    swivel = box(30 + out, 2 * half + 6, 6).at(-out / 2, 0, -3 - kit.gap)
    for side in (-1, 1):
        swivel = swivel + box(26, 3, 50).at(-out, side * (half + 1.5), -31 - kit.gap)
    swivel = swivel - across(r + c, 60).at(-out, 0, -46) - cylinder(r + c, 12).at(0, 0, -8)
    hub, tyre = across(22, 24) - across(r + c, 24), across(32, 24) - across(22, 24)
    for n, (x, y) in enumerate(corners):
        turns = n < swivels
        host, W = f"fork{n}" if turns else "base", at(x - out * turns, y, -46 if turns else -44)
        kit.add(host, "fork", swivel if turns else fork, at(x, y, 0), unit=f"caster {n}")
        kit.add(f"wheel{n}", "rim", hub, W, unit=f"caster {n}")
        kit.add(f"wheel{n}", "tyre", tyre, W, unit=f"caster {n}")
        bolt(kit, W, r, 2 * half + 6)
        kit.joint("revolute", host, f"wheel{n}", W[:3, 3], Y)
        if turns:
            kit.screw(at(x, y, -8), r, 14)
            kit.joint("revolute", "base", host, (x, y, 0), Z)
        else:
            for u in (-14, 14):
                for v in (-14, 14):
                    kit.screw(at(x + u, y + v, -6), 2.5, 12)


def side_by_side(kit: Kit) -> None:
    """Equal fingers beside each other on lugs of one palm, each of two phalanges; their pins may be one."""
    count, r, c, w = kit.rng.choice((2, 3, 4)), kit.rng.choice((1.5, 2.0, 3.0)), max(0.0, kit.clearance), 12.0
    pitch, first, second = w + 12 + 2 * kit.gap, kit.rng.uniform(40, 60), kit.rng.uniform(30, 45)
    palm = box(60, count * pitch + 20, 14).at(-35, 0, 0)
    lugs = [(n - count / 2) * pitch for n in range(count + 1)]
    for y in lugs:
        palm = palm + box(16, 8, 14).at(3, y, 0)
    kit.add("base", "base", palm - across(r + c, count * pitch + 30))
    proximal = box(first + 12, w, 12).at(first / 2, 0, 0) - box(20, 6, 12).at(first, 0, 0)
    proximal = proximal - across(r + c, 40) - across(r + c, 40).at(first, 0, 0)
    distal = box(second + 6, 6 - 2 * kit.gap, 10).at(second / 2, 0, 0) - across(r + c, 40)
    one_pin = kit.rng.random() < 0.4
    for n in range(count):
        y, bend = (n - (count - 1) / 2) * pitch, kit.rng.uniform(0.1, 0.5)
        T = at(0, y, 0) @ rot("y", bend)
        K = T @ at(first, 0, 0) @ rot("y", kit.rng.uniform(0.1, 0.5))
        kit.add(f"proximal{n}", "finger", proximal, T)
        kit.add(f"distal{n}", "finger", distal, K)
        kit.joint("revolute", "base", f"proximal{n}", (0, y, 0), Y)
        kit.joint("revolute", f"proximal{n}", f"distal{n}", K[:3, 3], Y)
        kit.add(SCREWS, "pin", across(r, w), K)
        if not one_pin:
            kit.add(SCREWS, "pin", across(r, w + 16), at(0, y, 0))
    if one_pin:
        kit.add(SCREWS, "pin", across(r, count * pitch + 8))


def five_bar(kit: Kit) -> None:
    """Two motors below a plate, a crank on each shaft, and two rods that end in one pin."""
    r, c, away = kit.rng.choice((2.0, 3.0)), max(0.0, kit.clearance), kit.rng.uniform(30, 45)
    plate = drilled(
        box(160, 90, 6).at(0, 0, -3),
        (-away, 0, 12),
        (away, 0, 12),
        *((s * away + x, y, 1.6) for s in (-1, 1) for x, y, _ in circle(4, 16, 1.6)),
    )
    kit.add("base", "base", plate)
    case = cylinder(21, 40).at(0, 0, -46) + cylinder(11.9, 3).at(0, 0, -6)
    ends: list[tuple[float, float]] = []
    tip = (kit.rng.uniform(-15, 15), kit.rng.uniform(100, 120))
    for side, level in ((-1, 6.0), (1, 6.0)):
        hub, link = (side * away, 0.0), f"crank{side}"
        kit.add("base", "motor", case + cylinder(2.5, 20).at(0, 0, -3), at(*hub, 0))
        angle, long = pi / 2 - side * kit.rng.uniform(0.6, 1.0), 55.0
        arm = box(long + 18, 16, 6).at(long / 2, 0, 3) + cylinder(8, 5).at(0, 0, -5)
        arm = drilled(arm, (0, 0, 2.5), (long, 0, r + c))
        kit.add(link, "crank", arm, at(*hub, level) @ rot("z", angle))
        ends.append((hub[0] + long * cos(angle), long * sin(angle)))
        kit.joint("revolute", "base", link, (*hub, 0), Z)
    for n, (x, y) in enumerate(ends):
        span, turn = hypot(tip[0] - x, tip[1] - y), np.arctan2(tip[1] - y, tip[0] - x)
        rod = drilled(box(span + 16, 14, 5).at(span / 2, 0, 2.5), (0, 0, r + c), (span, 0, r + c))
        kit.add(f"rod{n}", "link", rod, at(x, y, 12 + n * 5) @ rot("z", turn))
        kit.joint("revolute", f"crank{2 * n - 1}", f"rod{n}", (x, y, 0), Z)
        if n == 1:
            kit.add(f"rod{n}", "tube", cylinder(6, 5) - cylinder(r + c, 5), at(x, y, 12))
        kit.add(SCREWS, "pin", cylinder(r, 11 + n * 5), at(x, y, 6))
    kit.add(SCREWS, "pin", cylinder(r, 10), at(*tip, 12))
    kit.joint("revolute", "rod0", "rod1", (*tip, 0), Z)


def _strut(kit: Kit, a: str, b: str, name: str, start: Array, end: Array, r: float) -> None:
    """A cylinder between two pins along y: its tube turns on ``a``, its rod on ``b``."""
    span = float(np.linalg.norm(end - start))
    d = (end - start) / span
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = d, Y, np.cross(d, Y), start
    c = max(0.0, kit.clearance)
    long = 0.65 * span
    tube = cylinder(9, long - 10).moved(at(10, 0, 0) @ TO_X) + across(11, 12).at(0, 0, 0)
    tube = tube - cylinder(6, long - 20).moved(at(20, 0, 0) @ TO_X) - across(r + c, 40)
    rod = cylinder(6 - c, span - 0.5 * long - 9).moved(at(0.5 * long, 0, 0) @ TO_X) + across(10, 12).at(span, 0, 0)
    rod = rod - across(r + c, 40).at(span, 0, 0)
    kit.add(f"{name}_tube", "cylinder", tube, T, unit=name)
    kit.add(f"{name}_rod", "rod", rod, T, unit=name)
    kit.joint("revolute", a, f"{name}_tube", start, Y)
    kit.joint("prismatic", f"{name}_tube", f"{name}_rod", start, d)
    kit.joint("revolute", f"{name}_rod", b, end, Y)
    for point in (start, end):
        kit.add(SCREWS, "pin", across(r, 32), at(*point))


def excavator(kit: Kit) -> None:
    """A boom and perhaps a stick, each moved by a cylinder whose ends are on pins between lugs."""
    r, c, gap = 4.0, max(0.0, kit.clearance), kit.gap
    side = 6 + gap + 5
    base = box(160, 90, 30).at(-20, 0, -35)
    for u in (-1, 1):
        base = base + box(30, 10, 40).at(-40, u * side, -6) + box(30, 10, 40).at(40, u * side, -6)
    base = base - across(r + c, 60).at(-40, 0, 0) - across(r + c, 60).at(40, 0, 0)
    kit.add("base", "base", base)
    B = at(-40, 0, 0) @ rot("y", -kit.rng.uniform(0.7, 0.9))
    long = kit.rng.uniform(220, 260)
    boom = box(long + 20, 12, 26).at(long / 2, 0, 0) - across(r + c, 60) - across(r + c, 60).at(long, 0, 0)
    for u in (-1, 1):
        boom = boom + box(24, 10, 26).at(130, u * 11, 0) + box(24, 10 - gap, 34).at(130, u * (11 + gap / 2), -28)
    boom = boom - across(r + c, 60).at(130, 0, -38)
    kit.add("boom", "arm", boom, B)
    kit.joint("revolute", "base", "boom", B[:3, 3], Y)
    kit.add(SCREWS, "pin", across(r, 32), B)
    _strut(kit, "base", "boom", "lift", np.array((40.0, 0, 0)), (B @ (130, 0, -38, 1))[:3], r)
    if kit.rng.random() < 0.6:
        S = B @ at(long, 0, 0) @ rot("y", kit.rng.uniform(0.9, 1.3))
        stick = box(130, 34 + 2 * gap, 20).at(85, 0, 0)
        for u in (-1, 1):
            stick = stick + box(32, 11, 20).at(4, u * (11.5 + gap), 0)
        stick = stick - across(r + c, 60)
        kit.add("stick", "link", stick, S)
        kit.joint("revolute", "boom", "stick", S[:3, 3], Y)
        kit.add(SCREWS, "pin", across(r, 34), S)


def rocker_bogie(kit: Kit) -> None:
    """A body with a shaft through it, a rocker on each end, a bogie on each rocker, and six wheels on stub axles."""
    r, c = 5.0, max(0.0, kit.clearance)
    wide = kit.rng.uniform(120, 180)
    kit.add("base", "body", box(160, wide, 60) - across(r, wide + 10))
    kit.add("base", "shaft", across(r, wide + 2 * (14 + kit.gap)))
    front, rear = kit.rng.uniform(110, 140), kit.rng.uniform(70, 90)
    for side in (-1, 1):
        R = at(0, side * (wide / 2 + kit.gap + 7), 0)
        rocker = box(front + rear + 20, 14, 18).at((front - rear) / 2, 0, 0) - across(r + c, 40)
        rocker = (
            rocker
            + cylinder(r, 18).moved(at(front, side * 7, 0) @ rot("x", -side * pi / 2))
            + cylinder(r, 14).moved(at(-rear, side * 7, 0) @ rot("x", -side * pi / 2))
        )
        kit.add(f"rocker{side}", "arm", rocker, R)
        kit.joint("revolute", "base", f"rocker{side}", R[:3, 3], Y)
        B = R @ at(-rear, side * 7, 0) @ rot("y", kit.rng.uniform(-0.2, 0.2))
        bogie = box(130, 12, 14).at(0, side * (6 + kit.gap), 0) - across(r + c, 60)
        for x in (-55, 55):
            bogie = bogie + cylinder(r, 18).moved(at(x, side * (12 + kit.gap), 0) @ rot("x", -side * pi / 2))
        kit.add(f"bogie{side}", "bracket", bogie, B)
        kit.joint("revolute", f"rocker{side}", f"bogie{side}", B[:3, 3], Y)
        wheels = [(f"rocker{side}", R @ at(front, side * 7, 0))]
        wheels += [(f"bogie{side}", B @ at(x, side * (12 + kit.gap), 0)) for x in (-55, 55)]
        for n, (host, T) in enumerate(wheels):
            W, link = T @ at(0, side * 9, 0), f"wheel{side}{n}"
            kit.add(link, "wheel", across(32, 18) - across(r + c, 18), W)
            kit.joint("revolute", host, link, W[:3, 3], Y)


def module_arm(kit: Kit) -> None:
    """An arm of joint modules, each a round housing with a flange in its end, on brackets and plates by turns."""
    rng, c, g, R = kit.rng, kit.clearance, kit.gap, kit.rng.uniform(28, 45)
    high, r, hollow = rng.uniform(1.4, 2.4) * R, rng.uniform(0.55, 0.75) * R, rng.choice((0.0, 0.0, 5.0, 8.0))
    feet, heads = circle(6, R - 5, 1.6), circle(rng.choice((4, 6, 8)), r - 5, 1.6)
    housing = cylinder(R, high) - cylinder(r + c, 8).at(0, 0, high - 8)
    flange = cylinder(r, 10 - g).at(0, 0, high - 8 + g)
    for x, y, _ in feet:
        housing = housing - cylinder(1.3, 8).at(x, y, 0)
    for x, y, _ in heads:
        flange = flange - cylinder(1.3, 6).at(x, y, high - 4)
    if hollow:
        housing, flange = drilled(housing, (0, 0, hollow)), drilled(flange, (0, 0, hollow))
    kit.add("base", "base", drilled(box(3 * R, 3 * R, 6).at(0, 0, -3), *feet))
    T, here, count = np.eye(4), "base", rng.choice((3, 4, 5, 6))
    for n in range(count):
        link = f"link{n}"
        kit.add(here, "motor", housing, T, unit=f"joint module {n}")
        kit.add(link, "flange", flange, T, unit=f"joint module {n}")
        for x, y, _ in feet:
            kit.screw(T @ at(x, y, 8) @ rot("x", pi), 1.3, 14)
        kit.joint("revolute", here, link, T[:3, 3], T[:3, 2])
        out = T @ at(0, 0, high + 2) @ rot("z", rng.uniform(-1, 1))
        for x, y, _ in heads:
            kit.screw(out @ at(x, y, -6), 1.3, 12)
        if n + 1 == count:
            kit.add(link, "plate", drilled(cylinder(R, 6), *heads), out)
        elif n % 3 == 1:
            reach = rng.uniform(3, 5) * R
            plate = drilled(box(reach + 2 * R, 2 * R, 6).at(reach / 2, 0, 3), *heads)
            T = out @ at(reach, 0, 6) if rng.random() < 0.5 else out @ at(reach) @ rot("x", pi)
            kit.add(link, "arm", drilled(plate, *((reach + x, y, s) for x, y, s in feet)), out)
        else:
            foot = box(high, 2 * R, 6).at(0, 0, 3)
            F = at(6 - high / 2, 0, R + 10) @ TO_X
            wall = drilled(box(2 * R, 2 * R + 20, 6).at(0, 0, -3), *feet).moved(rot("z", pi / 2)).moved(F)
            kit.add(link, "bracket", drilled(foot, *heads) + wall, out)
            T = out @ F @ rot("z", pi / 2)
        here = link
