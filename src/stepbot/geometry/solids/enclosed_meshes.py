"""Meshes beside solids that the collision shapes of these solids enclose: they need no shape of their own."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..spatial import Array
from .manifolds import convex_hull
from .shape_manifolds import inscribed
from .unions import PlacedShape, PlacedSolid

WITHIN = 1e-7
"""Distance [m] up to which a mesh may protrude from the shapes that enclose it."""


def enclosed_meshes(meshes: Sequence[PlacedSolid], shapes: Sequence[PlacedShape]) -> tuple[int, ...]:
    """Indices of the meshes whose convex hulls the shapes enclose together, to :data:`WITHIN`.

    Args:
        meshes: Open or closed; one that is too flat for a hull does not count as enclosed.
        shapes: Convex shapes in the same frame.
    """
    import manifold3d

    if not meshes or not shapes:
        return ()
    placed = [inscribed(shape.geometry).transform(shape.X_AG.matrix[:3]) for shape in shapes]
    union = manifold3d.Manifold.batch_boolean(placed, manifold3d.OpType.Add)
    return tuple(i for i, one in enumerate(meshes) if _is_inside(one, union))


def _is_inside(one: PlacedSolid, union: Any) -> bool:
    import manifold3d

    hull = convex_hull(one.mesh.vertices)
    if hull is None:
        return False
    shrunk = manifold3d.Manifold.hull_points(np.ascontiguousarray(one.X_AC.apply(_shrunk(hull.vertices))))
    return bool((shrunk - union).is_empty())


def _shrunk(points: Array) -> Array:
    """The points (n, 3) [m], moved towards their centre, none by more than :data:`WITHIN`: flush faces come apart."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    size = float(np.linalg.norm(points - center, axis=1).max())
    return np.asarray(center + (1.0 - WITHIN / size) * (points - center))
