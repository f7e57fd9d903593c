"""Predicates of triangle meshes: watertight, convex, flat, and whether a point is inside."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .fixed_point import distinct
from .mesh import GRID_PER_METRE, TriMesh
from .spatial import Array

FLATNESS = 1e-6
"""Thickness / diagonal below which a mesh is flat."""

_ROUNDED = 4.0 / GRID_PER_METRE
"""Distance [m] by which the vertex grid displaces the vertices of a face against another vertex, at most."""
_FACES_AT_ONCE = 256


def is_watertight(faces: NDArray[np.int32]) -> bool:
    """Whether every edge of the faces (m, 3) joins exactly two of them, in opposite directions."""
    if not len(faces):
        return False
    start, end = (np.concatenate([faces[:, k] for k in order]).astype(np.int64) for order in ((0, 1, 2), (1, 2, 0)))
    span = int(faces.max()) + 1
    forward, backward = np.sort(start * span + end), np.sort(end * span + start)
    return bool((forward[1:] != forward[:-1]).all() and (forward == backward).all())


def encloses(mesh: TriMesh, point: ArrayLike) -> bool:
    """Whether a point (3,) [m] is inside a watertight mesh: by its solid angle (van Oosterom, Strackee 1983)."""
    a, b, c = (corner - np.asarray(point) for corner in _corners(mesh))
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a)))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    angle = 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum()
    return bool(abs(angle) > 2.0 * np.pi)


def is_flat(mesh: TriMesh) -> bool:
    """Whether all vertices are coplanar, or too few to span a volume."""
    if len(mesh.vertices) < 4:
        return True
    normals, areas = _normals(mesh)
    extent = mesh.diagonal
    if extent == 0.0 or not len(areas) or not areas.max():
        return True
    return float(np.ptp(mesh.vertices @ normals[int(areas.argmax())])) <= FLATNESS * extent


def is_convex(mesh: TriMesh, dent: float) -> bool:
    """Whether the mesh is the watertight surface of one convex body.

    A watertight surface with the topology of a sphere is convex where no edge is reflex. So only the faces at reflex
    edges are compared with all vertices: on a fine mesh each edge of a deep hollow is hardly reflex.

    Args:
        mesh: The mesh; faces look outwards.
        dent: Distance [m] by which vertices may lie in front of a face. Rounding to the vertex grid is allowed for.
    """
    faces = mesh.faces
    if not is_watertight(faces) or len(distinct(faces)) - len(faces) // 2 != 2:  # V - E + F, with 3 F = 2 E
        return False
    normals, areas = _normals(mesh)
    a, b, c = _corners(mesh)
    longest = np.max([np.linalg.norm(edge, axis=1) for edge in (b - a, c - b, a - c)], axis=0)
    # The thinner a triangle, the more rounding tilts its plane.
    rounding = _ROUNDED * mesh.diagonal * np.divide(longest, areas, out=np.zeros_like(areas), where=areas > 0.0)
    judge, judged = _across_edges(mesh, areas)
    in_front = np.einsum("ij,ij->i", mesh.vertices[judged] - a[judge], normals[judge])
    reflex = distinct(judge[in_front > _ROUNDED])
    for start in range(0, len(reflex), _FACES_AT_ONCE):
        some = reflex[start : start + _FACES_AT_ONCE]
        heights = (mesh.vertices @ normals[some].T).max(axis=0) - np.einsum("ij,ij->i", normals[some], a[some])
        if (heights > dent + rounding[some]).any():
            return False
    return True


def _across_edges(mesh: TriMesh, areas: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """For both directions of each edge the larger of its two faces, and the vertex of the other one opposite to it."""
    faces, n = mesh.faces, len(mesh.vertices)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    opposite = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]]).astype(np.int64)
    face = np.tile(np.arange(len(faces)), 3)
    order, partner = np.argsort(edges @ (n, 1)), np.argsort(edges @ (1, n))
    is_larger = areas[face[order]] >= areas[face[partner]]
    judge = np.where(is_larger, face[order], face[partner])
    return judge, np.where(is_larger, opposite[partner], opposite[order])


def _corners(mesh: TriMesh) -> tuple[Array, Array, Array]:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return a, b, c


def _normals(mesh: TriMesh) -> tuple[Array, Array]:
    """Unit normal (m, 3) of each face, zero for degenerate ones, and twice its area (m,) [m^2]."""
    a, b, c = _corners(mesh)
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    return normals / np.where(areas > 0.0, areas, 1.0)[:, None], areas
