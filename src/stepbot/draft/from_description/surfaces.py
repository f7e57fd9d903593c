"""Points on faces of an assembly: meshes of one shape share its surfaces, however fine they are."""

from collections import defaultdict

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.draft.parts.scene import PlacedFace, Scene
from stepbot.geometry.fixed_point import distinct_rows
from stepbot.geometry.spatial import Array, cross
from stepbot.step.faces import FaceKind

ON_FACE = 5e-5
"""Distance [m] up to which a vertex is on a face: meshes are in single precision."""
_KNOWN = (FaceKind.PLANE, FaceKind.CYLINDER, FaceKind.SPHERE)
"""Surfaces that are fully described by a face; for others only the bounding box is known."""
_CHUNK = 64


class _Faces(Struct, frozen=True, eq=False):
    """Faces as rows of arrays."""

    planes: NDArray[np.bool_]
    cylinders: NDArray[np.bool_]
    known: NDArray[np.bool_]
    points: Array
    directions: Array
    radii: Array
    low: Array
    high: Array

    @staticmethod
    def of(placed: list[PlacedFace]) -> "_Faces":
        kinds = [face.face.kind for face in placed]
        return _Faces(
            np.array([kind is FaceKind.PLANE for kind in kinds], dtype=bool),
            np.array([kind is FaceKind.CYLINDER for kind in kinds], dtype=bool),
            np.array([kind in _KNOWN for kind in kinds], dtype=bool),
            np.array([face.point for face in placed]).reshape(-1, 3),
            np.array([face.direction for face in placed]).reshape(-1, 3),
            np.array([face.face.radius for face in placed]),
            np.array([face.low for face in placed]).reshape(-1, 3) - ON_FACE,
            np.array([face.high for face in placed]).reshape(-1, 3) + ON_FACE,
        )

    def pairs(self, points: Array) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """All pairs of a point and a face whose bounding box contains it, and whether it is on that face, if known."""
        rows, faces = [], []
        for start in range(0, len(points), _CHUNK):
            some = points[start : start + _CHUNK, None]
            row, face = np.nonzero(((some >= self.low) & (some <= self.high)).all(axis=2))
            rows.append(row + start)
            faces.append(face)
        row, face = np.concatenate(rows or [np.zeros(0, int)]), np.concatenate(faces or [np.zeros(0, int)])
        offsets = points[row] - self.points[face]
        directions = self.directions[face]
        along = np.abs(np.einsum("ij,ij->i", offsets, directions))
        across = np.linalg.norm(cross(offsets, directions), axis=1) - self.radii[face]
        about = np.linalg.norm(offsets, axis=1) - self.radii[face]
        off = np.where(self.planes[face], along, np.where(self.cylinders[face], np.abs(across), np.abs(about)))
        return row, face, self.known[face] & (off < ON_FACE)


class Surfaces:
    """The faces of an assembly, as a whole and by component."""

    def __init__(self, scene: Scene) -> None:
        by_part: dict[int, list[PlacedFace]] = defaultdict(list)
        for kind in FaceKind:
            for placed in scene.faces(kind):
                by_part[placed.part].append(placed)
        self._all = _Faces.of([placed for part in sorted(by_part) for placed in by_part[part]])
        self._of = {part: _Faces.of(placed) for part, placed in by_part.items()}

    def share(self, points: Array) -> float:
        """Share of points (n, 3) on faces, except those only in the bounding box of a spline or cone."""
        row, face, on = self._all.pairs(points)
        near, unknown = np.zeros(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
        near[row[on]] = True
        unknown[row[~on & ~self._all.known[face]]] = True
        known = near | ~unknown
        return float(near[known].mean()) if known.any() else 0.0

    def covered(self, part: int, points: Array) -> float:
        """Share of the known faces of a component with points (n, 3) on them; 0 if none is known."""
        faces = self._of.get(part)
        if faces is None or not faces.known.any() or not len(points):
            return 0.0
        _, face, on = faces.pairs(points)
        return float(np.isin(np.flatnonzero(faces.known), face[on]).mean())


TOLERANCE = 5e-5
"""Distance [m] up to which vertices are equal: meshes are in single precision, and of other tolerances."""


def spread(points: Array, most: int) -> Array:
    """At most ``most`` of points (n, 3), evenly sampled, without duplicates."""
    unique = points[np.sort(distinct_rows(np.rint(points / TOLERANCE))[0])]
    if len(unique) <= most:
        return unique
    return np.asarray(unique[np.linspace(0, len(unique) - 1, most).astype(int)])
