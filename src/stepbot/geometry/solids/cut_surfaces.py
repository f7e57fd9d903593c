"""Points of a solid within a convex region that planes bound: enough for its hull, without Booleans.

A cut leaves the surface open. The hull of what is left, and of the corners where three planes meet inside the solid, is
the hull of the solid there: all other corners of the missing caps are where edges cross a plane.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ..spatial import Array, cross, dot, matrix_product, perpendicular_frame, rotated

ON = 1e-7
"""Distance [m] up to which a point is on a plane."""
_PARALLEL = 1e-6
"""Determinant of three normals up to which their planes have no common point."""
_OBLIQUE = np.array([0.5366, 0.3301, 0.7766])
"""Direction of rays, which few faces and edges are parallel to."""

Indices = NDArray[np.int64]
Signs = NDArray[np.int8]


class Plane(Struct, frozen=True, eq=False):
    """A plane, and which side of it is above."""

    normal: Array
    """Unit vector (3,)."""
    offset: float
    """Distance [m] from the origin along the normal."""

    @property
    def reverse(self) -> "Plane":
        """The same plane; what was below it is above."""
        return Plane(-self.normal, -self.offset)

    def heights(self, points: Array) -> Array:
        """Heights (n,) [m] of points (n, 3)."""
        return dot(points, self.normal) - self.offset


class Surface:
    """The closed surface of a solid."""

    def __init__(self, points: Array, faces: Indices) -> None:
        """Keep the points (n, 3) [m] and faces (m, 3)."""
        self.points, self.faces = points, faces

    def contains(self, point: Array) -> bool:
        """Whether a point (3,) is inside: by the faces that a ray crosses; either, for a point on the surface."""
        x, y, z = rotated(self._frame.T, point).tolist()
        (left, low, _), (right, high, top) = self._boxes
        near = np.flatnonzero((left <= x) & (x < right) & (low <= y) & (y < high) & (top > z))
        a, b, c = (matrix_product(self.points[self.faces[near, corner]] - point, self._frame) for corner in range(3))
        normals = cross(b - a, c - a)
        # The ray crosses a triangle if it passes all edges on the same side.
        turns = np.stack([u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] for u, v in ((a, b), (b, c), (c, a))])
        crossed = (turns >= 0.0).all(axis=0) | (turns < 0.0).all(axis=0)
        above = np.einsum("ij,ij->i", normals, a) * normals[:, 2] > 0.0
        return bool(np.sign(normals[crossed & above, 2]).sum() > 0.0)

    @cached_property
    def _frame(self) -> Array:
        return perpendicular_frame(_OBLIQUE)

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Lowest and highest coordinates (3, m) of faces, the third one along the ray."""
        corners = matrix_product(self.points, self._frame).T[:, self.faces.T]
        return corners.min(axis=1), corners.max(axis=1)


class CutSurface(Struct, frozen=True, eq=False):
    """The part of a surface above several planes.

    Faces that lie on a plane, or cross it by the rounding of their vertices, belong to it if the solid is above them;
    otherwise they bound a film without a volume.
    """

    whole: Surface
    points: Array
    """Shape (n, 3) [m]."""
    faces: Indices
    """Shape (m, 3), indices of points; each point has a face."""
    planes: tuple[Plane, ...] = ()

    @staticmethod
    def of(points: Array, faces: Indices) -> "CutSurface":
        """A closed surface that is not cut yet."""
        return CutSurface(Surface(points, faces), points, faces)

    def split(self, plane: Plane) -> "tuple[CutSurface, CutSurface]":
        """The parts above and below a plane."""
        heights = plane.heights(self.points)
        sides = (heights > ON).astype(np.int8) - (heights < -ON).astype(np.int8)
        of_faces = np.stack([sides[self.faces[:, corner]] for corner in range(3)])
        return (self._above(plane, heights, sides, of_faces), self._above(plane.reverse, -heights, -sides, -of_faces))

    def _above(self, plane: Plane, heights: Array, sides: Signs, of_faces: Signs) -> "CutSurface":
        points, faces = _clipped(self.points, self.faces, plane.normal, heights, sides, of_faces)
        return CutSurface(self.whole, points, faces, (*self.planes, plane))

    def corners(self) -> Array:
        """Points (n, 3) [m] of which the part of the solid has the same hull."""
        inside = [point for point, within in _region_corners(self.planes) if self.whole.contains(within)]
        return np.vstack([self.points, *inside])


