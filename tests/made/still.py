"""Assemblies in which nothing moves."""

from math import pi

from tests.solids import box, cylinder

from .kit import Kit, at, drilled, rot


def frame(kit: Kit) -> None:
    """Posts and beams with screwed corner plates: nothing moves."""
    w, h = kit.rng.uniform(200, 300), kit.rng.uniform(150, 250)
    for x in (-1, 1):
        kit.add("base", "rail", box(20, 20, h).at(x * w / 2, 0, h / 2))
    kit.add("base", "rail", box(w - 20, 20, 20).at(0, 0, h - 10))
    kit.add("base", "base", box(w + 60, 80, 8).at(0, 0, -4))
    plate = drilled(box(50, 50, 4), *((x, y, 2.5) for x in (-15, 15) for y in (-15, 15)))
    for x in (-1, 1):
        T = at(x * (w / 2 - 15), -10, h - 15) @ rot("x", pi / 2)
        kit.add("base", "plate", plate, T @ at(0, 0, 2))
        for u in (-15, 15):
            for v in (-15, 15):
                kit.screw(T @ at(u, v, -6), 2.5, 10)


def board(kit: Kit) -> None:
    """A circuit board on spacers with chips, a capacitor and a knob-like connector: nothing moves."""
    w, d = kit.rng.uniform(80, 120), kit.rng.uniform(60, 90)
    posts = [(x * (w / 2 - 5), y * (d / 2 - 5)) for x in (-1, 1) for y in (-1, 1)]
    kit.add("base", "base", drilled(box(w + 20, d + 20, 3).at(0, 0, -1.5), *((x, y, 1.6) for x, y in posts)))
    kit.add("base", "plate", drilled(box(w, d, 1.6).at(0, 0, 10.8), *((x, y, 1.6) for x, y in posts)))
    spacer = cylinder(3, 10) - cylinder(1.6, 10)
    for x, y in posts:
        kit.add("base", "tube", spacer, at(x, y, 0))
        kit.screw(at(x, y, -3), 1.5, 14.6)
    for _ in range(6):
        x, y = kit.rng.uniform(-w / 3, w / 3), kit.rng.uniform(-d / 3, d / 3)
        kit.add("base", "cover", box(8, 6, 2).at(x, y, 12.6))
    kit.add("base", "tube", cylinder(5, 12).at(0, 0, 11.6))
