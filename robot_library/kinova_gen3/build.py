"""Draw the Kinova Gen3 with 7 joints: ``python -m robot_library.kinova_gen3.build`` in the root of the checkout.

Writes gen3.step beside this file; every run gives the same bytes. Each link is drawn in its own frame [mm].

Radii and heights are measured at vertices of the maker's meshes (kortex_description/arms/gen3/7dof/meshes in the
repository that expected.json names). Distances between joints come from its joint table. The curves between them, the
outline of the rear panel and the colours are drawn from photographs.
"""

from dataclasses import dataclass
from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..shapes import ALUMINIUM, BLACK, DARK, at, block, cylinder, housing, lathe, on_circle

SHELL = "#cdd0d3"
"""The matt silver of the moulded shells."""


@dataclass(frozen=True)
class Actuator:
    """A size of actuator, and the shell around it."""

    radius: float
    """Of the shell."""
    collar: float
    """Radius of the ring that turns in the gap between two shells."""
    rim: float
    """From the joint's origin to the shell of the child link."""
    face: float
    """From the centre of a shell to the flat face that carries the next link."""
    offset: float
    """From the bending joint of a link to the link's middle plane."""


LARGE = Actuator(radius=46, collar=40, rim=16, face=13, offset=6.375)
SMALL = Actuator(radius=35, collar=30.5, rim=14.425, face=14.25, offset=0.175)
DEPTH = 1.09
"""Reach of a drum behind the axis of its tube, in radii."""
CLEAR = 1.0
"""Distance of the outlines from the tube where they do not cut it."""
GAP = 1.0
"""Clearance between turning and fixed shells."""

BASE_HEIGHT = 156.43
FOOT_HEIGHT = 38.8
PANEL = (8.0, 62.0, FOOT_HEIGHT)
"""The rear panel with its connectors: depth, width, height."""
BOLTS = ((26.117, 32.251), (26.117, -32.251), (-14.872, 38.743), (-14.872, -38.743))
BOLT_RADIUS, BOLT_DEPTH = 2.5, 16.8
PINS = ((20.75, 35.94), (-20.75, -35.94))
PIN_RADIUS, PIN_DEPTH = 1.25, 9.3

SHOULDER = 128.38
UPPER_ARM = 210.38
FOREARM = 208.43
WRIST = 105.93

INTERFACE_RADIUS = 37.5
INTERFACE_START, INTERFACE_END = 41.425, 61.525
BUTTON_RADIUS, BUTTON_CENTRE = 6.5, (-9.0, 52.0)
TOOL_BOLTS, TOOL_BOLT_RADIUS, TOOL_RECESS = 50.0, 1.6, (19.0, 4.0)


def bent_shell(joint: Actuator, length: float, end: Actuator | None = None) -> bd.Part:
    """The shell of a link on a bending joint: a tube up the z axis, and at the origin a drum that faces +y.

    Args:
        joint: The drive at the origin, whose axis is y.
        length: From that axis to the end of the tube.
        end: The drive at that end, if it is another one: the tube tapers to it.
    """
    r, top = joint.radius, length
    tip = (end or joint).radius
    tube = cylinder(r, top)
    if tip != r:
        tube &= lathe([(r, 0), (r, 0.45 * top), (tip, top)])
    tube &= bd.extrude(bd.Plane.XZ * _front(r, tip + CLEAR, top), 2 * r, both=True)
    tube &= bd.extrude(bd.Plane.YZ * _side(joint, tip + CLEAR, top), 2 * r, both=True)
    drum = at(housing(r, DEPTH * r - joint.face, 0.3 * r), (0, -joint.face, 0), (90, 0, 0))
    return tube + drum


def _front(r: float, tip: float, top: float) -> bd.Sketch:
    """Outline of the tube seen along the joint's axis: slimmer above the drum."""
    waist, level, full = 0.79 * r, min(1.25 * r, 0.55 * top), top - 0.35 * r
    right = bd.Spline((0.95 * r, 0), (waist, level), (tip, full), tangents=((-0.2, 1), (0, 1)))
    left = bd.mirror(right, bd.Plane.YZ)
    lid = bd.Polyline((tip, full), (tip, top), (-tip, top), (-tip, full))
    return bd.make_face([*right.edges(), *lid.edges(), *left.edges(), bd.Line((-0.95 * r, 0), (0.95 * r, 0)).edge()])


def _side(joint: Actuator, tip: float, top: float) -> bd.Sketch:
    """Outline of the tube seen across the joint's axis: flat at the drum, then out to the full width."""
    r, face = joint.radius, -joint.face
    neck = bd.Spline((face, 1.05 * r), (-0.1 * r, 1.4 * r), (tip, top - 0.3 * r), tangents=((0, 1), (0.3, 1)))
    rest = bd.Polyline(
        (tip, top - 0.3 * r), (tip, top), (-r - CLEAR, top), (-r - CLEAR, 0), (face, 0), (face, 1.05 * r)
    )
    return bd.make_face([*neck.edges(), *rest.edges()])


def ring(drive: Actuator, height: float) -> bd.Part:
    """The visible ring of a drive between two shells, on z = 0."""
    return housing(drive.collar, height, 2.0, 0.0)


