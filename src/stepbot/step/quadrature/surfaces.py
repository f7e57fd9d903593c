"""Surfaces as functions of arrays: points S(u, v) and the flux density S . (S_u x S_v) of the field S through them.

A patch is one surface, or many of one kind. An integral over it runs along v first, from a start to each of many points
of its boundary: the parameters u of those points are given beforehand, so that what depends on u is computed once.
Points of a section are arrays (3, n, m), n on each of m ways along v: numpy is fastest where the last axis is long.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from OCP.gp import gp_Pnt, gp_Vec

from stepbot.geometry.spatial import Array, dot

from .curves import Curve
from .splines import Indices, SplineSurface, is_rational

_NONE = np.empty(0)
_MOST_POINTS = 14
_EXACT_DEGREE = 5
"""Degree of a B-spline along v up to which that many points are exact."""


Section = Callable[[Indices, Array], tuple[Array, Array]]
"""A patch at given parameters u: points (3, n, m) and flux densities (n, m) on m ways along v.

Its arguments are ``rows`` (m,), which of the given u each is at, and ``v``, shape (n, m), or (n, 1) for the same
parameters on all; no break lies between those of one way.
"""


class Patch(Struct, frozen=True, eq=False):
    """One surface, or many of one kind."""

    section: Callable[[Array, Indices], Section]
    """The patch at parameters u (k,) of the numbered surfaces (k,)."""
    order: int
    """Gauss points that integrate along v, between two breaks, to rounding."""
    is_exact: bool
    """Whether they integrate exactly, since the integrand is a polynomial of v."""
    breaks: tuple[Array, Array] = (_NONE, _NONE)
    """Parameters u and v at which the surface is less smooth."""


class Frames(Struct, frozen=True, eq=False):
    """Origins and axes, each (n, 3)."""

    origins: Array
    x: Array
    y: Array
    z: Array

    @staticmethod
    def of(positions: Sequence[Any], origin: Array) -> "Frames":
        """From the kernel's ``gp_Ax3``, with respect to an origin."""
        rows = [
            (axis.X(), axis.Y(), axis.Z())
            for position in positions
            for axis in (position.Location(), position.XDirection(), position.YDirection(), position.Direction())
        ]
        table = np.array(rows).reshape(-1, 4, 3)
        return Frames(table[:, 0] - origin, table[:, 1], table[:, 2], table[:, 3])


def planes(frames: Frames) -> Patch:
    """Planes; S is linear in u and v."""

    def section(u: Array, faces: Indices) -> Section:
        normal = np.cross(frames.x, frames.y)
        flux = (frames.origins * normal).sum(axis=1)
        start = frames.origins[faces] + u[:, None] * frames.x[faces]
        return _straight(start.T, frames.y[faces].T, flux[faces])

    return Patch(section, order=2, is_exact=True)


def extruded(curve: Curve, origin: Array, direction: Array) -> Patch:
    """A curve moved along a line: S = C(u) + v d."""

    def section(u: Array, _faces: Indices) -> Section:
        points, tangents = curve.at(u)
        points = points - origin
        flux = (points * np.cross(tangents, direction)).sum(axis=1)
        return _straight(points.T, np.broadcast_to(direction, points.shape).T, flux)

    return Patch(section, order=2, is_exact=True, breaks=(curve.breaks, _NONE))


def _straight(start: Array, along: Array, flux: Array) -> Section:
    """A section of lines, from their starts and directions (3, k), and the flux densities (k,) on them."""

    def at(rows: Indices, v: Array) -> tuple[Array, Array]:
        points = start[:, None, rows] + v * along[:, None, rows]
        return points, np.broadcast_to(flux[rows], points.shape[1:])

    return at


