"""Shapes of an arm and its hand, each in the frame of its link [mm]; both sides use the same shapes."""

import build123d as bd

from .. import shapes
from ..limb_parts import across, rounded_rims
from ..machine_parts import pin
from ..shapes import at, block, capsule, cylinder, hull_plate, lathe
from . import dimensions as d

_CUP = -74.0
"""Height of the shoulder fork's lower face."""


def draw_shoulder() -> bd.Part:
    """The left shoulder: from the torso's drive along y, with the roll drive along x."""
    arm = across(shapes.housing(45, 52, 4, 0), 0)
    return arm + at(shapes.housing(43, 2 * d.ROLL_HALF, 4, 4), (-d.ROLL_HALF, 0, 0), (0, 90, 0))


def draw_fork() -> bd.Part:
    """The fork on the roll axis, and below it the seat of the arm's turntable."""
    cheek = rounded_rims(hull_plate([((0, 0), 42), ((0, _CUP + 30), 40)], d.FORK), 4)
    trim = at(bd.Box(300, 300, 100), (0, 0, _CUP - 50))
    # Outlines (x, y) of a plate become (y, z).
    cheeks = [at(cheek, (x, 0, 0), (90, 0, 90)) for x in (d.ROLL_HALF + 1, -d.ROLL_HALF - 1 - d.FORK)]
    floor = at(block(2 * (d.ROLL_HALF + 1 + d.FORK) - 4, 80, 16, 14, only="z"), (0, 0, _CUP))
    return cheeks[0] + cheeks[1] + floor - trim


def draw_roll_cap() -> bd.Part:
    """The coloured disc on a cheek, standing on z = 0."""
    return shapes.housing(24, 4, 2, 0)


def draw_turntable() -> bd.Part:
    """The dark ring between shoulder and upper arm."""
    return at(pin(37, 14, rim=0), (0, 0, _CUP - 15))


def draw_upper_arm() -> bd.Part:
    """The shell of the upper arm, with the elbow's fork below."""
    top = _CUP - 15
    shell = lathe([(35, -218), (41, -190), (45, -140), (44, top - 12), (40, top)])
    cheek = rounded_rims(hull_plate([((0, -d.UPPER), 34), ((0, -206), 34)], 11), 4)
    cheeks = [across(cheek, y) for y in (d.ELBOW_HALF + 12, -d.ELBOW_HALF - 1)]
    return shell + cheeks[0] + cheeks[1] + at(block(60, 2 * d.ELBOW_HALF + 20, 18, 12, only="z"), (0, 0, -226))


def draw_elbow_cap() -> bd.Part:
    """The coloured disc on the elbow, standing on z = 0."""
    return shapes.housing(20, 4, 2, 0)


def draw_elbow() -> bd.Part:
    """The elbow's drive along y, its neck downwards."""
    return across(shapes.housing(33, 2 * d.ELBOW_HALF, 3, 3), d.ELBOW_HALF) + at(cylinder(25, 50), (0, 0, -70))


def draw_forearm() -> bd.Part:
    """The shell of the forearm."""
    end = -d.FORE + 53
    return lathe([(28, end), (31, end + 24), (38, -128), (38, -106), (30, -78), (26, -70)]) + at(
        pin(24, 6), (0, 0, end - 4)
    )


def draw_wrist() -> bd.Part:
    """The turning wrist: a ring and a fork, its axis along y through the origin."""
    cheek = hull_plate([((0, 0), 17), ((0, 30), 18)], 7)
    ring = at(pin(30, 10, rim=2, foot=2), (0, 0, 38))
    return ring + across(cheek, 28) + across(cheek, -21)


def draw_cross() -> bd.Part:
    """The cross between wrist and hand: drives along y and x."""
    return across(shapes.housing(16, 40, 2, 2), 20) + at(shapes.housing(14, 54, 2, 2), (-27, 0, 0), (0, 90, 0))


def draw_palm() -> bd.Part:
    """The hand: a fork on the wrist's cross, a palm with rounded edges."""
    cheek = rounded_rims(hull_plate([((0, 0), 15), ((0, -36), 15)], 7), 2)
    cheeks = [at(cheek, (x, 0, 0), (90, 0, 90)) for x in (28, -35)]
    palm = bd.Pos(0, 0, -76) * bd.fillet(bd.Box(78, 30, 76).edges(), 9)
    return palm + cheeks[0] + cheeks[1]


def draw_knuckles() -> bd.Part:
    """The bar that the fingers are on, along x."""
    return at(shapes.housing(7, 74, 2, 2), (-37, 0, 0), (0, 90, 0))


def draw_finger() -> bd.Part:
    """A finger of two limbs, from the knuckles down."""
    return (
        capsule((0, 0, -10), (0, 0, -42), 7.6)
        + capsule((0, 0, -42), (0, 0, -70), 6.8)
        - at(cylinder(7, 40), (-20, 0, 0), (0, 90, 0))
    )


def draw_thumb() -> bd.Part:
    """The thumb: from the side of the palm forwards and down."""
    return capsule((12, 0, 0), (30, 0, -18), 8.5) + capsule((30, 0, -18), (36, 0, -48), 7.5)
