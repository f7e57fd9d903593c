"""Robots of bought parts as their makers draw them: actuators, guides, racks, dovetails, bearings, clevis pins.

Each was written, with its truth, before any of them was drafted; in dirtier trees, too: imports that hold parts of
several links.
"""

from math import pi

import numpy as np

from robot_library.moments import Array
from tests.solids import Solid, box, cone, cylinder

from .kit import SCREWS, TO_X, TO_Y, Kit, across, at, circle, drilled, rot

X, Y, Z = np.eye(3)
HERE = np.eye(4)


def _screws(kit: Kit, T: Array, spots: list[tuple[float, float, float]], length: float) -> None:
    for x, y, r in spots:
        kit.screw(T @ at(x, y, 0), r, length)


def _rail(length: float) -> Solid:
    """A guide rail along x of 12 x 8 mm with a groove on each side, its foot at z = 0."""
    rail = box(length, 12, 8).at(0, 0, 4) - box(length, 1, 2).at(0, 5.5, 5) - box(length, 1, 2).at(0, -5.5, 5)
    spots = [(x, 0, 1.75) for x in np.arange(-length / 2 + 15, length / 2 - 10, 50).tolist()]
    return drilled(rail, *spots)


def _block(kit: Kit) -> tuple[Solid, Solid]:
    """The block of a rail, whose ribs are in the grooves, and an end cap of it."""
    c = max(0.02, kit.clearance)
    block = box(34, 27, 10).at(0, 0, 8) - box(34, 12 + 2 * c, 5 + c).at(0, 0, 5.5 + c / 2)
    for side in (-1, 1):
        block = block + box(34, 1, 1.6).at(0, side * (5.5 + c), 5)
    holes = [(x, y, 1.25) for x in (-10, 10) for y in (-10, 10)]
    for x, y, r in holes:
        block = block - cylinder(r, 4).at(x, y, 9)
    cap = box(4, 26, 9).at(19, 0, 8) - box(4, 13.5, 6).at(19, 0, 5.5)
    return block, cap


def _guide(kit: Kit, fixed: str, moving: str, T: Array, length: float, spots: list[float], name: str) -> None:
    rail, (block, cap) = _rail(length), _block(kit)
    kit.add(fixed, "rail", rail, T, unit=name)
    _screws(kit, T @ at(0, 0, -8), [(x, 0, 1.5) for x in (-length / 2 + 15, -length / 2 + 65)], 14)
    for x in spots:
        kit.add(moving, "carriage", block, T @ at(x, 0, 0), unit=name)
        for turned in (HERE, rot("z", pi)):
            kit.add(moving, "cover", cap, T @ at(x, 0, 0) @ turned, unit=name)


def corexy(kit: Kit) -> None:
    """A frame with two rails, a beam on their blocks, a rail on the beam, and a head on the block of that."""
    long, wide = kit.rng.uniform(260, 360), kit.rng.uniform(220, 320)
    bar, end = box(long, 20, 20).at(0, 0, -10), box(20, wide - 20, 20).at(0, 0, -10)
    for side in (-1, 1):
        kit.add("base", "frame", bar, at(0, side * wide / 2, 0))
        kit.add("base", "frame", end, at(side * (long / 2 - 10), 0, 0))
    if kit.rng.random() < 0.5:
        kit.add("base", "plate", box(long, wide + 20, 5).at(0, 0, -22.5))
    x, y, pair = kit.rng.uniform(-50, 50), kit.rng.uniform(-40, 40), kit.rng.choice(([0.0], [-25.0, 25.0]))
    for side in (-1, 1):
        _guide(kit, "base", "beam", at(0, side * wide / 2, 0), long - 10, [x + u for u in pair], f"MGN12 {side}")
    holes = [(u + dx, s * wide / 2 + dy, 1.6) for s in (-1, 1) for u in pair for dx in (-10, 10) for dy in (-10, 10)]
    beam = drilled(box(pair[-1] - pair[0] + 34, wide + 27, 8).at(0, 0, 17), *holes)
    kit.add("beam", "bracket", beam, at(x, 0, 0))
    _screws(kit, at(x, 0, 10), [(u, v, 1.25) for u, v, _ in holes], 11)
    kit.joint("prismatic", "base", "beam", (x, 0, 0), X)
    T = at(x, 0, 21) @ rot("z", pi / 2)
    _guide(kit, "beam", "head", T, wide - 40, [y], "MGN12 x")
    head = drilled(box(40, 40, 6).at(0, 0, 16), *((u, v, 1.6) for u in (-10, 10) for v in (-10, 10)))
    head = head + box(40, 6, 40).at(0, 17, 39) - cylinder(6, 40).moved(at(0, -3, 40) @ TO_Y)
    kit.add("head", "plate", head, T @ at(y, 0, 0))
    kit.joint("prismatic", "beam", "head", (T @ at(y, 0, 0))[:3, 3], Y)


