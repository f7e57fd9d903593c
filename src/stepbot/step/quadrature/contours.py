"""Boundaries of faces as quadrature rules in the plane of their parameters.

By Green's theorem the integral of g over a face is minus that of G du around its boundary, where G is the integral of g
along v from wherever. An edge is divided where its curve is less smooth, and where it crosses parameters at which the
surface is.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from msgspec import Struct, field
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d
from OCP.GeomAbs import GeomAbs_CurveType
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from stepbot.geometry.fixed_point import distinct
from stepbot.geometry.spatial import Array, matrix_product

from ..kernel import explored
from .curves import Curve, curve_of
from .splines import Indices

_ORDERS = ((8, 10), (32, 6), (float("inf"), 4))
"""Gauss points on each piece of an edge that has up to so many: many pieces are short."""
_COARSE = {10: 7, 6: 4, 4: 3, 3: 3}
"""Gauss points whose result shows the error of more; three are exact where the integrand is a polynomial."""
_QUARTER = 0.5 * np.pi
_SAMPLES = 8
"""Parts of a piece in each of which it is taken to cross a parameter once at most."""
_ROOT_STEPS = 16


@lru_cache
def gauss(order: int) -> tuple[Array, Array]:
    """Nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return 0.5 * (nodes + 1.0), 0.5 * weights


class Rule(Struct, frozen=True, eq=False):
    """Points of boundaries."""

    faces: Indices
    """Shape (n,): number of the face."""
    uv: Array
    """Shape (n, 2)."""
    du: Array
    """Shape (n,): du of the point's piece of the face's boundary."""


class _Edge(Struct, frozen=True, eq=False):
    """An edge that is neither a straight line nor an arc."""

    face: int
    curve: Curve
    pieces: Array
    """Parameters (k,) between which it is smooth, and so is its surface."""
    is_reversed: bool
    frame: tuple[Array, Array] | None = None
    """Origin (3,) and axes (3, 2) of the plane of a curve in space; None where the curve is in the parameters."""

    def rule(self, parts: int, coarse: bool) -> Rule:
        # Gauss points on all pieces of a curve, and the parameter interval of each.
        nodes, weights = gauss(_order(next(order for count, order in _ORDERS if len(self.pieces) <= count), coarse))
        share = np.arange(parts) / parts
        start = (self.pieces[:-1, None] + np.diff(self.pieces)[:, None] * share).reshape(-1)
        length = np.repeat(np.diff(self.pieces) / parts, parts)
        t, dt = (start[:, None] + length[:, None] * nodes).reshape(-1), (length[:, None] * weights).reshape(-1)
        uv, duv = self.curve.at(t)
        if self.frame is not None:
            origin, axes = self.frame
            uv, duv = matrix_product(uv - origin, axes), matrix_product(duv, axes)
        return Rule(np.full(len(uv), self.face), uv, (-duv[:, 0] if self.is_reversed else duv[:, 0]) * dt)


class Contours(Struct):
    """The boundaries of faces of one kind, as they are collected."""

    lines: list[tuple[int, float, float, float, float]] = field(default_factory=list)
    """Straight lines in the parameters: face, start, end."""
    arcs: list[tuple[float, ...]] = field(default_factory=list)
    """Ellipses c + p cos t + q sin t in the plane: face, c, p, q, first and last t."""
    others: list[_Edge] = field(default_factory=list)

    def rule(self, turning: bool, parts: int, coarse: bool = False) -> Rule:
        """All of them.

        Args:
            turning: Whether u is an angle; if not, the integrand is a polynomial of a low degree along lines.
            parts: How many parts each piece is divided into.
            coarse: Whether with fewer points on each part.
        """
        lines, arcs = np.array(self.lines).reshape(-1, 5), np.array(self.arcs).reshape(-1, 9)
        return _joined(
            [
                *_line_rules(lines, turning, parts, coarse),
                *_arc_rules(arcs, parts, coarse),
                *(edge.rule(parts, coarse) for edge in self.others),
            ]
        )


