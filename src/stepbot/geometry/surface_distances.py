"""Distances of points from a surface, by python-fcl."""

from typing import Any

import numpy as np

from .spatial import Array

PROBE = 1e-9
"""Radius [m] of the sphere in place of a point, by which distances are too small."""


class SurfaceDistances:
    """A surface to measure from."""

    def __init__(self, points: Array, faces: Any) -> None:
        """Build its tree.

        Args:
            points: Vertices (n, 3) [m].
            faces: Triangles (m, 3).
        """
        import fcl

        model = fcl.BVHModel()
        model.beginModel(len(points), len(faces))
        model.addSubModel(points, faces)
        model.endModel()
        self._surface = fcl.CollisionObject(model, fcl.Transform())
        self._point = fcl.Sphere(PROBE)

    def of(self, points: Array) -> Array:
        """Distances (n,) [m] of points (n, 3)."""
        import fcl

        probes = (fcl.CollisionObject(self._point, fcl.Transform(point)) for point in points)
        found = [fcl.distance(probe, self._surface, fcl.DistanceRequest(), fcl.DistanceResult()) for probe in probes]
        return np.asarray(np.maximum(found, 0.0))