def v_slot(kit: Kit) -> None:
    """A plate with four V-wheels on bolts, which run in the grooves of an extrusion."""
    long, c = kit.rng.uniform(250, 400), max(0.0, kit.clearance)
    profile = box(long, 20, 40) - cylinder(2.1, long).moved(at(-long / 2, 0, 0) @ TO_X)
    for side in (-1, 1):
        profile = profile - box(long, 6.5, 6.5).moved(at(0, 0, side * 20) @ rot("x", pi / 4))
    kit.add("base", "rail", profile)
    for side in (-1, 1):
        kit.add("base", "bracket", box(6, 60, 60).at(side * (long / 2 + 3), 0, 0))
    x, high = kit.rng.uniform(-60, 60), 29.4 + c
    wheel = cone(9, 12, 3).at(0, 0, -5) + cylinder(12, 4).at(0, 0, -2) + cone(12, 9, 3).at(0, 0, 2)
    wheel = (wheel - cylinder(2.5, 10).at(0, 0, -5)).moved(TO_Y)
    screw = across(2.5, 34).at(0, 10, 0) + across(4.5, 4).at(0, -7, 0)
    plate = box(90, 6, 90).at(0, 22, 0)
    for u in (-30, 30):
        for v in (-1, 1):
            W, link = at(x + u, 0, v * high), f"wheel{u}{v}"
            plate = plate - across(2.5, 6).at(u, 22, v * high)
            kit.add(link, "wheel", wheel, W)
            kit.add(SCREWS, "tube", across(4, 14 - kit.gap).at(0, 12, 0) - across(2.55, 14).at(0, 12, 0), W)
            kit.add(SCREWS, "screw", screw, W)
            kit.joint("revolute", "carriage", link, W[:3, 3], Y)
    kit.add("carriage", "plate", plate, at(x, 0, 0))
    kit.joint("prismatic", "base", "carriage", (x, 0, 0), X)


def rack_gripper(kit: Kit) -> None:
    """Two jaws with T-shaped feet in slots of the palm, each with a rack that a pinion on a motor moves."""
    c, g, long, r = max(0.0, kit.clearance), kit.gap, kit.rng.uniform(140, 180), 12.0
    palm = box(80, long, 20).at(0, 0, -10)
    for side in (-1, 1):
        palm = palm - box(16 + 2 * c, long, 6 + 2 * c).at(side * 24, 0, -13)
        palm = palm - box(8 + 2 * c, long, 10).at(side * 24, 0, -5)
    kit.add("base", "base", drilled(palm, (0, 0, 5.0), *circle(4, 9, 1.6)))
    case = cylinder(14, 30).at(0, 0, -50)
    for x, y, _ in circle(4, 9, 1.6):
        case = case - cylinder(1.3, 6).at(x, y, -26)
    kit.add("base", "motor", case + cylinder(2.5, 32).at(0, 0, -20))
    _screws(kit, at(0, 0, -25), circle(4, 9, 1.3), 25)
    pinion = cylinder(r - 1, 6) - cylinder(2.5, 6)
    for n in range(16):
        pinion = pinion + box(2, 1.6, 6).moved(rot("z", 2 * pi * n / 16) @ at(r - 0.9, 0, 3))
    kit.add("pinion", "gear", pinion, at(0, 0, 4))
    kit.joint("revolute", "base", "pinion", (0, 0, 0), Z)
    jaw = box(16, 30, 6).at(24, 0, -13) + box(8, 30, 10 + g).at(24, 0, -5 + g / 2)
    jaw = jaw + box(22, 30, 12).at(27, 0, 6 + g) + box(14, 8, 50).at(30, -11, 37 + g)
    jaw = jaw + box(5, 80, 6).at(16.5, -25, 8 + g)
    for n in range(14):
        jaw = jaw + box(1.6, 2, 6).at(13.2, n * 5 - 60, 8 + g)
    apart = kit.rng.uniform(15, 35)
    for side, turned in ((1, HERE), (-1, rot("z", pi))):
        T = turned @ at(0, apart, 0)
        kit.add(f"jaw{side}", "finger", jaw, T)
        kit.add(f"jaw{side}", "plate", box(16, 4, 40).at(30, -17, 37 + g), T)
        kit.joint("prismatic", "base", f"jaw{side}", T[:3, 3], Y)


