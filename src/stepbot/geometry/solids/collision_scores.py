"""How well collision shapes match the solids of a link: intersection over union, and overshoot.

The intersection over union is by volume. Curved primitives are prisms of the same volume; where one primitive is the
only shape, the volume between mesh and exact solid counts too, so that a cylinder on a cylinder is 1. Closed voids of
the solids count as filled.

The overshoot is the largest distance of a point of the shapes from the solids. A distance changes by no more than the
point moves, so a triangle can be left out, or has to be divided, by the distance of its centre and its radius.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sin, sqrt
from typing import Any

import numpy as np

from ..mesh import TriMesh
from ..primitives import Box, Capsule, Cylinder, Primitive, Sphere
from ..spatial import IDENTITY, Array, Pose
from ..surface_distances import SurfaceDistances
from .collision_sets import PlacedSolid
from .manifolds import joined_solid, mesh_arrays
from .unions import union

MAX_FACES = 1_000_000
"""Maximum number of faces of a link that is scored."""
_SIDES = 256
"""Number of sides of a prism in place of a cylinder."""
_ACCURACY = 4e-3
"""Accuracy of the overshoot, as a share of the diagonal of the solids."""
_MOST_POINTS = 4_000
"""Maximum number of distances for one overshoot."""
_DECIMALS = 6


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """A shape in the frame A of the solids; of an open mesh, its convex hull counts."""

    geometry: Primitive | TriMesh
    X_AG: Pose


@dataclass(frozen=True, eq=False)
class Unscored:
    """Solids and their collision shapes, all in A."""

    solids: tuple[PlacedSolid, ...]
    missing: float
    """Exact volume [m^3] of the solids, minus that of their meshes."""
    shapes: tuple[PlacedShape, ...]


@dataclass(frozen=True)
class CollisionScore:
    """Both are None without closed solids or without shapes, or for a link of too many faces."""

    iou: float | None = None
    """Volume of the intersection / volume of the union, to six decimals."""
    overshoot: float | None = None
    """[m], to the nearest micrometre."""


def collision_scores(unscored: Sequence[Unscored]) -> tuple[CollisionScore, ...]:
    """The score of each."""
    return tuple(map(_score, unscored))


def _score(one: Unscored) -> CollisionScore:
    import manifold3d

    meshes = [solid.mesh for solid in one.solids]
    meshes += [shape.geometry for shape in one.shapes if isinstance(shape.geometry, TriMesh)]
    if not one.shapes or sum(len(mesh.faces) for mesh in meshes) > MAX_FACES:
        return CollisionScore()
    solid, _ = union([(placed.mesh, placed.X_AC) for placed in one.solids])
    if solid is None:
        return CollisionScore()
    parts = [_manifold(shape.geometry).transform(shape.X_AG.matrix[:3]) for shape in one.shapes]
    shapes = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    outside = shapes - solid
    is_exact = len(one.shapes) == 1 and not isinstance(one.shapes[0].geometry, TriMesh)
    both = shapes.volume() - outside.volume() + (one.missing if is_exact else 0.0)
    iou = both / (solid.volume() + outside.volume())
    return CollisionScore(round(min(float(iou), 1.0), _DECIMALS), round(_overshoot(solid, outside), _DECIMALS))


def _manifold(geometry: Primitive | TriMesh) -> Any:
    """A manifold of the same volume, in the frame of the shape."""
    import manifold3d

    solids = manifold3d.Manifold
    # The regular n-gon with the area of a circle of radius 1 has this circumradius.
    wider = sqrt(2.0 * pi / (_SIDES * sin(2.0 * pi / _SIDES)))
    if isinstance(geometry, TriMesh):
        solid, _ = joined_solid([(geometry, IDENTITY)])
        return solids.hull_points(geometry.vertices.copy()) if solid is None else solid
    if isinstance(geometry, Box):
        return solids.cube(geometry.size, True)
    if isinstance(geometry, Cylinder):
        return solids.cylinder(geometry.length, wider * geometry.radius, wider * geometry.radius, _SIDES, True)
    if isinstance(geometry, Sphere):
        return solids.sphere(geometry.radius, _SIDES)
    assert isinstance(geometry, Capsule)
    ends = [solids.sphere(geometry.radius, _SIDES).translate((0, 0, z)) for z in _half(geometry.length)]
    return solids.batch_hull(ends)


def _half(length: float) -> tuple[float, float]:
    return -0.5 * length, 0.5 * length


def _overshoot(solid: Any, outside: Any) -> float:
    """The largest distance [m] of a point of what is outside the solid from it."""
    points, faces = mesh_arrays(solid)
    accuracy = _ACCURACY * float(np.linalg.norm(np.ptp(points, axis=0)))
    outside = outside.simplify(0.25 * accuracy)
    if outside.is_empty():
        return 0.0
    distances = SurfaceDistances(points, faces)
    corners, sides = mesh_arrays(outside)
    # Most often it is a corner, which centres of ever smaller triangles approach slowly.
    triangles, count = corners[sides], min(len(corners), _MOST_POINTS)
    farthest = float(distances.of(corners[:count]).max())
    while len(triangles) and count < _MOST_POINTS:
        centers = triangles.mean(axis=1)
        reach = np.linalg.norm(triangles - centers[:, None], axis=2).max(axis=1)
        away = distances.of(centers)
        count += len(centers)
        farthest = max(farthest, float(away.max()))
        triangles = _quartered(triangles[away + reach > farthest + accuracy])
    return farthest


def _quartered(triangles: Array) -> Array:
    """Four triangles (4 n, 3, 3) in place of each (n, 3, 3)."""
    a, b, c = (triangles[:, corner] for corner in range(3))
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    parts = [np.stack(part, axis=1) for part in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.concatenate(parts)