def edges_of(face: Any) -> Iterator[tuple[Any, bool]]:
    """The edges of a face that faces forward, and whether each runs backwards; none that lie inside of it."""
    for edge in map(TopoDS.Edge, explored(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
        orientation = edge.Orientation()
        if orientation in (TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED):
            yield edge, orientation == TopAbs_Orientation.TopAbs_REVERSED


def add_planar(contours: Contours, number: int, face: Any, position: Any) -> None:
    """Add the boundary of a plane face, by its edges in space."""
    frame = [(a.X(), a.Y(), a.Z()) for a in (position.Location(), position.XDirection(), position.YDirection())]
    (ox, oy, oz), (ax, ay, az), (bx, by, bz) = frame
    axes = np.array(frame[1:]).T
    at = gp_Pnt()
    for edge, is_reversed in edges_of(face):
        adaptor = BRepAdaptor_Curve(edge)
        kind = adaptor.GetType()
        if kind == GeomAbs_CurveType.GeomAbs_Line:
            ends = []
            for parameter in (adaptor.FirstParameter(), adaptor.LastParameter()):
                adaptor.D0(parameter, at)
                x, y, z = at.X() - ox, at.Y() - oy, at.Z() - oz
                ends.append((x * ax + y * ay + z * az, x * bx + y * by + z * bz))
            (a, b), (c, d) = reversed(ends) if is_reversed else ends
            contours.lines.append((number, a, b, c, d))
        elif kind == GeomAbs_CurveType.GeomAbs_Circle:
            circle = adaptor.Circle()
            center, across, beside = circle.Location(), circle.XAxis().Direction(), circle.YAxis().Direction()
            table = np.array([(a.X(), a.Y(), a.Z()) for a in (center, across, beside)])
            table[0] -= frame[0]
            table[1:] *= circle.Radius()
            ends = [adaptor.FirstParameter(), adaptor.LastParameter()]
            contours.arcs.append(
                (number, *matrix_product(table, axes).reshape(-1), *(reversed(ends) if is_reversed else ends))
            )
        else:
            curve = curve_of(adaptor, 3)
            contours.others.append(_Edge(number, curve, curve.pieces, is_reversed, (np.array(frame[0]), axes)))


def add_curved(contours: Contours, number: int, face: Any, breaks: tuple[Array, Array], split_lines: bool) -> None:
    """Add the boundary of any other face, by the curves that its edges have in its parameters.

    Args:
        number: The face's.
        face: A face that faces forward.
        breaks: Parameters u and v at which its surface is less smooth.
        split_lines: Whether straight lines are to be divided there too.
    """
    at = gp_Pnt2d()
    for edge, is_reversed in edges_of(face):
        adaptor = BRepAdaptor_Curve2d(edge, face)
        if not split_lines and adaptor.GetType() == GeomAbs_CurveType.GeomAbs_Line:
            ends = []
            for parameter in (adaptor.FirstParameter(), adaptor.LastParameter()):
                adaptor.D0(parameter, at)
                ends.append((at.X(), at.Y()))
            (a, b), (c, d) = reversed(ends) if is_reversed else ends
            if a != c:
                contours.lines.append((number, a, b, c, d))
        else:
            curve = curve_of(adaptor, 2)
            contours.others.append(_Edge(number, curve, _divided(curve, breaks), is_reversed))


def _line_rules(lines: Array, turning: bool, parts: int, coarse: bool) -> Iterator[Rule]:
    lines = lines[lines[:, 1] != lines[:, 3]]
    if not len(lines):
        return
    start, way = lines[:, 1:3], lines[:, 3:] - lines[:, 1:3]
    order = _order(10 if turning else 3, coarse)
    owner, share, weight = _shares(way[:, 0] if turning else np.zeros(len(lines)), order, parts)
    uv = start[owner] + share[:, None] * way[owner]
    yield Rule(lines[owner, 0].astype(np.int64), uv, way[owner, 0] * weight)


def _arc_rules(arcs: Array, parts: int, coarse: bool) -> Iterator[Rule]:
    if not len(arcs):
        return
    owner, share, weight = _shares(arcs[:, 8] - arcs[:, 7], _order(10, coarse), parts)
    first, last = arcs[owner, 7], arcs[owner, 8]
    t = first + share * (last - first)
    cos, sin = np.cos(t)[:, None], np.sin(t)[:, None]
    center, p, q = (arcs[owner, k : k + 2] for k in (1, 3, 5))
    du = (q * cos - p * sin)[:, 0] * (last - first) * weight
    yield Rule(arcs[owner, 0].astype(np.int64), center + cos * p + sin * q, du)


def _shares(angles: Array, order: int, parts: int) -> tuple[Indices, Array, Array]:
    """Gauss points on [0, 1] for each of several angles, on parts of no more than a quarter of a turn.

    Returns:
        Number of the angle, place on [0, 1], weight, of each point.
    """
    counts = parts * np.maximum(1, np.ceil(np.abs(angles) / _QUARTER - 1e-9)).astype(np.int64)
    nodes, weights = gauss(order)
    whose = np.repeat(np.arange(len(angles)), counts)
    part = np.arange(len(whose)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (part[:, None] + nodes) / counts[whose, None]
    return np.repeat(whose, order), share.reshape(-1), (weights / counts[whose, None]).reshape(-1)


def _joined(rules: Sequence[Rule]) -> Rule:
    if not rules:
        return Rule(np.empty(0, dtype=np.int64), np.empty((0, 2)), np.empty(0))
    return Rule(*(np.concatenate([getattr(rule, name) for rule in rules]) for name in ("faces", "uv", "du")))


def _order(order: int, coarse: bool) -> int:
    return _COARSE[order] if coarse else order


def _divided(curve: Curve, breaks: tuple[Array, Array]) -> Array:
    """The ends of a curve's pieces, and where it crosses breaks of the surface between."""
    pieces = curve.pieces
    if not (len(breaks[0]) or len(breaks[1])):
        return pieces
    if not curve.is_line:
        share = np.arange(_SAMPLES) / _SAMPLES
        pieces = np.append((pieces[:-1, None] + np.diff(pieces)[:, None] * share).reshape(-1), pieces[-1])
    uv = curve.at(pieces)[0]
    ends = distinct(np.concatenate([curve.pieces, _crossings(curve, breaks, pieces, uv)]))
    return ends[np.diff(ends, prepend=-np.inf) > 1e-12 * (curve.last - curve.first)]


def _crossings(curve: Curve, breaks: tuple[Array, Array], t: Array, uv: Array) -> Array:
    """Parameters at which a curve crosses breaks of u or v, by the Illinois method."""
    where, axes, targets = [], [], []
    for axis in (0, 1):
        inner = breaks[axis][1:-1]  # beyond the domain the surface goes on as it is
        interval = np.searchsorted(inner, uv[:, axis])
        low, high = np.minimum(interval[:-1], interval[1:]), np.maximum(interval[:-1], interval[1:])
        for piece in np.nonzero(high > low)[0].tolist():
            crossed = inner[low[piece] : high[piece]]
            where += [piece] * len(crossed)
            axes += [axis] * len(crossed)
            targets += crossed.tolist()
    if not where:
        return np.empty(0)
    target = np.array(targets)
    a, b = t[where], t[np.array(where) + 1]
    fa, fb = uv[where, axes] - target, uv[np.array(where) + 1, axes] - target
    close, side = 1e-9 * np.abs(uv).max(), np.zeros(len(a))
    c: Array = b
    for _ in range(_ROOT_STEPS):
        slope = fb - fa
        c = b - fb * (b - a) / np.where(slope != 0.0, slope, 1.0)
        if curve.is_line:
            break
        fc = curve.at(c)[0][np.arange(len(c)), axes] - target
        if (np.abs(fc) <= close).all():
            break
        left = np.sign(fc) == np.sign(fa)
        fb = np.where(left & (side == 1), 0.5 * fb, fb)
        fa = np.where(~left & (side == -1), 0.5 * fa, fa)
        a, fa, b, fb = np.where(left, c, a), np.where(left, fc, fa), np.where(left, b, c), np.where(left, fb, fc)
        side = np.where(left, 1, -1)
    return c
