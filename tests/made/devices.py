"""Further kinds of devices with few joints, and one without any; each was written before any of them was drafted."""

from math import pi

import numpy as np

from tests.solids import box, cylinder, sphere

from .kit import SCREWS, TO_X, Kit, across, at, circle, drilled, rot

X, Y, Z = np.eye(3)
HERE = np.eye(4)


def drawers(kit: Kit) -> None:
    """A cabinet with drawers, each on two slides of a profile in a profile, screwed to both."""
    w, depth, count = kit.rng.uniform(200, 300), kit.rng.uniform(200, 260), kit.rng.choice((1, 2, 3))
    shell = box(depth + 10, w + 20, 90 * count + 20) - box(depth + 10, w, 90 * count).at(10, 0, 0)
    c = max(0.02, kit.clearance)
    outer = box(depth - 20, 10, 34) - box(depth - 20, 8, 26).at(0, -1, 0)
    inner = box(depth - 20, 5, 26 - 2 * c).at(0, -0.5 - c / 2, 0)
    for z in (-13, 13):
        outer = outer + box(depth - 20, 1, 8).at(0, -5.5, z)
    inner = inner + box(depth - 20, 4, 12).at(0, -5, 0)
    tray = box(depth - 10, w - 24, 60) - box(depth - 16, w - 30, 60).at(0, 0, 3)
    front = box(4, w + 16, 80).at(depth / 2 - 3, 0, 0)
    for n in range(count):
        z, pull = (n - (count - 1) / 2) * 90, kit.rng.uniform(20, 120)
        for side in (-1, 1):
            T = at(0, side * (w / 2 - 5), z) @ (HERE if side > 0 else rot("x", pi))
            kit.add("base", "rail", outer, T, unit=f"slide {n}{side}")
            kit.add(f"drawer{n}", "carriage", inner, at(pull, 0, 0) @ T, unit=f"slide {n}{side}")
        kit.add(f"drawer{n}", "drawer", tray, at(pull, 0, z))
        kit.add(f"drawer{n}", "cover", front, at(pull, 0, z))
        kit.joint("prismatic", "base", f"drawer{n}", (pull, 0, z), X)
    kit.add("base", "cabinet", shell)


def neck(kit: Kit) -> None:
    """A chain of balls in sockets on a plate, the last with a mount."""
    T, c, count = at(0, 0, 10), max(0.0, kit.clearance), kit.rng.choice((1, 2, 3))
    kit.add("base", "base", box(90, 70, 10).at(0, 0, 5))
    cup = cylinder(18, 32) - sphere(12 + c).at(0, 0, 26)
    kit.add("base", "tube", cup, T)
    for n in range(count):
        here, link = "base" if n == 0 else f"neck{n}", f"neck{n + 1}"
        T = T @ at(0, 0, 26) @ rot("x", kit.rng.uniform(-0.3, 0.3)) @ rot("y", kit.rng.uniform(-0.3, 0.3))
        kit.joint("ball", here, link, T[:3, 3], T[:3, 2])
        stud = sphere(12) + cylinder(5, 25).at(0, 0, 11)
        if n + 1 < count:
            kit.add(link, "ball", stud + cup.at(0, 0, 36), T)
            T = T @ at(0, 0, 36)
        else:
            kit.add(link, "ball", stud + box(50, 40, 5).at(0, 0, 38.5), T)


def stage(kit: Kit) -> None:
    """A linear stage: motor and screw in bearings, a nut in a carriage, and blocks on two rails."""
    long, c = kit.rng.uniform(220, 320), max(0.0, kit.clearance)
    kit.add("base", "base", box(long + 60, 140, 12).at(0, 0, -6))
    rail = box(long, 12, 10).at(0, 0, 5) - box(long, 3, 4).at(0, 4.5, 5) - box(long, 3, 4).at(0, -4.5, 5)
    block = box(40, 28, 16).at(0, 0, 10) - box(40, 12 + 2 * c, 8 + c).at(0, 0, 6 + c / 2)
    for side in (-1, 1):
        block = block + box(40, 3, 4 - 2 * min(c, 0.5)).at(0, side * (4.5 + c), 5)
    x = kit.rng.uniform(-50, 50)
    for side in (-1, 1):
        kit.add(
            "base",
            "rail",
            drilled(rail, *((u, 0, 1.7) for u in (-long / 3, 0, long / 3))),
            at(0, side * 45, 0),
            unit=f"guide {side}",
        )
        for u in (-30, 30):
            kit.add("carriage", "carriage", block, at(x + u, side * 45, 0), unit=f"guide {side}")
    kit.add("carriage", "plate", box(120, 130, 10).at(0, 0, 23), at(x, 0, 0))
    nut_body = box(40, 30, 16).at(0, 0, 10) - cylinder(6, 40).moved(at(-20, 0, 10) @ TO_X)
    kit.add("carriage", "bracket", nut_body, at(x, 0, 0))
    post = box(12, 36, 20).at(0, 0, 10) - cylinder(8, 12).moved(at(-6, 0, 10) @ TO_X)
    bearing = (cylinder(8, 5) - cylinder(4, 5)).moved(TO_X)
    for u in (-long / 2 + 10, long / 2 - 10):
        kit.add("base", "bracket", post, at(u, 0, 0))
        kit.add(SCREWS, "bearing", bearing, at(u - 2.5, 0, 10))
    spindle = (cylinder(4, 30) + cylinder(6, long - 42).at(0, 0, 30) + cylinder(4, 30).at(0, 0, long - 12)).moved(TO_X)
    kit.add("spindle", "spindle", spindle, at(-long / 2 - 9, 0, 10))
    kit.joint("prismatic", "base", "carriage", (x, 0, 0), X)
    kit.joint("revolute", "base", "spindle", (0, 0, 10), X)


