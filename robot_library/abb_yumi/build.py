"""Draw the ABB YuMi IRB 14000 with its grippers: ``python -m robot_library.abb_yumi.build`` in the checkout's root.

Writes yumi.step beside this file; every run gives the same bytes. Each link is drawn in its own frame [mm]. Both arms
use the same seven shapes.

Distances between joints come from the joint table in expected.json, the footprint of 399 x 497 from ABB's data sheet.
Radii, the torso's outline and the colours are drawn from photographs.
"""

from dataclasses import dataclass
from pathlib import Path

import build123d as bd

from ..description import load_description
from ..drawing import Body, draw_described
from ..shapes import ALUMINIUM, BLACK, DARK, at, block, cylinder, housing, hull_plate, lathe, loft, on_circle

SHELL = "#dcdddb"
"""Light grey of the soft shells."""
GREY = "#6d7074"
"""Of joints and of the torso's base."""
ABB_RED = "#d8222a"
GAP = 2.0
"""Clearance between turning and fixed shells."""

TORSO = (
    (0.0, 399.0, 497.0, -30.0),
    (26.0, 384.0, 478.0, -30.0),
    (120.0, 295.0, 345.0, -40.0),
    (200.0, 262.0, 305.0, -46.0),
    (400.0, 230.0, 290.0, -48.0),
    (470.0, 190.0, 235.0, -54.0),
    (515.0, 135.0, 165.0, -60.0),
    (540.0, 70.0, 85.0, -64.0),
)
"""Sections: height, depth, width, and distance of the centre in front of the origin."""
SHOULDER, SHOULDER_DEPTH = 60.0, 120.0


@dataclass(frozen=True)
class Roll:
    """A link that turns about its tube, z, and carries a joint about y."""

    radius: float
    """Of the tube."""
    end: float
    """Of the tube, along z."""
    x: float
    z: float
    """Where the next joint is."""
    drum: float
    """Radius of the tongue around that joint."""


@dataclass(frozen=True)
class Bend:
    """A link that a joint about z bends: a fork around that joint, and a tube along y."""

    fork: float
    """Radius of the fork's cheeks."""
    x: float
    y: float
    """Where the next joint is."""
    radius: float
    """Of the tube."""


ROLLS = (Roll(58, 46, 30, 100, 44), Roll(48, 30, -41.88, 78.73, 40), Roll(42, 52, -27, 100.39, 28))
BENDS = (Bend(48, -30, 172.83, 50), Bend(43, 40.5, 164.61, 42), Bend(36, 27, 29, 32))
TONGUE, CHEEK = 0.48, 0.92
"""Half the thickness of a tongue, and of a fork, in radii of the fork."""

FLANGE_END, FLANGE_RADIUS = 7.0, 31.5
GRIPPER = (66.0, 54.0, 83.7)
FINGER_SIDE, FINGER_LENGTH = 6.5, 48.0


def torso() -> list[Body]:
    """x forward, z up, on the table."""
    sections = (
        bd.Plane(origin=(x, 0, z)) * bd.RectangleRounded(depth, width, 0.47 * depth) for z, depth, width, x in TORSO[1:]
    )
    body = loft(*sections)
    plinth = at(block(*TORSO[0][1:3], TORSO[1][0], 120, only="z"), (TORSO[0][3], 0, 0))
    plinth = bd.fillet(plinth.edges().group_by(bd.Axis.Z)[-1], 8)
    for x, y in ((120, 205), (120, -205), (-120, 205), (-120, -205)):
        plinth -= at(cylinder(5.5, 30), (x + TORSO[0][3], y, 0))
    joints = load_description(Path(__file__).parent / "expected.json").joints
    bodies = []
    for side in "rl":
        X_BJ = joints[f"yumi_joint_1_{side}"].X_PC
        z = X_BJ[:3, 2]
        start = 1000 * X_BJ[:3, 3] - SHOULDER_DEPTH * z
        seat = bd.Plane(origin=tuple(start), z_dir=tuple(z)) * housing(SHOULDER + 6, SHOULDER_DEPTH - 18, 10, 0)
        body += seat
        ring = bd.Plane(origin=tuple(start + (SHOULDER_DEPTH - 18) * z), z_dir=tuple(z)) * cylinder(
            SHOULDER - 6, 18 - GAP
        )
        bodies.append(Body("shoulder ring", ring, DARK))
    front = TORSO[3][1] / 2 + TORSO[3][3]
    logo = [at(block(4, 13, 22), (front + 2, y, 225)) for y in (-16, 0, 16)]
    logo = [Body("logo", mark - body, ABB_RED) for mark in logo]
    return [Body("torso", body, SHELL), Body("plinth", plinth, GREY), *bodies, *logo]