def coaxial_legs(kit: Kit) -> None:
    """Legs of three flat actuators: abduction, hip, and a knee actuator in line with the hip that drives a pulley."""
    rng, g = kit.rng, kit.gap
    stator = drilled(cylinder(38, 26), *circle(6, 34, 1.5)) + cylinder(30, 4).at(0, 0, 26)
    stator = stator - cylinder(22 + kit.clearance, 6).at(0, 0, 24)
    rotor = cylinder(22, 8 - g).at(0, 0, 24 + g)
    for x, y, r in circle(6, 16, 1.5):
        rotor = rotor - cylinder(r, 6).at(x, y, 26)
    long, wide, L = rng.uniform(220, 300), rng.uniform(170, 210), rng.uniform(160, 200)
    kit.add("base", "body", box(long, wide, 60))
    mount = drilled(box(90, 90, 6).at(0, 0, 29), (0, 0, 30.2), *circle(6, 34, 1.6)) + box(6, 90, 26).at(42, 0, 13)
    thigh = drilled(cylinder(24, 4) + box(L + 76, 76, 6).at(L / 2, 0, 7), *circle(6, 16, 1.6), *circle(6, 34, 1.6))
    thigh = thigh - cylinder(8, 6).at(L, 0, 4)
    shank = cylinder(4, 6 + g).at(0, 0, 4) + box(160, 18, 8).at(66, 0, 14 + g)
    for n, (sx, sy) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)]):
        A = at(sx * long / 2, sy * (wide / 2 - 45), 0) @ (TO_X if sx > 0 else rot("y", -pi / 2))
        kit.add("base", "motor", stator, A, unit=f"actuator {n}a")
        kit.add(f"abd{n}", "flange", rotor, A, unit=f"actuator {n}a")
        kit.add("base", "bracket", mount, A)
        _screws(kit, A @ at(0, 0, 17), circle(6, 34, 1.5), 15)
        kit.joint("revolute", "base", f"abd{n}", A[:3, 3], A[:3, 2])
        turned, out = TO_Y if sy > 0 else rot("x", pi / 2), A @ at(0, 0, 32)
        H = at(0, -sy * 5, 50) @ turned
        cheek = drilled(cylinder(24, 8), *circle(6, 16, 1.6)) + box(84, 6, 90).at(0, sy * 24, 47)
        cheek = cheek - cylinder(30.2, 6).moved(H @ at(0, 0, 26))
        for x, y, r in circle(6, 34, 1.6):
            cheek = cheek - cylinder(r, 6).moved(H @ at(x, y, 26))
        kit.add(f"abd{n}", "bracket", cheek, out)
        H = out @ H
        _screws(kit, H @ at(0, 0, 17), circle(6, 34, 1.5), 15)
        kit.add(f"abd{n}", "motor", stator, H, unit=f"actuator {n}b")
        kit.add(f"thigh{n}", "flange", rotor, H, unit=f"actuator {n}b")
        kit.joint("revolute", f"abd{n}", f"thigh{n}", H[:3, 3], H[:3, 2])
        T = H @ at(0, 0, 32) @ rot("z", rng.uniform(-0.4, 0.4))
        kit.add(f"thigh{n}", "leg", thigh, T)
        _screws(kit, T @ at(0, 0, -5), circle(6, 16, 1.5), 15)
        K = T @ at(0, 0, 10)
        kit.add(f"thigh{n}", "motor", stator, K, unit=f"actuator {n}c")
        kit.add(f"pulley{n}", "flange", rotor, K, unit=f"actuator {n}c")
        kit.add(f"pulley{n}", "pulley", drilled(cylinder(20, 8), *circle(6, 16, 1.6)), K @ at(0, 0, 32))
        _screws(kit, K @ at(0, 0, 26), circle(6, 16, 1.5), 14)
        kit.joint("revolute", f"thigh{n}", f"pulley{n}", T[:3, 3], T[:3, 2])
        S = T @ at(L, 0, 0)
        kit.add(SCREWS, "bearing", cylinder(8, 5) - cylinder(4, 5), S @ at(0, 0, 4.5))
        kit.add(f"shank{n}", "leg", shank, S @ rot("z", rng.uniform(1.2, 1.8)))
        kit.joint("revolute", f"thigh{n}", f"shank{n}", S[:3, 3], T[:3, 2])


