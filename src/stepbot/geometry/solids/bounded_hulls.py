"""Convex polyhedra with few vertices that enclose a convex hull.

The polyhedron is an intersection of half spaces: the bounding box of the hull, then, one after the other, the plane of
the hull's face that the farthest vertex of the polyhedron is most in front of. Every plane supports the hull, so the
polyhedron encloses it.
"""

import numpy as np

from ..fixed_point import distinct_rows
from ..mesh import GRID_PER_METRE, TriMesh
from ..spatial import Array, cross, dot, matrix_product
from .manifolds import convex_hull, hull_faces
from .slivers import face_normals

FEWEST = 8
"""Minimum number of vertices: those of a box."""
_TOUCHING = 1.0 / GRID_PER_METRE
"""Distance [m] up to which a vertex counts as on the hull."""


def bounded_hull(hull: TriMesh, max_vertices: int) -> TriMesh:
    """A convex mesh of at most ``max_vertices`` vertices that encloses a convex mesh, up to the vertex grid.

    Args:
        hull: A convex mesh; returned as it is if it is small enough.
        max_vertices: At least :data:`FEWEST`.
    """
    if len(hull.vertices) <= max_vertices:
        return hull
    center = hull.vertices.mean(axis=0)  # inside, which the middle of the bounding box need not be
    made = convex_hull(_outline(hull, center, max_vertices) + center)
    assert made is not None  # it encloses a hull, which is not flat
    return made


def _outline(hull: TriMesh, center: Array, max_vertices: int) -> Array:
    """Vertices (n, 3) [m] of the polyhedron, relative to ``center``."""
    points = hull.vertices - center
    normals, offsets = _planes(points, hull)
    chosen = np.vstack([np.eye(3), -np.eye(3)])
    distances = matrix_product(points, chosen.T).max(axis=0)
    best = _corners(chosen, distances)
    while True:
        depths = matrix_product(best, normals.T) - offsets
        vertex = int(depths.max(axis=1).argmax())
        plane = int(depths[vertex].argmax())
        if depths[vertex, plane] <= _TOUCHING:
            return best
        chosen = np.vstack([chosen, normals[plane]])
        # A thin face is tilted by the rounding of its corners: move its plane out to the outermost vertex.
        distances = np.append(distances, dot(points, normals[plane]).max())
        offsets[plane] = np.inf
        refined = _corners(chosen, distances)
        if len(refined) > max_vertices:
            return best
        best = refined


def _planes(points: Array, hull: TriMesh) -> tuple[Array, Array]:
    """Unit normals (m, 3) of faces and their distances (m,) [m] from the origin."""
    normals, _, a = face_normals(points, hull.faces)
    return normals, np.einsum("ij,ij->i", normals, a)


def _corners(normals: Array, distances: Array) -> Array:
    """Vertices (n, 3) [m] of an intersection of half spaces around the origin.

    They are the faces of the dual polyhedron, which has a vertex for each plane: its normal divided by its distance.
    """
    dual = np.ascontiguousarray(normals / distances[:, None])
    corners = dual[hull_faces(dual)]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    across = cross(b - a, c - a)
    scale = np.einsum("ij,ij->i", across, a)
    found = across[scale > 0.0] / scale[scale > 0.0, None]
    # A face of the dual with more than three corners was triangulated: all its triangles give the same vertex.
    rounded = (found * GRID_PER_METRE).round() / GRID_PER_METRE + 0.0
    return np.asarray(rounded[distinct_rows(rounded)[0]])