def base_link() -> list[Body]:
    """z up, on the table."""
    column = cylinder(LARGE.radius, BASE_HEIGHT - LARGE.rim)
    out, width, height = PANEL
    panel = at(block(out + 20, width, height, 4, only="z"), (-LARGE.radius + 10 - out / 2, 0, 0))
    groove = bd.Pos(0, 0, FOOT_HEIGHT) * (cylinder(50, 1.2) - cylinder(LARGE.radius - 1, 1.2))
    column = column + panel - groove
    for places, radius, depth in ((BOLTS, BOLT_RADIUS, BOLT_DEPTH), (PINS, PIN_RADIUS, PIN_DEPTH)):
        for x, y in places:
            column -= bd.Pos(x, y, 0) * cylinder(radius, depth)
    back = -LARGE.radius - out
    plate = at(block(1.5, width - 10, height - 10, 2, only="x"), (back - 0.75, 0, 5))
    plugs = [
        at(cylinder(6, 8), (back - 1.5, -16, 14), (0, -90, 0)),
        at(block(12, 16, 13, 1), (back - 7.5, 4, 18)),
        at(cylinder(5, 5), (back - 1.5, 20, 26), (0, -90, 0)),
    ]
    return [
        Body("shell", column, SHELL),
        Body("ring", at(ring(LARGE, LARGE.rim - GAP), (0, 0, BASE_HEIGHT - LARGE.rim)), DARK),
        Body("panel", plate, BLACK),
        *(Body("connector", plug, ALUMINIUM) for plug in plugs),
    ]


def turning_link(drive: Actuator, reach: float, rim: float, bend: Actuator) -> list[Body]:
    """A link that turns about the axis of its tube: down the z axis to a drum about y that faces +y.

    Args:
        drive: The drive that turns it.
        reach: From that joint to the axis of the next.
        rim: From that joint to the shell.
        bend: The drive at the drum.
    """
    shell = at(bent_shell(bend, reach - rim), (0, 0, -reach))
    upper = at(ring(drive, rim - GAP), (0, 0, -GAP), (180, 0, 0))
    plane = bend.offset - GAP
    side = at(ring(bend, plane + bend.face), (0, -bend.face, -reach), (-90, 0, 0))
    return [Body("shell", shell, SHELL), Body("ring", upper, DARK), Body("ring", side, DARK)]


def bending_link(bend: Actuator, reach: float, drive: Actuator) -> list[Body]:
    """A link on a bending joint about z, its tube down the y axis to the next joint."""
    depth = bend.face + bend.offset
    shell = at(bent_shell(bend, reach - drive.rim, drive), (0, 0, -bend.offset), (90, 0, 0))
    below = at(ring(bend, depth - GAP), (0, 0, -GAP), (180, 0, 0))
    end = at(ring(drive, drive.rim - GAP), (0, -reach + drive.rim, -bend.offset), (90, 0, 0))
    return [Body("shell", shell, SHELL), Body("ring", below, DARK), Body("ring", end, DARK)]


def bracelet_link() -> list[Body]:
    """z towards the wrist: the last piece of shell, and the interface for tools."""
    upper = at(ring(SMALL, SMALL.rim - GAP), (0, 0, -GAP), (180, 0, 0))
    shell = at(cylinder(SMALL.radius, INTERFACE_START - SMALL.rim), (0, 0, -INTERFACE_START))
    interface = at(housing(INTERFACE_RADIUS, INTERFACE_END - INTERFACE_START, 2, 1), (0, 0, -INTERFACE_END))
    radius, depth = TOOL_RECESS
    interface -= at(cylinder(radius, depth), (0, 0, -INTERFACE_END))
    for x, y in on_circle(4, TOOL_BOLTS, 45):
        interface -= at(cylinder(TOOL_BOLT_RADIUS, 8), (x, y, -INTERFACE_END))
    y, z = BUTTON_CENTRE
    buttons = []
    for side in (-1, 1):
        button = at(cylinder(BUTTON_RADIUS, 6), (side * (INTERFACE_RADIUS - 4), y, -z), (0, side * 90, 0))
        interface -= button
        buttons.append(
            Body("button", button & at(cylinder(INTERFACE_RADIUS + 0.6, 30), (0, 0, -INTERFACE_END - 5)), ALUMINIUM)
        )
    return [Body("ring", upper, DARK), Body("shell", shell, SHELL), Body("interface", interface, BLACK), *buttons]


def links() -> dict[str, list[Body]]:
    """The bodies of every link, in its own frame."""
    return {
        "base_link": base_link(),
        "shoulder_link": turning_link(LARGE, SHOULDER, LARGE.rim, LARGE),
        "half_arm_1_link": bending_link(LARGE, UPPER_ARM, LARGE),
        "half_arm_2_link": turning_link(LARGE, UPPER_ARM, LARGE.rim, LARGE),
        "forearm_link": bending_link(LARGE, FOREARM, SMALL),
        "spherical_wrist_1_link": turning_link(SMALL, WRIST, SMALL.rim, SMALL),
        "spherical_wrist_2_link": bending_link(SMALL, WRIST, SMALL),
        "bracelet_link": bracelet_link(),
    }


def main() -> None:
    """Draw the robot."""
    draw_described(Path(__file__).parent, links())


if __name__ == "__main__":
    main()
