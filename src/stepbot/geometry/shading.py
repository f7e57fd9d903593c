"""Normals of triangle meshes: of their faces, and of their corners, which shade curved surfaces smooth."""

import math

import numpy as np
from numpy.typing import NDArray

from .fixed_point import distinct_rows
from .mesh import TriMesh
from .spatial import Array, cross, dot, lengths

NORMAL_DECIMALS = 6
_CREASE = math.cos(math.radians(32.0))
"""Cosine of the angle between two faces above which the edge is sharp: meshes of CAD turn by 15 degrees at most."""
_PAIRS_AT_ONCE = 1 << 20


def unit_normals(mesh: TriMesh) -> Array:
    """Unit normal (m, 3) of each face; z for a face without area, as of collinear vertices of a hull."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return _unit(cross(b - a, c - a))


def corner_normals(vertices: Array, faces: NDArray[np.int32]) -> Array:
    """Unit normal of each corner of each face, shape (m, 3, 3): smooth, except across edges of more than 32 degrees.

    The normal of a corner is the mean of those faces around its vertex that are within 32 degrees of its own face. The
    weights are Max's (*Weights for Computing Vertex Normals from Facet Normals*, 1999): exact for spheres, and
    independent of how a facet of a cylinder is divided into triangles.

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
    used = faces.ravel()
    order = np.argsort(used, kind="stable")
    count = np.bincount(used, minlength=len(vertices))
    first = np.cumsum(count) - count
    total = np.zeros((len(used), 3))
    pairs = np.cumsum(count[used])
    start = 0
    while start < len(used):
        done = pairs[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(pairs, done + _PAIRS_AT_ONCE, side="right")))
        corner = np.repeat(np.arange(start, stop), count[used[start:stop]])
        place = np.arange(len(corner)) - (pairs[corner] - count[used[corner]] - done)
        other = order[first[used[corner]] + place]
        alike = dot(flat[corner // 3], flat[other // 3]) > _CREASE
        corner, other = corner[alike] - start, other[alike]
        for axis in range(3):
            total[start:stop, axis] = np.bincount(corner, weighted[other, axis], stop - start)
        start = stop
    empty = dot(total, total) == 0.0
    total[empty] = np.repeat(flat, 3, axis=0)[empty]
    return _unit(total).reshape(-1, 3, 3)


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
