"""Collision shapes as manifolds, in the frame of the shape; curved primitives become prisms."""

from math import pi, sin, sqrt
from typing import Any

from ..mesh import TriMesh
from ..primitives import Box, Capsule, Cylinder, Primitive, Sphere
from ..spatial import IDENTITY
from .manifolds import joined_solid

_SIDES = 256
"""Number of sides of a prism in place of a cylinder."""
_SAME_AREA = sqrt(2.0 * pi / (_SIDES * sin(2.0 * pi / _SIDES)))
"""Circumradius of the regular polygon with the area of a circle of radius 1."""


def of_same_volume(geometry: Primitive | TriMesh) -> Any:
    """A manifold of the same volume, but inscribed in a sphere or capsule; the hull of an open mesh."""
    return _manifold(geometry, _SAME_AREA)


def inscribed(geometry: Primitive | TriMesh) -> Any:
    """The same, but no part of it is outside the shape."""
    return _manifold(geometry, 1.0)


def _manifold(geometry: Primitive | TriMesh, wider: float) -> Any:
    import manifold3d

    solids = manifold3d.Manifold
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
