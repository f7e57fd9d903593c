"""How far points go about the z axis, or along it, until they meet triangles.

Only what can come out shortest is computed to the end: a caller states the longest way that matters.
"""

from collections.abc import Iterator
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, cross

TOUCHING_ANGLE, TOUCHING = 2e-3, 1e-5
"""Distances [rad] and [m] within which parts touch in the drawn pose."""
_INSIDE = 1e-9
_CHUNK = 1_000_000
_MARGIN = 1e-6
"""Distance [m] from a triangle's bounds within which a point is tried."""

Indices = NDArray[np.int64]


class Triangles:
    """Triangles with what does not depend on the points."""

    def __init__(self, corners: Array, low: Array, high: Array) -> None:
        """Store triangles.

        Args:
            corners: Shape (n, 3, 3) [m], in a frame whose z axis is that of the joint.
            low: Shape (n, 2): of each triangle the least of what the motion leaves as it is, by :func:`across` or
                :func:`reach`.
            high: Shape (n, 2): the most of it.
        """
        self.corners, self.low, self.high = corners, low, high
        self.first = corners[:, 0]
        self._u, self._v = corners[:, 1] - self.first, corners[:, 2] - self.first
        self.normals = cross(self._u, self._v)
        self.offsets = np.einsum("ij,ij->i", self.normals, self.first)
        self._sizes = np.einsum("ij,ij->i", self.normals, self.normals)

    @cached_property
    def slopes(self) -> Array:
        """Shape (n,): length of each normal across z."""
        return np.hypot(self.normals[:, 0], self.normals[:, 1])

    @cached_property
    def headings(self) -> Array:
        """Shape (n,): angle of each normal about z [rad]."""
        return np.arctan2(self.normals[:, 1], self.normals[:, 0])

    def contain(self, points: Array, j: Indices) -> NDArray[np.bool_]:
        """For points (k, 3), each in the plane of the triangle with an index (k,), whether it is in the triangle."""
        w, normals, sizes = points - self.first[j], self.normals[j], self._sizes[j]
        with np.errstate(invalid="ignore"):
            s = np.einsum("ij,ij->i", cross(w, self._v[j]), normals) / sizes
            t = np.einsum("ij,ij->i", cross(self._u[j], w), normals) / sizes
            return np.asarray((s >= -_INSIDE) & (t >= -_INSIDE) & (s + t <= 1.0 + _INSIDE))


def across(corners: Array) -> tuple[Array, Array]:
    """Bounds (n, 2) of triangles (n, 3, 3) across z."""
    return corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)


def reach(corners: Array) -> tuple[Array, Array]:
    """Bounds (n, 2) of triangles (n, 3, 3) in distance from z and in height."""
    heights, radii = corners[..., 2], np.linalg.norm(corners[..., :2], axis=2)
    # A triangle comes nearer to the axis than its corners: by no more than its longest edge.
    edges = np.linalg.norm(corners - corners[:, [2, 0, 1]], axis=2).max(axis=1)
    low = np.column_stack([radii.min(axis=1) - edges, heights.min(axis=1)])
    return low, np.column_stack([radii.max(axis=1), heights.max(axis=1)])


def slide(points: Array, triangles: Triangles, sign: float, most: float) -> float:
    """The shortest way [m] of points (n, 3) along z, or against it; infinite beyond ``most``."""
    best = most
    places = points[:, :2]
    found = False
    for i, j in _candidates(places, triangles):
        normals = triangles.normals[j]
        with np.errstate(divide="ignore", invalid="ignore"):
            height = (triangles.offsets[j] - np.einsum("ij,ij->i", places[i], normals[:, :2])) / normals[:, 2]
            way = sign * (height - points[i, 2])
            near = np.flatnonzero((way >= -TOUCHING) & (way <= best))
        at = np.column_stack([places[i[near]], height[near]])
        met = way[near][triangles.contain(at, j[near])]
        if len(met):
            best, found = float(met.min()), True
    return best if found else np.inf


def turn(points: Array, triangles: Triangles, sign: float, most: float) -> float:
    """The smallest angle [rad] of points (n, 3) about z, or against it; infinite beyond ``most``."""
    best = most
    radii, angles = np.linalg.norm(points[:, :2], axis=1), np.arctan2(points[:, 1], points[:, 0])
    found = False
    for i, j in _candidates(np.column_stack([radii, points[:, 2]]), triangles):
        with np.errstate(divide="ignore", invalid="ignore"):
            cosines = (triangles.offsets[j] - points[i, 2] * triangles.normals[j, 2]) / (radii[i] * triangles.slopes[j])
        cross_plane = np.flatnonzero(np.abs(cosines) <= 1.0)
        i, j, half = i[cross_plane], j[cross_plane], np.arccos(cosines[cross_plane])
        headings, starts = triangles.headings[j], angles[i]
        for other in (half, -half):
            at_angle = headings + other
            way = (sign * (at_angle - starts) + TOUCHING_ANGLE) % (2.0 * pi) - TOUCHING_ANGLE
            near = np.flatnonzero(way <= best)
            rows, angle = i[near], at_angle[near]
            at = np.column_stack([radii[rows] * np.cos(angle), radii[rows] * np.sin(angle), points[rows, 2]])
            met = way[near][triangles.contain(at, j[near])]
            if len(met):
                best, found = float(met.min()), True
    return best if found else np.inf


def _candidates(places: Array, triangles: Triangles) -> Iterator[tuple[Indices, Indices]]:
    """Indices of points and of triangles, in chunks: pairs where the motion can take the point into the triangle.

    ``places`` (n, 2) is of each point what the motion leaves as it is.
    """
    low, high = triangles.low - _MARGIN, triangles.high + _MARGIN
    rows = max(1, _CHUNK // len(low))
    for start in range(0, len(places), rows):
        some = places[start : start + rows, :, None]
        within = (some[:, 0] >= low[:, 0]) & (some[:, 0] <= high[:, 0])
        within &= (some[:, 1] >= low[:, 1]) & (some[:, 1] <= high[:, 1])
        i, j = np.nonzero(within)
        if len(i):
            yield i + start, j