def spline_scara(kit: Kit) -> None:
    """An arm on a crossed-roller ring, a second one on bearings, and a shaft with a collar through its bushings."""
    rng, c = kit.rng, max(0.0, kit.clearance)
    R, a, b = rng.uniform(40, 55), rng.uniform(150, 200), rng.uniform(130, 170)
    column = cylinder(R + 16, 140)
    for x, y, r in circle(6, R + 9, 1.6):
        column = column - cylinder(r, 15).at(x, y, 125)
    kit.add("base", "base", box(170, 170, 14).at(0, 0, 7) + column.at(0, 0, 14))
    outer = drilled(cylinder(R + 16, 14) - cylinder(R + 2 + c, 14), *circle(6, R + 9, 1.6))
    inner = drilled(cylinder(R + 2, 14 - kit.gap) - cylinder(R - 16, 14 - kit.gap), *circle(6, R - 7, 1.6))
    T = at(0, 0, 154)
    kit.add("base", "ring", outer, T, unit="RB ring")
    kit.add("upper", "ring", inner, T @ at(0, 0, kit.gap), unit="RB ring")
    _screws(kit, T @ at(0, 0, -6), circle(6, R + 9, 1.5), 20)
    A = T @ at(0, 0, 14) @ rot("z", rng.uniform(-1, 1))
    upper = drilled(cylinder(R + 1, 6), *circle(6, R - 7, 1.6)) + box(a + 50, 60, 24).at(a / 2, 0, 18)
    upper = upper - cylinder(16, 7).at(a, 0, 23) - cylinder(10, 40).at(a, 0, 0) - cylinder(16, 7).at(a, 0, 6)
    kit.add("upper", "arm", upper, A)
    _screws(kit, A @ at(0, 0, -8), circle(6, R - 7, 1.5), 14)
    kit.joint("revolute", "base", "upper", A[:3, 3], Z)
    ring = cylinder(16, 7) - cylinder(8, 7)
    for z in (6, 23):
        kit.add(SCREWS, "bearing", ring, A @ at(a, 0, z))
    E = A @ at(a, 0, 30) @ rot("z", rng.uniform(-1, 1))
    fore = (
        box(b + 70, 56, 20).at(b / 2, 0, 11 + kit.gap)
        + cylinder(12, 1 + kit.gap)
        - cylinder(12, 20).at(b, 0, 1 + kit.gap)
    )
    fore = fore + cylinder(8, 24).at(0, 0, -24)
    kit.add("fore", "arm", fore, E)
    kit.joint("revolute", "upper", "fore", E[:3, 3], Z)
    bush = cylinder(12, 20) + cylinder(18, 4).at(0, 0, 20) - cylinder(6 + c, 24)
    kit.add("fore", "bearing", bush, E @ at(b, 0, 1 + kit.gap))
    z = rng.uniform(-80, -40)
    shaft = cylinder(6, 200) - box(1.5, 3, 200).at(6, 0, 100)
    Q = E @ at(b, 0, z)
    kit.add("quill", "shaft", shaft, Q)
    kit.add("quill", "ring", cylinder(12, 8) - cylinder(6, 8), Q @ at(0, 0, 190))
    kit.add(
        "quill", "flange", drilled(cylinder(20, 6), *circle(4, 14, 1.6)) - cylinder(6, 4).at(0, 0, 2), Q @ at(0, 0, -2)
    )
    kit.joint("prismatic", "fore", "quill", Q[:3, 3], Z)


