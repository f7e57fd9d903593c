"""The kernel's curves and B-splines as functions of arrays, with the parameters between which they are smooth.

Reading poles and knots one by one through the binding takes a millisecond for a hundred of them. So they go through the
kernel's binary format (BinTools): a tag, flags, degrees, counts, poles with their weights, knots with multiplicities.
"""

import io
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from msgspec import Struct
from OCP.BinTools import BinTools_Curve2dSet, BinTools_CurveSet, BinTools_SurfaceSet
from OCP.collections import Array1_double
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_Shape
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Vec, gp_Vec2d

from stepbot.geometry.spatial import Array

from .splines import Basis, SplineSurface, curve_at, is_rational

_CONICS = (GeomAbs_CurveType.GeomAbs_Circle, GeomAbs_CurveType.GeomAbs_Ellipse)
_CURVE_TAG, _SURFACE_TAG = 7, 9
_KNOT = np.dtype([("knot", "<f8"), ("multiplicity", "<i4")])
_QUARTER = 0.5 * np.pi


class Curve(Struct, frozen=True, eq=False):
    """A piece of a curve, in the plane or in space."""

    at: Callable[[Array], tuple[Array, Array]]
    """Points and derivatives, each (m, d), at parameters (m,)."""
    breaks: Array
    """Parameters (k,) between which the curve is smooth, and turns by no more than a quarter."""
    is_line: bool
    first: float
    last: float

    @property
    def pieces(self) -> Array:
        """``first``, the breaks between, and ``last``."""
        inner = self.breaks[(self.breaks > self.first) & (self.breaks < self.last)]
        return np.concatenate([[self.first], inner, [self.last]])


def curve_of(adaptor: Any, dimensions: int) -> Curve:
    """The curve of one of the kernel's adaptors."""
    first, last, kind = adaptor.FirstParameter(), adaptor.LastParameter(), adaptor.GetType()
    if kind == GeomAbs_CurveType.GeomAbs_Line:
        return Curve(_sampler(adaptor, dimensions), np.empty(0), True, first, last)
    if kind == GeomAbs_CurveType.GeomAbs_BSplineCurve:
        basis, poles = spline_curve(adaptor.BSpline(), dimensions)
        return Curve(partial(curve_at, basis, poles), basis.breaks(is_rational(poles)), False, first, last)
    if kind in _CONICS:
        breaks = np.linspace(first, last, max(1, int(np.ceil((last - first) / _QUARTER - 1e-9))) + 1)
    else:
        bounds = Array1_double(1, adaptor.NbIntervals(GeomAbs_Shape.GeomAbs_CN) + 1)
        adaptor.Intervals(bounds, GeomAbs_Shape.GeomAbs_CN)
        breaks = np.array(list(bounds))
    return Curve(_sampler(adaptor, dimensions), breaks, False, first, last)


def spline_surface(surface: Any) -> SplineSurface:
    """A ``Geom_BSplineSurface`` as arrays."""
    periodic = surface.IsUPeriodic(), surface.IsVPeriodic()
    if any(periodic):
        surface = surface.Copy()
        for direction, is_periodic in zip("UV", periodic, strict=True):
            if is_periodic:
                getattr(surface, f"Set{direction}NotPeriodic")()
    data, at = _written(BinTools_SurfaceSet(), surface, _SURFACE_TAG)
    rational = data[at] or data[at + 1]
    degrees = np.frombuffer(data, "<u2", 2, at + 4).tolist()
    rows, columns, *knot_counts = np.frombuffer(data, "<i4", 4, at + 8).tolist()
    poles, at = _poles(data, at + 24, rows * columns, 3, bool(rational))
    bases = []
    for degree, count, is_periodic in zip(degrees, knot_counts, periodic, strict=True):
        knots, at = _knots(data, at, count)
        bases.append(_basis(degree, knots, is_periodic))
    return SplineSurface(bases[0], bases[1], poles.reshape(rows, columns, 4))


def spline_curve(curve: Any, dimensions: int) -> tuple[Basis, Array]:
    """The basis and the homogeneous poles (n, d + 1) of a ``Geom_BSplineCurve`` or ``Geom2d_BSplineCurve``."""
    if periodic := curve.IsPeriodic():
        curve = curve.Copy()
        curve.SetNotPeriodic()
    data, at = _written(BinTools_Curve2dSet() if dimensions == 2 else BinTools_CurveSet(), curve, _CURVE_TAG)
    degree = int.from_bytes(data[at + 2 : at + 4], "little")
    pole_count, knot_count = np.frombuffer(data, "<i4", 2, at + 4).tolist()
    poles, at = _poles(data, at + 12, pole_count, dimensions, bool(data[at]))
    return _basis(degree, _knots(data, at, knot_count)[0], periodic), poles


def _basis(degree: int, knots: Array, is_periodic: bool) -> Basis:
    return Basis(degree, knots, float(knots[-degree - 1] - knots[degree]) if is_periodic else 0.0)


def _written(geometries: Any, geometry: Any, tag: int) -> tuple[bytes, int]:
    """A B-spline in the kernel's binary format, and where its flags begin."""
    geometries.Add(geometry)
    stream = io.BytesIO()
    geometries.Write(stream)
    data = stream.getvalue()
    at = data.index(b"\n") + 1
    if data[at] != tag:
        raise AssertionError(f"the kernel wrote a geometry of kind {data[at]} where a B-spline was expected")
    return data, at + 1


def _poles(data: bytes, at: int, count: int, dimensions: int, rational: bool) -> tuple[Array, int]:
    """Homogeneous poles (count, dimensions + 1), and where they end."""
    width = dimensions + rational
    poles = np.ones((count, dimensions + 1))
    poles[:, :width] = np.frombuffer(data, "<f8", count * width, at).reshape(count, width)
    poles[:, :-1] *= poles[:, -1:]
    return poles, at + 8 * count * width


def _knots(data: bytes, at: int, count: int) -> tuple[Array, int]:
    """Knots, repeated by their multiplicity, and their end."""
    knots = np.frombuffer(data, _KNOT, count, at)
    return np.repeat(knots["knot"], knots["multiplicity"]).astype(np.float64), at + _KNOT.itemsize * count


def _sampler(adaptor: Any, dimensions: int) -> Callable[[Array], tuple[Array, Array]]:
    """Points one by one, through the binding."""
    point, tangent = (gp_Pnt2d(), gp_Vec2d()) if dimensions == 2 else (gp_Pnt(), gp_Vec())

    def at(t: Array) -> tuple[Array, Array]:
        values = np.empty((2, len(t), dimensions))
        for i, parameter in enumerate(t.tolist()):
            adaptor.D1(parameter, point, tangent)
            if dimensions == 2:
                values[:, i] = (point.X(), point.Y()), (tangent.X(), tangent.Y())
            else:
                values[:, i] = (point.X(), point.Y(), point.Z()), (tangent.X(), tangent.Y(), tangent.Z())
        return values[0], values[1]

    return at
