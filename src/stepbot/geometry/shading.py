"""Normals of triangle meshes: of their faces, and of their corners, which shade curved surfaces smooth."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from .fixed_point import distinct_rows
from .mesh import TriMesh
from .spatial import Array, cross, dot, lengths

NORMAL_DECIMALS = 6
_CREASE = math.cos(math.radians(32.0))
"""Cosine of the angle between two faces above which the edge is sharp: meshes of CAD turn by 15 degrees at most."""
_FLAT = 8.0
"""How many times larger than its neighbours a plane is whose normal a corner has: the rest are facets of a round."""
_PLANE_NORMAL, _PLANE_OFFSET = 1e-4, 1e-5
"""Within which facets are in one plane: components of their normals, and their offsets in the unit of the vertices."""
_MIX = np.array((0x1E3779B97F4A7C15, 0x3F58476D1CE4E5B9, 0x14D049BB133111EB, 0x2545F4914F6CDD1D), np.int64)
"""Odd numbers that make one key of four, with the overflow of 64 bits."""
_PAIRS_AT_ONCE = 1 << 20


def unit_normals(mesh: TriMesh) -> Array:
    """Unit normal (m, 3) of each face; z for a face without area, as of collinear vertices of a hull."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return _unit(cross(b - a, c - a))


def corner_normals(vertices: Array, faces: NDArray[np.int32]) -> Array:
    """Unit normal of each corner of each face, shape (m, 3, 3): smooth, except across edges of more than 32 degrees.

    The normal of a corner is the mean of those faces around its vertex that are within 32 degrees of its own face. The
    weights are Max's (*Weights for Computing Vertex Normals from Facet Normals*, 1999): exact for spheres, and
    independent of how a facet of a cylinder is divided into triangles. Where a plane meets a round, whose facets are
    much smaller, it is the plane's: both surfaces have that normal, and the plane is shaded evenly.

    Args:
        vertices: Shape (n, 3).
        faces: Shape (m, 3), indices of vertices.
    """
    points = vertices[faces]
    after, before = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    across = cross(after, before)
    size = dot(after, after) * dot(before, before)
    weighted = (across / np.where(size == 0.0, 1.0, size)[..., None]).reshape(-1, 3)
    flat = _unit(across[:, 0])
    total, everything = np.zeros((faces.size, 3)), np.arange(faces.size)
    around = _Corners(faces, len(vertices), flat)
    for first, last, corner, other in around.alike(everything):
        for axis in range(3):
            total[first:last, axis] = np.bincount(corner, weighted[other, axis], last - first)
    areas = _areas_in_planes(points, across[:, 0], flat)
    beside_planes = around.where_sizes_differ(areas)
    for first, last, corner, other in around.alike(beside_planes):
        which, facet = _dominated(corner, other // 3, areas, flat)
        total[beside_planes[first:last][which]] = flat[facet]
    empty = dot(total, total) == 0.0
    total[empty] = np.repeat(flat, 3, axis=0)[empty]
    return _unit(total).reshape(-1, 3, 3)


def _areas_in_planes(points: Array, across: Array, flat: Array) -> Array:
    """Twice the area (m,) of all facets in the plane of each; 0 for a facet that is alone in its plane."""
    if not len(flat):
        return np.zeros(0)
    offsets = dot(flat, points[:, 0])[:, None]
    keys = np.rint(np.hstack((flat / _PLANE_NORMAL, offsets / _PLANE_OFFSET))).astype(np.int64)
    _, plane = np.unique(keys @ _MIX, return_inverse=True)  # a quarter of the time of sorting by four columns
    together = np.bincount(plane, lengths(across))[plane]
    return np.where(np.bincount(plane)[plane] == 1, 0.0, together)


def _dominated(
    corner: NDArray[np.int64], facet: NDArray[np.int64], areas: Array, flat: Array
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corners with a plane much larger than what else is around them, and a facet of that plane for each.

    Args:
        corner: Sorted; each occurs with every facet that is smooth with its own.
        areas: Of the plane of each facet.
        flat: Normal of each facet.
    """
    begins = np.flatnonzero(np.diff(corner, prepend=-1))
    largest = np.maximum.reduceat(areas[facet], begins)
    in_largest = np.flatnonzero(areas[facet] == largest[corner])
    chosen = facet[in_largest[np.flatnonzero(np.diff(corner[in_largest], prepend=-1))]]
    apart = np.abs(flat[facet] - flat[chosen][corner]).max(axis=1) > _PLANE_NORMAL
    others = np.maximum.reduceat(np.where(apart, areas[facet], 0.0), begins)
    which = np.flatnonzero(np.logical_or.reduceat(apart, begins) & (largest > _FLAT * others))
    return which, chosen[which]


class _Corners:
    """The corners of a mesh, by their vertices."""

    def __init__(self, faces: NDArray[np.int32], vertices: int, flat: Array) -> None:
        """Sort them.

        Args:
            faces: Shape (m, 3).
            vertices: Their number.
            flat: Normal of each facet.
        """
        self._used, self._flat = faces.ravel(), flat
        self._order = np.argsort(self._used, kind="stable")
        self._count = np.bincount(self._used, minlength=vertices)
        self._first = np.cumsum(self._count) - self._count

    def alike(self, asked: NDArray[np.int64]) -> Iterator[tuple[int, int, NDArray[np.int64], NDArray[np.int64]]]:
        """The corners at the same vertex whose facets are smooth with that of a corner, some corners at a time.

        Yields a range of the corners asked for, and for each pair the number of the corner in it, and the other one.
        """
        used = self._used[asked]
        pairs = np.cumsum(self._count[used])
        start = 0
        while start < len(asked):
            done = pairs[start - 1] if start else 0
            stop = max(start + 1, int(np.searchsorted(pairs, done + _PAIRS_AT_ONCE, side="right")))
            at = used[start:stop]
            corner = np.repeat(np.arange(stop - start), self._count[at])
            place = np.arange(len(corner)) - (pairs[start:stop] - self._count[at] - done)[corner]
            other = self._order[self._first[at][corner] + place]
            alike = dot(self._flat[asked[start:stop][corner] // 3], self._flat[other // 3]) > _CREASE
            yield start, stop, corner[alike], other[alike]
            start = stop

    def where_sizes_differ(self, areas: Array) -> NDArray[np.int64]:
        """The corners at vertices where the planes of facets differ in size as a plane and the round beside it do."""
        if not len(self._order):
            return self._order
        begins = np.flatnonzero(np.diff(self._used[self._order], prepend=-1))
        around = areas[self._order // 3]
        differ = np.maximum.reduceat(around, begins) > _FLAT * np.minimum.reduceat(around, begins)
        return self._order[np.repeat(differ, np.diff(np.append(begins, len(around))))]


def shaded(mesh: TriMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The distinct normals of corners (k, 3), in millionths, and which of them each corner has (m, 3)."""
    normals = np.rint(corner_normals(mesh.vertices, mesh.faces) * 10**NORMAL_DECIMALS).astype(np.int64)
    rows = normals.reshape(-1, 3)
    first, which = distinct_rows(rows)
    return rows[first], which.reshape(-1, 3)


def _unit(vectors: Array) -> Array:
    length = lengths(vectors)
    empty = length == 0.0
    return np.where(empty[..., None], (0.0, 0.0, 1.0), vectors / np.where(empty, 1.0, length)[..., None])
