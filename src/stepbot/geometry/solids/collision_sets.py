"""Collision geometry of solids that belong together: one primitive, one hull, or convex pieces.

The solids are joined to one, so screws in their holes, parts inside a housing and seams between parts get no shapes of
their own, and voids that nothing can enter are filled. The shapes together enclose all of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..mesh import TriMesh
from ..primitives import Box, Capsule, Cylinder, Sphere
from ..spatial import IDENTITY, Array, Pose
from ..sums import exact_sum
from .bounded_hulls import bounded_hull
from .convex_pieces import Bore, convex_pieces, main_axes
from .manifolds import convex_hull, hull_volume, mesh_arrays
from .primitive_fits import Shaft, fitted_primitive
from .unions import union

MAX_HULLS, MAX_VERTICES = 16, 64
"""Default budgets; PhysX and MJX take at most 64 vertices a hull."""
FEW, CLOSE = 0.9, 0.95
"""Share of the total volume of its shapes that a solid has to fill: for few shapes, and for close ones."""


@dataclass(frozen=True, eq=False)
class PlacedSolid:
    """A closed mesh, given in C, in the common frame A."""

    mesh: TriMesh
    X_AC: Pose


@dataclass(frozen=True, eq=False)
class Wanted:
    """Solids that get one set of shapes, all in A."""

    solids: tuple[PlacedSolid, ...]
    missing: float
    """Exact volume [m^3] of the solids, minus that of their meshes."""
    shafts: tuple[Shaft, ...]
    bores: tuple[Bore, ...]
    primitives: bool
    """Whether a primitive may stand for the solids or for a piece; otherwise all shapes are hulls."""
    filled: float
    """Share of the total volume of the pieces' hulls that the solids have to fill."""
    max_hulls: int
    max_vertices: int


@dataclass(frozen=True, eq=False)
class FittedShape:
    """One shape of a set."""

    geometry: Box | Cylinder | Sphere | Capsule | TriMesh
    X_AG: Pose


@dataclass(frozen=True, eq=False)
class CollisionSet:
    """Shapes that together enclose solids."""

    shapes: tuple[FittedShape, ...]
    filled: float = 1.0
    """Share of the total volume of the convex pieces that the solids fill, before hulls get fewer vertices."""
    left_out: tuple[int, ...] = ()
    """Solids whose meshes bound no volume, and which the shapes do not enclose."""


def collision_sets(all_wanted: Sequence[Wanted]) -> tuple[CollisionSet, ...]:
    """The shapes of each; the same for the same input, whatever the number of threads."""
    return tuple(_collision_set(wanted) for wanted in all_wanted)


def _collision_set(wanted: Wanted) -> CollisionSet:
    solid, left_out = union([(one.mesh, one.X_AC) for one in wanted.solids])
    if solid is None:
        return CollisionSet((), left_out=left_out)
    points, faces = mesh_arrays(solid)
    axes = _axes(points, faces)
    volume = float(solid.volume())
    if wanted.primitives:
        corners = mesh_arrays(solid.hull())[0]
        fit = fitted_primitive(corners, volume + wanted.missing, axes, wanted.shafts)
        if fit is not None:
            return CollisionSet((FittedShape(fit.shape, fit.X_AG),), 1.0, left_out)
    pieces = convex_pieces(solid, wanted.bores, wanted.filled, wanted.max_hulls)
    shapes = tuple(shape for piece in pieces for shape in _piece(piece, wanted, axes))
    return CollisionSet(shapes, round(volume / exact_sum(map(hull_volume, pieces)), 6), left_out)


def _piece(points: Array, wanted: Wanted, axes: Array) -> list[FittedShape]:
    """The shape of a convex piece; none if it is too flat for a hull."""
    hull = convex_hull(points)
    if hull is None:
        return []
    if wanted.primitives:
        fit = fitted_primitive(hull.vertices, hull_volume(hull.vertices), axes, wanted.shafts)
        if fit is not None and fit.filled >= CLOSE:
            return [FittedShape(fit.shape, fit.X_AG)]
    return [FittedShape(bounded_hull(hull, wanted.max_vertices), IDENTITY)]


def _axes(points: Array, faces: Any) -> Array:
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    return main_axes(normals[areas > 0.0] / areas[areas > 0.0, None], areas[areas > 0.0])
