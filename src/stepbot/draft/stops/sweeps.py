"""How far points go about the z axis, or along it, until they meet triangles.

Only what can come out shortest is computed to the end: a caller states the longest way that matters.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from math import pi

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.draft.parts.scene import chunks, expanded, starts_of
from stepbot.geometry.spatial import Array, cross, dot

TOUCHING_ANGLE, TOUCHING = 2e-3, 1e-5
"""Distances [rad] and [m] within which parts touch in the drawn pose."""
_INSIDE = 1e-9
_CHUNK = 1_000_000
MARGIN = 1e-6
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
        self.low, self.high = low, high
        self.first = corners[:, 0]
        self._u, self._v = corners[:, 1] - self.first, corners[:, 2] - self.first
        self.normals = cross(self._u, self._v)
        self.offsets = np.einsum("ij,ij->i", self.normals, self.first)

    @cached_property
    def slopes(self) -> Array:
        """Shape (n,): length of each normal across z."""
        return np.hypot(self.normals[:, 0], self.normals[:, 1])

    @cached_property
    def headings(self) -> Array:
        """Shape (n,): angle of each normal about z [rad]."""
        return np.arctan2(self.normals[:, 1], self.normals[:, 0])

    @cached_property
    def _shares(self) -> tuple[Array, Array]:
        """Vectors (3, n), whose products with the way from the first corner are the shares of both edges from there."""
        sizes = dot(self.normals, self.normals)[:, None]
        with np.errstate(invalid="ignore"):
            along_u, along_v = cross(self._v, self.normals) / sizes, cross(self.normals, self._u) / sizes
        return np.ascontiguousarray(along_u.T), np.ascontiguousarray(along_v.T)

    def contain(self, points: Array, j: Indices) -> NDArray[np.bool_]:
        """For points (3, k), each in the plane of the triangle with an index (k,), whether it is in the triangle."""
        w, along_u, along_v = points - self._first_by_axis[:, j], *(shares[:, j] for shares in self._shares)
        s = w[0] * along_u[0] + w[1] * along_u[1] + w[2] * along_u[2]
        t = w[0] * along_v[0] + w[1] * along_v[1] + w[2] * along_v[2]
        return np.asarray((s >= -_INSIDE) & (t >= -_INSIDE) & (s + t <= 1.0 + _INSIDE))

    @cached_property
    def _first_by_axis(self) -> Array:
        """Shape (3, n)."""
        return np.ascontiguousarray(self.first.T)


def across(corners: Array) -> tuple[Array, Array]:
    """Bounds (n, 2) of triangles (n, 3, 3) across z."""
    x, y, _ = np.ascontiguousarray(corners.T)
    return np.column_stack([x.min(axis=0), y.min(axis=0)]), np.column_stack([x.max(axis=0), y.max(axis=0)])


def reach(corners: Array) -> tuple[Array, Array]:
    """Bounds (n, 2) of triangles (n, 3, 3) in distance from z and in height."""
    x, y, heights = by_axis = np.ascontiguousarray(corners.T)
    radii = np.sqrt(x * x + y * y)
    # A triangle comes nearer to the axis than its corners: by no more than its longest edge.
    dx, dy, dz = by_axis - by_axis[:, [2, 0, 1]]
    edges = np.sqrt((dx * dx + dy * dy + dz * dz).max(axis=0))
    low = np.column_stack([radii.min(axis=0) - edges, heights.min(axis=0)])
    return low, np.column_stack([radii.max(axis=0), heights.max(axis=0)])


def slide(points: Array, triangles: Triangles, sign: float, most: float) -> float:
    """The shortest way [m] of points (n, 3) along z, or against it; infinite beyond ``most``."""
    return _shortest(ways_along, points[:, :2], points, triangles, sign, most)


def turn(points: Array, triangles: Triangles, sign: float, most: float) -> float:
    """The smallest angle [rad] of points (n, 3) about z, or against it; infinite beyond ``most``."""
    return _shortest(ways_about, radii_and_heights(points), points, triangles, sign, most)


def ways_along(points: Array, triangles: Triangles, i: Indices, j: Indices, sign: float, most: float = np.inf) -> Array:
    """The way [m] of each point of index ``i`` (k,) along z to the triangle of index ``j`` (k,), or against it.

    Shape (k,), infinite where they do not meet, or beyond ``most``.
    """
    normals, start = triangles.normals[j], points[i]
    with np.errstate(divide="ignore", invalid="ignore"):
        height = (triangles.offsets[j] - np.einsum("ij,ij->i", start[:, :2], normals[:, :2])) / normals[:, 2]
        way = sign * (height - start[:, 2])
        near = np.flatnonzero((way >= -TOUCHING) & (way <= most))
    at = np.array([start[near, 0], start[near, 1], height[near]])
    met = near[triangles.contain(at, j[near])]
    ways = np.full(len(i), np.inf)
    ways[met] = way[met]
    return ways


def ways_about(points: Array, triangles: Triangles, i: Indices, j: Indices, sign: float, most: float = np.inf) -> Array:
    """The angle [rad] of each point of index ``i`` (k,) about z to the triangle of index ``j`` (k,), or against it.

    Shape (k,), infinite where they do not meet, or beyond ``most``.
    """
    radii, heights = np.linalg.norm(points[:, :2], axis=1)[i], points[i, 2]
    ways = np.full(len(i), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        cosines = (triangles.offsets[j] - heights * triangles.normals[j, 2]) / (radii * triangles.slopes[j])
    cross_plane = np.flatnonzero(np.abs(cosines) <= 1.0)
    j, radii, heights, half = j[cross_plane], radii[cross_plane], heights[cross_plane], np.arccos(cosines[cross_plane])
    headings, starts = triangles.headings[j], np.arctan2(points[:, 1], points[:, 0])[i[cross_plane]]
    for other in (half, -half):
        at_angle = headings + other
        way = (sign * (at_angle - starts) + TOUCHING_ANGLE) % (2.0 * pi) - TOUCHING_ANGLE
        near = np.flatnonzero(way <= most)
        angle, reached = at_angle[near], radii[near]
        at = np.array([reached * np.cos(angle), reached * np.sin(angle), heights[near]])
        met = near[triangles.contain(at, j[near])]
        ways[cross_plane[met]] = np.minimum(ways[cross_plane[met]], way[met])
    return ways


def radii_and_heights(points: Array) -> Array:
    """Shape (n, 2): what a turn leaves as it is."""
    return np.column_stack([np.linalg.norm(points[:, :2], axis=1), points[:, 2]])


def touched(places: Array, triangles: Triangles, i: Indices, j: Indices) -> NDArray[np.bool_]:
    """For points and triangles, by index (k,) each, whether the motion can take the point into the triangle."""
    low, high = triangles.low - MARGIN, triangles.high + MARGIN
    within = (places[i, 0] >= low[j, 0]) & (places[i, 0] <= high[j, 0])
    within &= (places[i, 1] >= low[j, 1]) & (places[i, 1] <= high[j, 1])
    return np.asarray(within)


def _shortest(
    ways: Callable[..., Array], places: Array, points: Array, triangles: Triangles, sign: float, most: float
) -> float:
    best, touched = most, False
    for i, j in _candidates(places, triangles):
        way = float(ways(points, triangles, i, j, sign, best).min())
        if way <= best:
            best, touched = way, way < np.inf
    return best if touched else np.inf


def _candidates(places: Array, triangles: Triangles) -> Iterator[tuple[Indices, Indices]]:
    """Indices of points and of triangles, in chunks: pairs where the motion can take the point into the triangle.

    ``places`` (n, 2) is of each point what the motion leaves as it is.
    """
    low, high = triangles.low - MARGIN, triangles.high + MARGIN
    rows = max(1, _CHUNK // len(low))
    for start in range(0, len(places), rows):
        some = places[start : start + rows, :, None]
        within = (some[:, 0] >= low[:, 0]) & (some[:, 0] <= high[:, 0])
        within &= (some[:, 1] >= low[:, 1]) & (some[:, 1] <= high[:, 1])
        i, j = np.nonzero(within)
        if len(i):
            yield i + start, j


_ALONG = 0.3
"""Cosine of the angle between normal and motion from which a face can stop it."""


class PlacedMeshes:
    """The meshes of the parts of a link."""

    def __init__(
        self, parts: Sequence[int], vertices: Sequence[Array], faces: Sequence[NDArray[np.int32]], *, slides: bool
    ) -> None:
        """Store meshes.

        Args:
            parts: A number for each part.
            vertices: Of each part (n, 3) [m], at least one.
            faces: Of each part (m, 3).
        """
        self._parts, self._vertices, self._faces, self._slides = parts, vertices, faces, slides

    @cached_property
    def bounds(self) -> Array:
        """Shape (k, 2, 2): bounds around those of all triangles of each part."""
        points = np.concatenate([np.zeros((0, 3)), *self._vertices])
        starts = starts_of([len(vertices) for vertices in self._vertices])
        low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
        if self._slides:
            return np.stack([low[:, :2], high[:, :2]], axis=1)
        radii = np.linalg.norm(points[:, :2], axis=1)
        nearest = np.minimum.reduceat(radii, starts) - np.linalg.norm(high - low, axis=1)
        least, most = [nearest, low[:, 2]], [np.maximum.reduceat(radii, starts), high[:, 2]]
        return np.stack([np.stack(least, axis=1), np.stack(most, axis=1)], axis=1)

    def within_reach(self, others: "PlacedMeshes") -> "PlacedMeshes":
        """The parts that can meet one of the others, by their bounds."""
        if not self._parts or not others._parts:
            return PlacedMeshes([], [], [], slides=self._slides)
        a, b = self.bounds[:, None], others.bounds[None]
        apart = (a[:, :, 0] >= b[:, :, 1]) | (b[:, :, 0] >= a[:, :, 1])
        kept = np.flatnonzero(~(apart[:, :, 0] | apart[:, :, 1]).all(axis=1)).tolist()
        parts, vertices = [self._parts[k] for k in kept], [self._vertices[k] for k in kept]
        return PlacedMeshes(parts, vertices, [self._faces[k] for k in kept], slides=self._slides)

    def facing(self, sign: float) -> "Sides":
        """The triangles whose outside looks along the motion, or against it for a negative sign."""
        along, least = self._directions
        rows = np.flatnonzero((least > 0.0) & (sign * along > _ALONG * least))
        counts = np.bincount(self._owners[rows], minlength=len(self._parts))
        shown = np.flatnonzero(counts)
        parts = tuple(self._parts[k] for k in shown.tolist())
        corners = self._corners[rows]
        return Sides(parts, starts_of(counts[shown]), corners, *(across(corners) if self._slides else reach(corners)))

    @cached_property
    def _owners(self) -> Indices:
        """The part of each triangle."""
        return np.repeat(np.arange(len(self._parts)), [len(faces) for faces in self._faces])

    @cached_property
    def _corners(self) -> Array:
        """Shape (n, 3, 3), of all triangles."""
        pairs = zip(self._vertices, self._faces, strict=True)
        return np.concatenate([np.zeros((0, 3, 3)), *(vertices[faces] for vertices, faces in pairs)])

    @cached_property
    def _directions(self) -> tuple[Array, Array]:
        """Of all triangles the products of normal and motion, and the product of their lengths."""
        (x, x1, x2), (y, y1, y2), (z, z1, z2) = np.ascontiguousarray(self._corners.T)
        ux, uy, uz, vx, vy, vz = x1 - x, y1 - y, z1 - z, x2 - x, y2 - y, z2 - z
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        lengths = np.sqrt(nx * nx + ny * ny + nz * nz)
        if self._slides:
            return nz, lengths
        motion_x, motion_y = -(y + y1 + y2) / 3.0, (x + x1 + x2) / 3.0
        return nx * motion_x + ny * motion_y, lengths * np.sqrt(motion_x * motion_x + motion_y * motion_y)


class Sides(Struct, frozen=True, eq=False, dict=True):
    """Triangles of parts that look one way."""

    parts: tuple[int, ...]
    """The k parts that have any."""
    starts: Indices
    """Shape (k,): the first triangle of each part."""
    corners: Array
    """Shape (n, 3, 3) [m]."""
    low: Array
    """Shape (n, 2): of each triangle the least of what the motion leaves as it is."""
    high: Array
    """Shape (n, 2), likewise the most."""

    @cached_property
    def bounds(self) -> Array:
        """Shape (k, 2, 2): the least and the most of the triangles of each part."""
        least, most = np.minimum.reduceat(self.low, self.starts), np.maximum.reduceat(self.high, self.starts)
        return np.stack([least, most], axis=1)

    def triangles(self, rows: Indices) -> Triangles:
        """Some of the triangles."""
        return Triangles(self.corners[rows], self.low[rows], self.high[rows])

    def counts_near(self, others: "Sides") -> Indices:
        """Shape (m, k): for each of the other parts, how many triangles of each of these can meet some of its."""
        counts = np.zeros((len(others.parts), len(self.parts)), dtype=np.int64)
        rows = max(1, _CHUNK // max(1, len(self.low)))
        for start in range(0, len(counts) if len(self.low) else 0, rows):
            near = _within(self.low, self.high, others.bounds[start : start + rows, :, :, None])
            counts[start : start + rows] = np.add.reduceat(near, self.starts, axis=1, dtype=np.int64)
        return counts

    def near(self, rows: Indices, others: "Sides", other_rows: Indices) -> tuple[Indices, Indices]:
        """For p pairs of parts, by their rows (p,) here and there, the triangles here that can meet some of the other.

        Returns:
            Numbers of pairs, ascending, and of triangles, each (q,).
        """
        sizes = np.diff(np.append(self.starts, len(self.low)))[rows]
        hits = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))]
        # Parts with many triangles are in many pairs: not all of them at once.
        for some in chunks(sizes):
            runs, offsets = expanded(sizes[some])
            pairs = some[runs]
            triangles = self.starts[rows[pairs]] + offsets
            bounds = np.moveaxis(others.bounds[other_rows[pairs]], 0, -1)
            near = _within(self.low[triangles], self.high[triangles], bounds)
            hits.append((pairs[near], triangles[near]))
        return np.concatenate([pairs for pairs, _ in hits]), np.concatenate([triangles for _, triangles in hits])


def meeting(
    still: Sides, moving: Sides, near_still: tuple[Indices, Indices], near_moving: tuple[Indices, Indices]
) -> tuple[Indices, Indices, Indices]:
    """Pairs of triangles whose bounds overlap, of pairs of parts.

    Args:
        still: Triangles of one link.
        moving: Triangles of the other.
        near_still: Numbers of pairs of parts, ascending, and of triangles of one link, by :meth:`Sides.near`.
        near_moving: The same of the other link.

    Returns:
        Numbers of pairs of parts, of triangles of one link, and of the other, each (q,).
    """
    pairs_still, triangles = near_still
    pairs_moving, others = near_moving
    begins, ends = (np.searchsorted(pairs_still, pairs_moving, side=side) for side in ("left", "right"))
    rows, offsets = expanded(ends - begins)
    i, j = triangles[begins[rows] + offsets], others[rows]
    low, high = still.low[i] - 2.0 * MARGIN, still.high[i] + 2.0 * MARGIN
    others_low, others_high = moving.low[j], moving.high[j]
    meet = (low[:, 0] <= others_high[:, 0]) & (others_low[:, 0] <= high[:, 0])
    meet &= (low[:, 1] <= others_high[:, 1]) & (others_low[:, 1] <= high[:, 1])
    return pairs_moving[rows][meet], i[meet], j[meet]


def _within(low: Array, high: Array, bounds: Array) -> NDArray[np.bool_]:
    """Which triangles overlap bounds (..., 2, 2, n or 1)."""
    near = (low[:, 0] < bounds[..., 1, 0, :]) & (bounds[..., 0, 0, :] < high[:, 0])
    near &= low[:, 1] < bounds[..., 1, 1, :]
    near &= bounds[..., 0, 1, :] < high[:, 1]
    return np.asarray(near)