def bearing_pan_tilt(kit: Kit) -> None:
    """A yoke whose shaft is in two bearings of the base, and a cradle with stubs in bearings of the yoke's cheeks."""
    rng, g = kit.rng, kit.gap
    base = box(110, 110, 8).at(0, 0, 4) + cylinder(30, 60).at(0, 0, 8)
    base = base - cylinder(16, 7).at(0, 0, 61) - cylinder(13, 68) - cylinder(16, 7).at(0, 0, 8)
    kit.add("base", "base", base)
    ring = cylinder(16, 7) - cylinder(10, 7)
    for z in (8, 61):
        kit.add(SCREWS, "bearing", ring, at(0, 0, z), unit="bearings")
    w = rng.uniform(70, 100)
    yoke = cylinder(10, 60).at(0, 0, 8) + cylinder(12, 1 + g).at(0, 0, 68) + box(60, w + 30, 8).at(0, 0, 73 + g)
    for side in (-1, 1):
        yoke = yoke + box(40, 8, 70).at(0, side * (w / 2 + 8), 112 + g)
        yoke = yoke - across(8, 5).at(0, side * (w / 2 + 6.5), 125) - across(6, 8).at(0, side * (w / 2 + 8), 125)
    P = rot("z", rng.uniform(-1, 1))
    kit.add("pan", "fork", yoke, P)
    kit.joint("revolute", "base", "pan", (0, 0, 0), Z)
    small = across(8, 5) - across(4, 5)
    T = P @ at(0, 0, 125) @ rot("y", rng.uniform(-0.5, 0.5))
    for side in (-1, 1):
        kit.add(SCREWS, "bearing", small, T @ at(0, side * (w / 2 + 6.5), 0))
        stub = across(4, 10).at(0, side * (w / 2 + 5), 0) + across(5, 1.5).at(0, side * (w / 2 + 3.25), 0)
        stub = stub + across(10, 4).at(0, side * (w / 2 + 0.5), 0)
        kit.add("tilt", "shaft", stub, T)
    cradle = box(50, w - 3, 40) - box(44, w - 9, 36).at(3, 0, 0)
    kit.add("tilt", "plate", cradle, T)
    kit.joint("revolute", "pan", "tilt", T[:3, 3], T[:3, 1])


def knee_brace(kit: Kit) -> None:
    """A thigh and a shank of two bars each with cuffs, hinged on both sides by a clevis pin with washer and circlip."""
    r, c, g = kit.rng.choice((3.0, 4.0, 5.0)), max(0.0, kit.clearance), kit.gap
    w, L, S = kit.rng.uniform(110, 140), kit.rng.uniform(180, 240), kit.rng.uniform(160, 220)
    K = rot("y", kit.rng.uniform(0.1, 0.6))
    F = K @ at(0, 0, -S) @ rot("y", kit.rng.uniform(-0.4, 0.0))
    ring = cylinder(r + 2.5, 1) - cylinder(r - 0.5, 1) - box(2 * r - 1.5, r + 3, 1).at(0, r, 0.5)
    cuff = box(30, w - 5, 60).at(0, 0, 0) - box(26, w - 11, 60).at(3, 0, 0)
    for side in (-1, 1):
        bar = box(24, 5, L + 12).at(0, side * w / 2, L / 2 - 6) - across(r + c, 5).at(0, side * w / 2, 0)
        kit.add("base", "bracket", bar)
        low = side * (w / 2 + 5 + g)
        shank = box(22, 5, S + 22).at(0, low, -S / 2) - across(r + c, 5).at(0, low, 0) - across(r + c, 5).at(0, low, -S)
        kit.add("shank", "link", shank, K)
        foot = box(22, 5, 60).at(0, side * (w / 2), -20) - across(r + c, 5).at(0, side * w / 2, 0)
        kit.add("foot", "plate", foot, F)
        for T in (HERE, F):
            P = T @ at(0, side * w / 2, 0) @ (TO_Y if side > 0 else rot("x", pi / 2))
            pin = cylinder(r, 16 + g).at(0, 0, -4.5) + cylinder(r + 2.5, 2).at(0, 0, -4.5)
            pin = pin - (cylinder(r, 1.1) - cylinder(r - 0.5, 1.1)).at(0, 0, 9 + g)
            kit.add(SCREWS, "pin", pin, P)
            if kit.fasteners:
                kit.add(SCREWS, "tube", cylinder(r + 3, 1) - cylinder(r + 0.1, 1), P @ at(0, 0, 7.6 + g))
            kit.add(SCREWS, "ring", ring, P @ at(0, 0, 9.05 + g))
    kit.add("base", "cover", cuff, at(0, 0, L - 40))
    kit.add("shank", "cover", box(26, w + 5 + 2 * g, 50) - box(22, w - 2 + 2 * g, 50).at(3, 0, 0), K @ at(0, 0, -S / 2))
    kit.add("foot", "plate", box(120, w - 5, 5).at(40, 0, -48), F)
    kit.joint("revolute", "base", "shank", (0, 0, 0), Y)
    kit.joint("revolute", "shank", "foot", F[:3, 3], Y)