def _clipped(
    points: Array, faces: Indices, normal: Array, heights: Array, sides: Signs, of_faces: Signs
) -> tuple[Array, Indices]:
    """Points and faces of the part of a surface above a plane.

    Args:
        points: Shape (n, 3) [m].
        faces: Shape (m, 3).
        normal: Of the plane.
        heights: Of the points (n,) above the plane [m].
        sides: 1 for points (n,) above the plane, 0 on it, -1 below.
        of_faces: Sides (3, m) of the corners of the faces.
    """
    above, lowest = (of_faces > 0).sum(axis=0, dtype=np.int8), of_faces.min(axis=0)
    whole = (above > 0) & (lowest >= 0)
    on = np.flatnonzero((above == 0) & (lowest == 0))
    if len(on):
        a, b, c = (points[faces[on, corner]] for corner in range(3))
        reached = np.zeros(len(points), dtype=bool)
        reached[faces[above > 0]] = True
        whole[on] = (dot(cross(b - a, c - a), normal) < 0.0) & reached[faces[on]].any(axis=1)
    # With one corner above, it comes first; with two, the third is below.
    is_one, is_two = np.flatnonzero((above == 1) & (lowest < 0)), np.flatnonzero((above == 2) & (lowest < 0))
    one = _turned(faces[is_one], of_faces[:, is_one].argmax(axis=0))
    two = _turned(faces[is_two], of_faces[:, is_two].argmin(axis=0) + 1)
    starts = np.concatenate([one[:, 0], one[:, 0], two[:, 1], two[:, 0]])
    ends = np.concatenate([one[:, 1], one[:, 2], two[:, 2], two[:, 2]])
    crosses = sides[ends] < 0
    low, high = np.minimum(starts, ends)[crosses], np.maximum(starts, ends)[crosses]
    edges, numbers = np.unique(low * len(points) + high, return_inverse=True)
    ends[crosses] = len(points) + numbers
    first, second, third, fourth = np.split(ends, np.cumsum([len(one), len(one), len(two)]))
    left = np.concatenate(
        [
            faces[whole],
            np.column_stack([one[:, 0], first, second]),
            np.column_stack([two[:, 0], two[:, 1], third]),
            np.column_stack([two[:, 0], third, fourth]),
        ]
    )
    a, b = np.divmod(edges, len(points))
    everything = np.concatenate([points, crossings(points[a], points[b], heights[a], heights[b])])
    used = np.zeros(len(everything), dtype=bool)
    used[left] = True
    return everything[used], (np.cumsum(used) - 1)[left]


def crossings(a: Array, b: Array, a_heights: Array, b_heights: Array) -> Array:
    """Where edges from points a (n, 3) to b cross a plane, by the heights (n,) [m] of their ends above it."""
    share = a_heights / (a_heights - b_heights)
    return np.asarray(a + share[:, None] * (b - a))


def _turned(faces: Indices, first: Indices) -> Indices:
    """Faces (m, 3) that begin with another corner."""
    return np.asarray(np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1))


def _region_corners(planes: Sequence[Plane]) -> Iterator[tuple[Array, Array]]:
    """Where three planes each meet, above all others: a point (3,) [m], and one a little way into the region."""
    if len(planes) < 3:
        return
    normals, offsets = np.array([plane.normal for plane in planes]), np.array([plane.offset for plane in planes])
    for three in map(list, combinations(range(len(planes)), 3)):
        (u, v, w), at = normals[three], offsets[three]
        directions = np.array([cross(v, w), cross(w, u), cross(u, v)])
        scale = float(dot(u, directions[0]))
        if abs(scale) > _PARALLEL:
            point, within = (rotated(directions.T, at + depth) / scale for depth in (0.0, 2.0 * ON))
            if (dot(normals, point) - offsets >= -ON).all():
                yield point, within
