"""Bounding boxes of the geometry an engine loaded, which reveal missing, moved or scaled meshes."""

import numpy as np
from numpy.typing import ArrayLike

from stepbot.geometry.spatial import Pose, Vector3, bounds, vector3
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere

Bounds = tuple[Vector3, Vector3]


def primitive_bounds(shape: Box | Cylinder | Sphere | Capsule, X_LG: Pose) -> Bounds:
    """Lowest and highest corner [m] of a primitive in the link's frame, exact for every rotation."""
    along = np.abs(X_LG.R[:, 2])
    if isinstance(shape, Box):
        half = np.abs(X_LG.R) @ (0.5 * np.array(shape.size))
    elif isinstance(shape, Sphere):
        half = np.full(3, shape.radius)
    elif isinstance(shape, Capsule):
        half = 0.5 * shape.length * along + shape.radius
    else:
        half = 0.5 * shape.length * along + shape.radius * np.sqrt(np.clip(1.0 - along**2, 0.0, None))
    return vector3(X_LG.p - half), vector3(X_LG.p + half)


def mesh_bounds(vertices: ArrayLike, X_LG: Pose) -> Bounds:
    """Lowest and highest corner [m] of vertices (n, 3) in the link's frame."""
    return bounds(X_LG.apply(vertices))