def dovetail_stage(kit: Kit) -> None:
    """Two or three slides with a dovetail each, one on the other, each with a screw in a bracket."""
    c, count, T, here = max(0.0, kit.clearance), kit.rng.choice((2, 3)), HERE, "base"
    tail = box(120, 40, 10)
    for side in (-1, 1):
        tail = tail - box(140, 14, 40).moved(at(0, side * 24.7, 3) @ rot("x", -side * pi / 6))
    groove = box(100, 40 + 2 * c, 10 + c).at(0, 0, c / 2)
    for side in (-1, 1):
        groove = groove - box(120, 14, 40).moved(at(0, side * (24.7 + c), 3) @ rot("x", -side * pi / 6))
    bottom = box(120, 70, 14).at(0, 0, -7) + tail.at(0, 0, 5)
    kit.add("base", "base", drilled(bottom, *((x, y, 2.6) for x in (-50, 50) for y in (-28, 28)), depth=28))
    for n in range(count):
        link = f"slide{n}"
        P = T @ at(kit.rng.uniform(-25, 25), 0, 0)
        top = box(100, 70, 20).at(0, 0, 10 + kit.gap) - groove.at(0, 0, 5)
        kit.add(link, "carriage", top, P)
        kit.joint("prismatic", here, link, P[:3, 3], P[:3, 0])
        T, here = P @ at(0, 0, 20 + kit.gap) @ rot("z", pi / 2), link
        if n + 1 < count:
            kit.add(link, "plate", box(120, 100, 14).at(0, 0, 7) + tail.at(0, 0, 19), T)
            T = T @ at(0, 0, 14)
        else:
            kit.add(link, "plate", box(60, 60, 6).at(0, 0, 3), T)


def printed_arm(kit: Kit) -> None:
    """A printed arm: servos in pockets that fit tightly, horns sunk in brackets, an idler pin on the other side."""
    rng, c, g = kit.rng, max(0.0, kit.clearance), kit.gap
    ears, seats = [(x, 0.0, 1.6) for x in (-24, 24)], [(x, 0.0, 1.3) for x in (-24, 24)]
    case = box(40, 20, 36).at(0, 0, -18) + drilled(box(54, 20, 2.5).at(0, 0, -8.75), *ears)
    case = case + cylinder(6, 1.5).at(10, 0, 0) + cylinder(2.9, 3).at(10, 0, 1.5)
    horn = (cylinder(10, 2) - cylinder(3, 2)).at(10, 0, 2.5)
    block = drilled(box(60, 26, 26).at(0, 0, -23), *seats) - box(40.2, 20.2, 26).at(0, 0, -23)

    def servo(host: str, driven: str, T: Array) -> None:
        kit.add(host, "servo", case, T, unit=f"MG996R {host}")
        kit.add(driven, "horn", horn, T, unit=f"MG996R {host}")
        _screws(kit, T @ at(0, 0, -17), seats, 9.5)
        kit.joint("revolute", host, driven, (T @ at(10, 0, 0))[:3, 3], T[:3, 2])

    kit.add("base", "base", block + box(80, 70, 26).at(0, 0, -49) - box(40.2, 20.2, 4).at(0, 0, -38))
    servo("base", "turret", HERE)
    T = at(10, 0, 2.5) @ rot("z", rng.uniform(-1, 1))
    to_side = np.eye(4)
    to_side[:3, :3] = np.array([Z, X, Y]).T
    S = at(0, 18, 36) @ to_side
    kit.add("turret", "bracket", cylinder(30, 6) - cylinder(10.2, 2) + block.moved(S), T)
    here, S, count = "turret", T @ S, rng.choice((1, 2, 3))
    for n in range(count):
        link, reach = ("upper", "fore", "wrist")[n], rng.uniform(80, 120)
        servo(here, link, S)
        B = S @ at(10, 0, 0) @ rot("z", rng.uniform(-0.6, 0.6))
        arm = box(reach, 24, 5).at(reach / 2 - 14, 0, 5) - cylinder(10.1, 2).at(0, 0, 2.5)
        arm = arm + box(6, 24, 51.5 + g).at(reach - 17, 0, -18.25 - g / 2)
        arm = arm + box(reach, 24, 4).at(reach / 2 - 14, 0, -42 - g)
        kit.add(here, "cover", cylinder(9, 2).at(10, 0, -38) + cylinder(2, 6 + g).at(10, 0, -44 - g), S)
        arm = arm - cylinder(2 + c, 10).at(0, 0, -46 - g)
        arm = arm + (block.at(reach + 16, 0, 0) if n + 1 < count else box(20, 30, 4).at(reach - 4, 0, 0))
        kit.add(link, "arm", arm, B)
        here, S = link, B @ at(reach + 16, 0, 0)