def quadrics(frames: Frames, shape: Array, order: int, *, is_exact: bool) -> Patch:
    """Cylinders and cones, or spheres and tori: of radius r0 + s v + q cos v at the height c v + q sin v.

    Args:
        frames: Of the surfaces (n,).
        shape: Shape (n, 4): r0, s, q, c of each.
        order: As of :class:`Patch`, and so is ``is_exact``.
    """

    def section(u: Array, faces: Indices) -> Section:
        handed = np.sign((np.cross(frames.x, frames.y) * frames.z).sum(axis=1))[faces]
        outwards = np.cos(u)[:, None] * frames.x[faces] + np.sin(u)[:, None] * frames.y[faces]
        vectors, numbers = (frames.origins[faces].T, frames.z[faces].T, outwards.T), shape[faces].T

        def at(rows: Indices, v: Array) -> tuple[Array, Array]:
            r0, s, q, c = numbers[:, rows]
            cos, sin = q * np.cos(v), q * np.sin(v)
            radius, height = r0 + s * v + cos, c * v + sin
            origin, axis, outward = (each[:, None, rows] for each in vectors)
            point = origin + radius * outward + height * axis
            out, up = _dot(point, outward), _dot(point, axis)
            return point, handed[rows] * radius * ((c + cos) * out - (s - sin) * up)

        return at

    return Patch(section, order, is_exact)


def splined(surface: SplineSurface) -> Patch:
    """A B-spline surface."""
    degree, is_polynomial = surface.v.degree, not is_rational(surface.poles)

    def section(u: Array, _faces: Indices) -> Section:
        sections = surface.sections(u)
        return lambda rows, v: _with_flux(*surface.at(sections, rows, v))

    order = min((5 * degree + 1) // 2 + (0 if is_polynomial else 4), _MOST_POINTS)
    return Patch(section, order, is_polynomial and degree <= _EXACT_DEGREE, surface.breaks)


def revolved(curve: Curve, center: Array, axis: Array, origin: Array) -> Patch:
    """A curve turned about a line through a point: C(v), by the angle u."""

    def section(u: Array, _faces: Indices) -> Section:
        all_cos, all_sin = np.cos(u), np.sin(u)

        def at(rows: Indices, v: Array) -> tuple[Array, Array]:
            points, tangents = curve.at(v.reshape(-1))
            cos, sin = all_cos[rows], all_sin[rows]

            def turned(vectors: Array) -> Array:
                along = dot(vectors, axis)[:, None] * axis
                across, beside = vectors - along, np.cross(axis, vectors)
                fixed, a, b = (each.T.reshape(3, *v.shape) for each in (along, across, beside))
                return np.stack([fixed + cos * a + sin * b, cos * b - sin * a])

            point, by_u = turned(points - center)
            return _with_flux(point + (center - origin)[:, None, None], by_u, turned(tangents)[0])

        return at

    return Patch(section, order=10, is_exact=False, breaks=(_NONE, curve.breaks))


def sampled(adaptor: Any, origin: Array, breaks: tuple[Array, Array]) -> Patch:
    """Any surface, point by point."""

    def section(u: Array, _faces: Indices) -> Section:
        def at(rows: Indices, v: Array) -> tuple[Array, Array]:
            v = np.broadcast_to(v, (len(v), len(rows)))
            values = np.empty((9, v.size))
            point, by_u, by_v = gp_Pnt(), gp_Vec(), gp_Vec()
            us = np.broadcast_to(u[rows], v.shape)
            for i, (a, b) in enumerate(zip(us.reshape(-1).tolist(), v.reshape(-1).tolist(), strict=True)):
                adaptor.D1(a, b, point, by_u, by_v)
                values[:, i] = [c for each in (point, by_u, by_v) for c in (each.X(), each.Y(), each.Z())]
            points, along_u, along_v = values.reshape(3, 3, *v.shape)
            return _with_flux(points - origin[:, None, None], along_u, along_v)

        return at

    return Patch(section, order=10, is_exact=False, breaks=breaks)


def _with_flux(point: Array, by_u: Array, by_v: Array) -> tuple[Array, Array]:
    (x, y, z), (a, b, c), (d, e, f) = point, by_u, by_v
    return point, x * (b * f - c * e) + y * (c * d - a * f) + z * (a * e - b * d)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
