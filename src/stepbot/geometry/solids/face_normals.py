"""Normals of the faces of a mesh that have an area."""

from typing import Any

import numpy as np

from ..spatial import Array, cross


def face_normals(points: Array, faces: Any) -> tuple[Array, Array, Array]:
    """Unit normals (m, 3), twice the areas (m,) [m^2], and first corners (m, 3) [m] of the faces that have an area."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    has_area = areas > 0.0
    return normals[has_area] / areas[has_area, None], areas[has_area], a[has_area]
