"""Plates, pins and slabs. Lengths are in millimetres.

The lower face of each is on the plane z = 0, as in :mod:`.shapes`.
"""

from collections.abc import Iterable

import build123d as bd

from .shapes import block, cylinder


def plate(x: float, y: float, z: float, edge: float = 0.0, rim: float = 0.0) -> bd.Part:
    """A plate with its upright edges rounded by ``edge`` and its upper rim chamfered by ``rim``."""
    return chamfered_top(block(x, y, z, edge, only="z"), rim)


def pin(radius: float, height: float, rim: float = 0.0, foot: float = 0.0) -> bd.Part:
    """A cylinder, chamfered at its upper end by ``rim`` and at its lower by ``foot``."""
    body = chamfered_top(cylinder(radius, height), rim)
    return bd.chamfer(body.edges().group_by(bd.Axis.Z)[0], foot) if foot else body


def slab(points: Iterable[tuple[float, float]], height: float, edge: float = 0.0) -> bd.Part:
    """A plate of this outline, its upright edges rounded by ``edge``."""
    body = bd.extrude(bd.make_face(bd.Polyline(*points, close=True).edges()), height)
    return bd.fillet(body.edges().filter_by(bd.Axis.Z), edge) if edge else body


def chamfered_top(body: bd.Part, size: float) -> bd.Part:
    """The body with chamfered edges of its highest face."""
    return bd.chamfer(body.faces().sort_by(bd.Axis.Z)[-1].edges(), size) if size else body


def corners(x: float, y: float) -> list[tuple[float, float]]:
    """The four points (+-x/2, +-y/2)."""
    return [(sx * x / 2, sy * y / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


def drilled(body: bd.Part, radius: float, depth: float, places: Iterable[tuple[float, float]]) -> bd.Part:
    """The body with holes along z, from z = 0 up to ``depth``, at positions (x, y)."""
    return body - [bd.Pos(x, y, 0) * cylinder(radius, depth) for x, y in places]