def turntable(kit: Kit) -> None:
    """A ring in a ring, each with its bolts: the outer one on a plate, the inner one under a table with a column."""
    R, c = kit.rng.uniform(50, 90), max(0.05, kit.clearance)
    outer = drilled(cylinder(R + 25, 18) - cylinder(R + 5, 18), *circle(8, R + 15, 2.6))
    inner = drilled(cylinder(R + 5 - c, 18).at(0, 0, 1) - cylinder(R - 20, 18).at(0, 0, 1), *circle(8, R - 8, 2.6))
    kit.add("base", "base", drilled(box(2 * R + 80, 2 * R + 80, 12).at(0, 0, -6), *circle(8, R + 15, 2.6)))
    kit.add("base", "ring", outer, unit="bearing unit")
    kit.add("table", "ring", inner, unit="bearing unit")
    kit.add("table", "plate", drilled(cylinder(R + 10, 10).at(0, 0, 19), *circle(8, R - 8, 2.6)))
    kit.add("table", "arm", box(40, 40, 120).at(R / 3, 0, 89))
    for x, y, _ in circle(8, R + 15, 2.6):
        kit.screw(at(x, y, -10), 2.5, 28)
    for x, y, _ in circle(8, R - 8, 2.6):
        kit.screw(at(x, y, 5), 2.5, 24)
    kit.joint("revolute", "base", "table", (0, 0, 0), Z)


def butt_hinges(kit: Kit) -> None:
    """A cabinet and a door on two bought hinges of two leaves and a pin each, screwed to both."""
    w, h, r = kit.rng.uniform(180, 260), kit.rng.uniform(240, 320), 2.0
    c = max(0.0, kit.clearance)
    case = box(w, 150, h) - box(w - 20, 140, h - 20).at(0, 5, 0)
    door, opened = box(w - 2, 15, h - 4).at(w / 2 - 1, 7.5, 0), kit.rng.uniform(0.5, 1.4)
    hinge_at = (-w / 2, 78.0 + 0.5)
    D = at(*hinge_at, 0) @ rot("z", opened)
    leaf, knuckles = [box(27, 2, 50).at(18.5, 0, 0) for _ in (0, 1)], ((-25, 10), (-15, 20), (5, 10), (15, 10))
    for n, (low, high) in enumerate(knuckles):
        leaf[n % 2] = leaf[n % 2] + box(5, 2, high).at(3.5, 0, low + high / 2) + cylinder(4, high).at(0, 0, low)
    leaf = [drilled(one, (0, 0, r + c)) for one in leaf]
    holes = [(x, z) for x in (12, 26) for z in (-15, 15)]
    for n in (0, 1):
        for x, z in holes:
            leaf[n] = leaf[n] - across(1.6, 10).at(x, 0, z)
    still = at(*hinge_at, 0) @ rot("z", -pi / 2)
    for z in (-h / 3, h / 3):
        for x, u in holes:
            case = case - across(1.6, 30).moved(still @ at(x, 0, z + u))
            door = door - cylinder(1.6, 30).moved(at(x, 15, z + u) @ rot("x", pi / 2))
    kit.add("base", "cabinet", case)
    kit.add("door", "cover", door, D @ at(0, 1, 0))
    for n, z in enumerate((-h / 3, h / 3)):
        kit.add("base", "leaf", leaf[0], still @ at(0, 0, z), unit=f"hinge {n}")
        kit.add("door", "leaf", leaf[1], D @ at(0, 0, z), unit=f"hinge {n}")
        kit.add(SCREWS, "pin", cylinder(r, 50).at(0, 0, -25), at(*hinge_at, z), unit=f"hinge {n}")
    kit.joint("revolute", "base", "door", (*hinge_at, 0), Z)


def tube_stand(kit: Kit) -> None:
    """Round tubes in clamps of a plate and of a cross-beam, with set screws: nothing moves."""
    r, h = kit.rng.uniform(8, 14), kit.rng.uniform(200, 320)
    spots = [(-80.0, -40.0), (80.0, -40.0), (0.0, 60.0)]
    kit.add("base", "base", box(240, 180, 10).at(0, 0, -5))
    socket = (
        cylinder(r + 8, 30) - cylinder(r + max(0.0, kit.clearance), 30) - cylinder(2, 20).moved(at(r - 2, 0, 15) @ TO_X)
    )
    for x, y in spots:
        kit.add("base", "bracket", socket, at(x, y, 0))
        kit.add("base", "tube", cylinder(r, h) - cylinder(r - 2, h), at(x, y, 0))
        kit.screw(at(x, y, 15) @ TO_X @ at(0, 0, r), 2, 8)
    top = drilled(
        box(240, 180, 20).at(0, 0, h - 20), *((x, y, r + max(0.0, kit.clearance)) for x, y in spots), depth=2000
    )
    kit.add("base", "plate", top)
    kit.add("base", "cover", cylinder(30, 40).at(0, 0, h - 10))