def rolling_link(s: Roll, fork: float, collar: float) -> list[Body]:
    """A tube, and the tongue that the next link's fork embraces."""
    half = TONGUE * fork
    tube = at(housing(s.radius, s.end - GAP, 0.35 * s.radius, 0), (0, 0, GAP))
    plan = [((0, s.end - 0.2 * s.radius), 0.7 * s.radius), ((s.x, s.z), s.drum)]
    tongue = at(hull_plate(plan, 2 * half), (0, half, 0), (90, 0, 0))
    below = at(block(400, 400, 200), (0, 0, s.end / 2 - 200))
    ring = at(cylinder(collar, GAP - 0.2), (0, 0, 0.2))
    return [Body("shell", tube, SHELL), Body("tongue", tongue - tube - below, GREY), Body("ring", ring, DARK)]


def bending_link(s: Bend, drum: float) -> list[Body]:
    """A fork with caps on its cheeks around a tongue of radius ``drum``, and a tube."""
    r, half, slot = s.fork, CHEEK * s.fork, TONGUE * s.fork + 1
    end = s.y - GAP
    body = hull_plate([((0, 0), r), ((0.8 * s.x, 0.55 * end), 0.9 * s.radius)], 2 * half)
    rims = body.faces().filter_by(bd.Axis.Z).edges()
    body = at(bd.fillet(rims, 0.3 * r), (0, 0, -half))
    seam = 0.55 * end  # fork and tube meet in a plane: curves of rounded rims on a tube would make a large file
    body &= at(block(8 * r, 8 * r, 2 * half), (0, seam - 4 * r, -half))
    body += at(housing(s.radius, end - seam, 2, 0.25 * r), (s.x, seam, 0), (-90, 0, 0))
    # The slot comes last: two cheeks without the tube would be two solids, and the kernel gives them in any order.
    body -= at(cylinder(drum + GAP, 2 * slot), (0, 0, -slot))
    body -= at(block(6 * r, 4 * r, 2 * slot), (0, -2 * r, -slot))
    caps = [at(housing(0.55 * r, 4, 2, 0), (0, 0, side * half), (0 if side > 0 else 180, 0, 0)) for side in (-1, 1)]
    return [Body("shell", body, SHELL), *(Body("cap", cap, GREY) for cap in caps)]


def last_link() -> list[Body]:
    """z out of the flange."""
    body = at(lathe([(FLANGE_RADIUS, 0), (FLANGE_RADIUS, 3), (27, 5)]), (0, 0, FLANGE_END - 5))
    for x, y in on_circle(4, 40, 45):
        body -= at(cylinder(1.6, 5), (x, y, FLANGE_END - 5))
    return [Body("flange", body, ALUMINIUM)]


def gripper_base() -> list[Body]:
    """The servo gripper: z away from the arm, the fingers slide along x."""
    x, y, z = GRIPPER
    mount = cylinder(30, 12)
    body = at(block(x, y, z - 12 - 10, 14, only="z"), (0, 0, 12))
    body = bd.chamfer(body.edges().group_by(bd.Axis.Z)[-1], 6)
    camera = at(cylinder(7, 3), (0, y / 2, 52), (-90, 0, 0))
    panel = at(block(40, 2, 30, 6, only="y"), (0, -y / 2 - 1, 28))
    rail = at(block(x - 4, 26, 10, 3, only="z"), (0, 0, z - 10))
    return [
        Body("mount", mount, DARK),
        Body("body", body, SHELL),
        Body("camera", camera, BLACK),
        Body("panel", panel, GREY),
        Body("rail", rail, BLACK),
    ]


def finger() -> list[Body]:
    """A finger that opens towards -x; its face is at x = 0."""
    carriage = at(block(16, 11, 9), (-8.2, -0.5, 0.3))
    blade = at(block(7, 10, FINGER_LENGTH - 9), (-3.5 - 0.2, FINGER_SIDE, 9.3))
    blade = bd.chamfer(blade.edges().filter_by(bd.Axis.Y).group_by(bd.Axis.Z)[-1].sort_by(bd.Axis.X)[:1], 4)
    bridge = at(block(7, 2.5, 9), (-3.7, 5 + 1.25, 0.3))
    return [Body("carriage", carriage + bridge, DARK), Body("blade", blade, ALUMINIUM)]


def links() -> dict[str, list[Body]]:
    """The bodies of every link that has a shape, in the link's frame."""
    found = {"yumi_body": torso()}
    for side in "rl":
        shapes = [part for roll, bend in zip(ROLLS, BENDS, strict=True) for part in ((roll, bend), (bend,))]
        drum = 0.0
        for number, (first, *rest) in enumerate(shapes, 1):
            bodies = rolling_link(first, rest[0].fork, first.radius - 6) if rest else bending_link(first, drum)
            found[f"yumi_link_{number}_{side}"] = bodies
            drum = first.drum if rest else 0.0
        found[f"yumi_link_7_{side}"] = last_link()
        found[f"gripper_{side}_base"] = gripper_base()
        for which in "rl":
            found[f"gripper_{side}_finger_{which}"] = finger()
    return found


def main() -> None:
    """Draw the robot."""
    draw_described(Path(__file__).parent, links())


if __name__ == "__main__":
    main()
