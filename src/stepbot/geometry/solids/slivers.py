"""Triangles of a hull that have no area: a vertex lies on the edge between the two others."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mesh import GRID_PER_METRE, TriMesh
from ..spatial import Array, cross

_HEIGHT = 2.0 / GRID_PER_METRE
"""Height [m] of a triangle up to which it has no area: vertices on an edge are off it by the rounding to the grid."""


def without_slivers(hull: TriMesh) -> TriMesh:
    """The same closed surface, with the same vertices, where possible without triangles that have no area.

    Such a triangle and its neighbour at its longest edge become the two triangles on the other diagonal; they stay if
    that is an edge already. A mesh without such triangles is returned as it is.
    """
    faces = hull.faces.tolist()
    flat = np.flatnonzero(_heights(hull.vertices, hull.faces) <= _HEIGHT).tolist()
    if not flat:
        return hull
    across = {(face[i], face[(i + 1) % 3]): number for number, face in enumerate(faces) for i in range(3)}
    for _ in range(4 * len(flat)):
        if not flat:
            break
        number = flat.pop(0)
        a, b, c = _from_longest(hull.vertices, faces[number])
        neighbour = across[a, c]
        d = next(vertex for vertex in faces[neighbour] if vertex not in (a, c))
        if (b, d) in across or (d, b) in across:
            continue  # the other diagonal is an edge already
        for old in (faces[number], faces[neighbour]):
            for i in range(3):
                del across[old[i], old[(i + 1) % 3]]
        faces[number], faces[neighbour] = [a, b, d], [b, c, d]
        for place in (number, neighbour):
            face = faces[place]
            across |= {(face[i], face[(i + 1) % 3]): place for i in range(3)}
            flat = [one for one in flat if one != place]
            if _heights(hull.vertices, np.array([face]))[0] <= _HEIGHT:
                flat.append(place)
    rows = [face[face.index(min(face)) :] + face[: face.index(min(face))] for face in faces]
    return TriMesh.of(hull.vertices, sorted(rows))


def _from_longest(vertices: Array, face: list[int]) -> list[int]:
    """The vertices of a face in its order, ending with that before the longest edge, which leads back to the first."""
    lengths = [float(np.linalg.norm(vertices[face[i]] - vertices[face[i - 1]])) for i in range(3)]
    first = lengths.index(max(lengths))
    return face[first:] + face[:first]


def _heights(vertices: Array, faces: NDArray[np.integer]) -> Array:
    """Heights (m,) [m] of triangles above their longest edges."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    longest = np.max([np.linalg.norm(end - start, axis=1) for start, end in ((a, b), (b, c), (c, a))], axis=0)
    area = np.linalg.norm(cross(b - a, c - a), axis=1)
    return np.asarray(area / np.where(longest > 0.0, longest, 1.0))


def face_normals(points: Array, faces: Any) -> tuple[Array, Array, Array]:
    """Unit normals (m, 3), twice the areas (m,) [m^2], and first corners (m, 3) [m] of the faces that have an area."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    has_area = areas > 0.0
    return normals[has_area] / areas[has_area, None], areas[has_area], a[has_area]
