"""Shapes and colours used by several robots: shells, tubes, flanges, bolts. Lengths are in millimetres.

Every shape is one solid. Unless stated otherwise its lower face is on the plane z = 0; :func:`at` moves it,
:func:`between` places it between two points.
"""

from collections.abc import Sequence
from math import cos, pi, sin

import build123d as bd

Point = Sequence[float]

WHITE = "#f1f1ee"
"""Painted or moulded shells, a warm white."""
LIGHT = "#c9ccd0"
"""Light grey: caps, painted castings."""
ALUMINIUM = "#a9adb3"
"""Bare or anodised metal."""
STEEL = "#7d8289"
"""Machined steel: shafts, screws, bearings."""
DARK = "#3a3d42"
"""Dark grey: covers, cast housings."""
BLACK = "#1d1e21"
"""Rubber, black plastic, black anodised metal."""
RED, ORANGE, YELLOW = "#c8352e", "#f26a1b", "#f2b632"
GREEN, BLUE = "#3f9b57", "#2f6fb3"

_ON_FLOOR = (bd.Align.CENTER, bd.Align.CENTER, bd.Align.MIN)


def at(shape: bd.Shape, xyz: Point = (0, 0, 0), rpy: Point = (0, 0, 0)) -> bd.Shape:
    """A shape moved to a point and rotated about the fixed axes x, y, z [degrees], as in URDF."""
    roll, pitch, yaw = rpy
    turned = bd.Rot(0, 0, yaw) * bd.Rot(0, pitch, 0) * bd.Rot(roll, 0, 0)
    return bd.Pos(*xyz) * turned * shape


def between(shape: bd.Shape, start: Point, end: Point) -> bd.Shape:
    """A shape moved to ``start``, its z axis towards ``end``."""
    direction = bd.Vector(*end) - bd.Vector(*start)
    return bd.Plane(origin=tuple(start), z_dir=direction) * shape


def length(start: Point, end: Point) -> float:
    """The distance between two points."""
    return float((bd.Vector(*end) - bd.Vector(*start)).length)


def cylinder(radius: float, height: float) -> bd.Part:
    """A plain cylinder."""
    return bd.Cylinder(radius, height, align=_ON_FLOOR)


def rod(start: Point, end: Point, radius: float) -> bd.Shape:
    """A plain cylinder from one point to another."""
    return between(cylinder(radius, length(start, end)), start, end)


def cone(lower: float, upper: float, height: float) -> bd.Part:
    """A truncated cone with these radii below and above."""
    return bd.Cone(lower, upper, height, align=_ON_FLOOR)


def tube(outer: float, inner: float, height: float) -> bd.Part:
    """A cylinder with a bore through it."""
    return cylinder(outer, height) - cylinder(inner, height)


def capsule(start: Point, end: Point, radius: float) -> bd.Shape:
    """A bar with hemispherical ends, whose centres are the points."""
    return between(turned(_capsule_outline(length(start, end), radius)), start, end)


def _capsule_outline(height: float, radius: float) -> bd.Wire:
    s = radius / 2**0.5
    return bd.Wire(
        [
            bd.ThreePointArc((0, -radius), (s, -s), (radius, 0)).edge(),
            bd.Line((radius, 0), (radius, height)).edge(),
            bd.ThreePointArc((radius, height), (s, height + s), (0, height + radius)).edge(),
            bd.Line((0, height + radius), (0, -radius)).edge(),
        ]
    )


def housing(radius: float, height: float, edge: float, lower_edge: float | None = None) -> bd.Part:
    """A joint's housing: a cylinder with rounded rims, of radius ``edge``, or ``lower_edge`` at the lower one."""
    below = edge if lower_edge is None else lower_edge
    return turned(_rounded_rims(radius, height, below, edge))


def _rounded_rims(radius: float, height: float, below: float, above: float) -> bd.Wire:
    k = 1 - 1 / 2**0.5
    edges = [bd.Line((0, height), (0, 0)).edge()]
    corner = (radius - below, 0)
    edges.append(bd.Line((0, 0), corner).edge())
    if below:
        edges.append(bd.ThreePointArc(corner, (radius - k * below, k * below), (radius, below)).edge())
    edges.append(bd.Line((radius, below), (radius, height - above)).edge())
    if above:
        middle = (radius - k * above, height - k * above)
        edges.append(bd.ThreePointArc((radius, height - above), middle, (radius - above, height)).edge())
    edges.append(bd.Line((radius - above, height), (0, height)).edge())
    return bd.Wire(edges)