def hub_drive(kit: Kit) -> None:
    """A base on two hub motors, whose axles are clamped, and on two casters with a swivel and a wheel each."""
    rng, c, g = kit.rng, max(0.0, kit.clearance), kit.gap
    long, wide = rng.uniform(300, 400), rng.uniform(260, 340)
    kit.add("base", "body", box(long, wide, 10).at(0, 0, 5))
    for side in (-1, 1):
        W, y = at(0, side * (wide / 2 + 35), -40), side * (wide / 2 - 10)
        kit.add("base", "bracket", box(50, 8, 70).at(0, y, -35) - across(6, 8).at(0, y, -40))
        axle = across(6, 58).at(0, -side * 23, 0) + across(55, 12)
        rim = across(62, 34) - across(55.5, 13) - across(6 + c, 17.5).at(0, -side * 15.5, 0)
        kit.add("base", "shaft", axle, W, unit=f"hub motor {side}")
        kit.add(f"wheel{side}", "rim", rim, W, unit=f"hub motor {side}")
        kit.add(f"wheel{side}", "tyre", across(82, 34) - across(62, 34), W, unit=f"hub motor {side}")
        kit.joint("revolute", "base", f"wheel{side}", W[:3, 3], Y)
        kit.add(SCREWS, "nut", across(10, 6) - across(6, 6), at(0, y - side * 7, -40))
        C, spots = at(side * (long / 2 - 50), 0, 0), [(u, v, 3.0) for u in (-22, 22) for v in (-22, 22)]
        top = drilled(box(60, 60, 3).at(0, 0, -1.5) + cylinder(16, 4).at(0, 0, -7), *spots, (0, 0, 5))
        kit.add("base", "plate", top, C, unit=f"caster {side}")
        _screws(kit, C @ at(0, 0, -6), [(u, v, 2.5) for u, v, _ in spots], 16)
        fork = drilled(box(50, 44, 4).at(-8, 0, -9 - g), (0, 0, 5 + c))
        for u in (-1, 1):
            fork = fork + box(24, 3, 84).at(-25, u * 20.5, -53 - g)
        fork = fork - across(4 + c, 60).at(-25, 0, -74)
        F = C @ rot("z", rng.uniform(-1, 1))
        kit.add(f"fork{side}", "fork", fork, F, unit=f"caster {side}")
        kit.add(SCREWS, "pin", cylinder(5, 11 + g).at(0, 0, -11 - g) + cylinder(8, 2).at(0, 0, -13 - g), C)
        V, link = F @ at(-25, 0, -74), f"caster{side}"
        kit.add(link, "wheel", across(38, 34) - across(4 + c, 34), V, unit=f"caster {side}")
        kit.add(SCREWS, "pin", across(4, 52), V)
        kit.joint("revolute", "base", f"fork{side}", C[:3, 3], Z)
        kit.joint("revolute", f"fork{side}", link, V[:3, 3], F[:3, 1])
