"""Triangle meshes, and their bytes as OBJ; :mod:`.mesh_bytes` has other formats.

By default meshes are written as OBJ with one object per file, in metres: the only form that PyBullet, MuJoCo and Drake
all read (Drake rejects STL for collision, MuJoCo reads one object per OBJ). Format:
http://paulbourke.net/dataformats/obj/.
"""

from math import pi

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike, NDArray

from .fixed_point import distinct_rows, fixed_point_lines
from .spatial import Array, Pose, Vector3, bounds, cross

GRID_DECIMALS = 9
GRID_PER_METRE = 10.0**GRID_DECIMALS
"""Vertices are on a grid of one nanometre: the measured mesh is the written mesh, free of the kernel's last bits."""


class TriMesh(Struct, frozen=True, eq=False, weakref=True):
    """A triangle mesh; counter-clockwise faces point outwards."""

    vertices: NDArray[np.float64]
    """Shape (n, 3) [m], read-only."""
    faces: NDArray[np.int32]
    """Shape (m, 3), indices of vertices, read-only."""

    @staticmethod
    def of(vertices: ArrayLike, faces: ArrayLike) -> "TriMesh":
        """Mesh from vertices (n, 3) [m] and faces (m, 3), anything array-like, snapped to the vertex grid.

        Raises:
            ValueError: A shape is wrong, a face refers to a vertex that does not exist, or a coordinate is not finite.
        """
        v = np.array(vertices, dtype=np.float64).reshape(-1, 3)
        f = np.array(faces, dtype=np.int32).reshape(-1, 3)
        if not np.isfinite(v).all():
            raise ValueError("a vertex is not finite")
        if len(f) and (f.min() < 0 or f.max() >= len(v)):
            raise ValueError("a face refers to a vertex that does not exist")
        v = np.rint(v * GRID_PER_METRE) / GRID_PER_METRE + 0.0  # adding zero turns -0.0 into 0.0
        v.setflags(write=False)
        f.setflags(write=False)
        return TriMesh(v, f)

    @property
    def bounds(self) -> tuple[Vector3, Vector3]:
        """Lowest and highest corner [m] of the vertices."""
        return bounds(self.vertices)

    @property
    def diagonal(self) -> float:
        """That of the bounding box [m]; 0 without vertices."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0))) if len(self.vertices) else 0.0

    @property
    def signed_volume(self) -> float:
        """Volume [m^3] of a closed mesh; negative if its faces point inwards."""
        return signed_volume(self.vertices, self.faces)

    def moved(self, X_AB: Pose) -> "TriMesh":
        """This mesh, given in B, expressed in A."""
        return TriMesh.of(X_AB.apply(self.vertices), self.faces)

    def subset(self, face_mask: NDArray[np.bool_]) -> "TriMesh":
        """The faces that ``face_mask`` (m,) selects, with the vertices that they use, in the same order."""
        faces = self.faces[face_mask]
        used, renumbered = np.unique(faces, return_inverse=True)
        return TriMesh.of(self.vertices[used], renumbered.reshape(-1, 3))


def signed_volume(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> float:
    """Volume [m^3] of a closed surface of vertices (n, 3) [m] and faces (m, 3); negative if its faces point inwards."""
    if not len(faces):
        return 0.0
    a, b, c = (vertices[faces[:, k]] - vertices.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def triangle_areas(corners: Array) -> Array:
    """Areas (m,) [m^2] of triangles (m, 3, 3) [m]."""
    a, b, c = (corners[:, k] for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(cross(b - a, c - a), axis=1))


def surface_moments(vertices: Array, faces: NDArray[np.int32]) -> tuple[float, Array, Array]:
    """Of a surface the area [m^2], the centroid (3,) [m], and the integral of x x^T (3, 3) [m^4] about the centroid.

    They do not depend on how flat faces are divided into triangles. All are 0 without area.
    """
    corners = vertices[faces]
    areas = triangle_areas(corners)
    area = float(areas.sum())
    if not area > 0.0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    centroid = (areas[:, None] * corners.mean(axis=1)).sum(axis=0) / area
    about = corners - centroid
    total = about.sum(axis=1)
    # Of a triangle with corners a, b, c: area / 12 (a a^T + b b^T + c c^T + s s^T), s = a + b + c.
    second = (np.einsum("t,tki,tkj->ij", areas, about, about) + np.einsum("t,ti,tj->ij", areas, total, total)) / 12.0
    return area, centroid, second


def merged(mesh: TriMesh) -> TriMesh:
    """The mesh with one vertex in place of equal ones, in the order of their first use: STL repeats each per face."""
    first, number = distinct_rows(mesh.vertices)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return TriMesh.of(mesh.vertices[first[order]], rank[number][mesh.faces])


def joined(meshes: list[TriMesh]) -> TriMesh:
    """One mesh of several, with concatenated vertices and faces; nothing is merged."""
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return TriMesh.of(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]),
    )


def obj_bytes(mesh: TriMesh, name: str) -> bytes:
    """Wavefront OBJ, one object called ``name``, coordinates [m] with as many decimals as read back the same.

    It has at least four vertices (:func:`with_four_vertices`).
    """
    mesh = with_four_vertices(mesh)
    nanometres = np.rint(mesh.vertices * GRID_PER_METRE).astype(np.int64)
    vertices = fixed_point_lines("v", nanometres, GRID_DECIMALS)
    return f"o {name}\n".encode() + vertices + fixed_point_lines("f", mesh.faces.astype(np.int64) + 1)


def with_four_vertices(mesh: TriMesh) -> TriMesh:
    """The mesh; of fewer than four vertices, with its first face split around its centre, an additional vertex.

    MuJoCo requires at least four.
    """
    if not 0 < len(mesh.vertices) < 4 or not len(mesh.faces):
        return mesh
    a, b, c = mesh.faces[0].tolist()
    middle = len(mesh.vertices)
    vertices = np.vstack([mesh.vertices, mesh.vertices[[a, b, c]].mean(axis=0)])
    return TriMesh.of(vertices, [[a, b, middle], [b, c, middle], [c, a, middle], *mesh.faces[1:].tolist()])


AROUND = 64
"""Number of vertices around an axis."""


def revolved(profile: Array, around: int = AROUND) -> TriMesh:
    """The surface of a profile, radius and z from the lowest to the highest point of the axis, shape (n, 2) [m]."""
    rings = profile[1:-1]
    angles = 2.0 * pi * np.arange(around) / around
    circle = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    sides = [np.column_stack((radius * circle, np.full(around, z))) for radius, z in rings]
    vertices = np.concatenate((*sides, [(0.0, 0.0, profile[0, 1]), (0.0, 0.0, profile[-1, 1])]))
    bottom, top, last = len(rings) * around, len(rings) * around + 1, (len(rings) - 1) * around
    faces = []
    for i in range(around):
        j = (i + 1) % around
        faces += [(bottom, j, i), (top, last + i, last + j)]
        for start in range(0, last, around):
            a, b, c, d = start + i, start + j, start + around + j, start + around + i
            faces += [(a, b, c), (a, c, d)]
    return TriMesh.of(vertices, faces)