def turned(outline: bd.Wire) -> bd.Part:
    """The solid of revolution of a closed outline in (radius, height) about the z axis."""
    return bd.revolve(bd.Plane.XZ * bd.make_face(outline), bd.Axis.Z)


def lathe(profile: Sequence[tuple[float, float]], smooth: bool = False) -> bd.Part:
    """A turned part from points (radius, height), lowest first; a spline through them if ``smooth``."""
    first, last = profile[0], profile[-1]
    side = bd.Spline(*profile).edges() if smooth else bd.Polyline(*profile).edges()
    edges = [bd.Line((0, first[1]), first).edge()] if first[0] else []
    edges += list(side)
    edges += [bd.Line(last, (0, last[1])).edge()] if last[0] else []
    return turned(bd.Wire([*edges, bd.Line((0, last[1]), (0, first[1])).edge()]))


def on_circle(count: int, diameter: float, start: float = 0.0) -> list[tuple[float, float]]:
    """Points (x, y) spaced evenly on a circle, from an angle [degrees] on."""
    angles = [start * pi / 180 + 2 * pi * i / count for i in range(count)]
    return [(diameter / 2 * cos(angle), diameter / 2 * sin(angle)) for angle in angles]


def flange(
    radius: float, height: float, holes: Sequence[tuple[float, float]], hole_radius: float, bore: float = 0.0
) -> bd.Part:
    """A round plate with through holes at ``holes`` (x, y), and a central bore of radius ``bore``."""
    body = cylinder(radius, height)
    if bore:
        body -= cylinder(bore, height)
    for x, y in holes:
        body -= bd.Pos(x, y, 0) * cylinder(hole_radius, height)
    return body


def screw(diameter: float, socket: bool = True) -> bd.Part:
    """The head of a cap screw (ISO 4762): 1.5 diameters wide, one high, with a hexagon socket."""
    head = housing(0.75 * diameter, diameter, 0.12 * diameter, 0.0)
    if socket:
        key = bd.extrude(bd.RegularPolygon(0.43 * diameter, 6), 0.5 * diameter)
        head -= bd.Pos(0, 0, 0.55 * diameter) * key
    return head


def block(x: float, y: float, z: float, edge: float = 0.0, *, only: str = "") -> bd.Part:
    """A box around the z axis, on z = 0, with rounded edges: all, or those along one axis, ``only="z"``."""
    body = bd.Box(x, y, z, align=_ON_FLOOR)
    if not edge:
        return body
    edges = body.edges()
    if only:
        edges = edges.filter_by({"x": bd.Axis.X, "y": bd.Axis.Y, "z": bd.Axis.Z}[only])
    return bd.fillet(edges, edge)


def stadium(start: tuple[float, float], end: tuple[float, float], radius: float, height: float) -> bd.Part:
    """A plate with round ends, their centres at two points (x, y)."""
    return hull_plate([(start, radius), (end, radius)], height)


def hull_plate(circles: Sequence[tuple[tuple[float, float], float]], height: float) -> bd.Part:
    """A plate whose outline is the hull of circles, each a centre (x, y) and a radius: arms, knuckles, brackets."""
    with bd.BuildPart() as part:
        with bd.BuildSketch():
            for (x, y), radius in circles:
                with bd.Locations((x, y)):
                    bd.Circle(radius)
            bd.make_hull()
        bd.extrude(amount=height)
    return part.part


def loft(*sections: bd.Sketch) -> bd.Part:
    """A solid through closed sections, each placed with ``bd.Plane(...) * sketch``."""
    return bd.loft(list(sections))


def bend(path: bd.Edge | bd.Wire, radius: float) -> bd.Part:
    """A round bar along a path."""
    start = bd.Plane(origin=path @ 0, z_dir=path % 0)
    return bd.sweep(start * bd.Circle(radius), path)
