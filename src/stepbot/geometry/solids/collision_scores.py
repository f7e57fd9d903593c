"""How well collision shapes match the solids of a link: intersection over union, and overshoot.

The intersection over union is by volume. Of shapes that enclose the solids, it is the volume of the solids divided by
that of the shapes; others are intersected with the solids. Curved primitives are prisms of the same volume; where one
primitive is the only shape, the volume between mesh and exact solid counts too, so that a cylinder on a cylinder is 1.
Closed voids of the solids count as filled.

The overshoot is the largest distance of a point of the shapes from the solids. A distance changes by no more than the
point moves, so a triangle can be left out, or has to be divided, by the distance of its centre and its radius. The
search is outside a simplified solid and measures from it; the distance of the point that it finds is measured from the
exact one.
"""

from collections.abc import Sequence
from math import sqrt
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ..mesh import TriMesh, triangle_areas
from ..mesh_distance import Distances, distances_from, squared_distances
from ..spatial import Array
from .manifolds import faces_not_of, mesh_arrays, of_same_volume
from .unions import SIMPLIFIED, PlacedShape, PlacedSolid, Union, union

MAX_FACES = 1_000_000
"""Maximum number of faces of a link that is scored."""
_ACCURACY = 4e-3
"""Accuracy of the overshoot, as a share of the diagonal of the solids."""
_AT_ONCE = 100
"""Number of triangles that are divided at once: first the large ones that may be far, not films between faces."""
_UNKNOWN = 1e9
"""Upper bound of distances [m] that are not measured."""
_MOST_POINTS = 2_000
"""Maximum number of corners, and of further points, whose distances are measured for one overshoot."""
_DECIMALS = 6


class UnscoredSolids(Struct, frozen=True, eq=False):
    """Solids and their collision shapes, all in A."""

    solids: tuple[PlacedSolid, ...]
    missing: float
    """Exact volume [m^3] of the solids, minus that of their meshes."""
    shapes: tuple[PlacedShape, ...]


class CollisionScore(Struct, frozen=True):
    """Both are None without closed solids or without shapes, or for a link of too many faces."""

    iou: float | None = None
    """Volume of the intersection / volume of the union, to six decimals."""
    overshoot: float | None = None
    """[m], to the nearest micrometre."""


NO_SCORE = CollisionScore()


def collision_scores(unscored: Sequence[UnscoredSolids]) -> tuple[CollisionScore, ...]:
    """The score of each."""
    return tuple(map(collision_score, unscored))


def collision_score(unscored: UnscoredSolids, encloses: bool = False) -> CollisionScore:
    """The score of the shapes of a link.

    Args:
        encloses: Whether the shapes are known to enclose the solids.
    """
    import manifold3d

    meshes = [solid.mesh for solid in unscored.solids]
    meshes += [shape.geometry for shape in unscored.shapes if isinstance(shape.geometry, TriMesh)]
    if not unscored.shapes or sum(len(mesh.faces) for mesh in meshes) > MAX_FACES:
        return NO_SCORE
    solid = union(unscored.solids)
    if solid.manifold is None:
        return NO_SCORE
    parts = [of_same_volume(shape.geometry).transform(shape.X_AG.matrix[:3]) for shape in unscored.shapes]
    shapes = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    volume = float(shapes.volume())
    outside = volume - solid.volume if encloses else float((shapes - solid.manifold).volume())
    is_exact = len(unscored.shapes) == 1 and not isinstance(unscored.shapes[0].geometry, TriMesh)
    both = volume - outside + (unscored.missing if is_exact else 0.0)
    iou = both / (solid.volume + outside)
    return CollisionScore(round(min(iou, 1.0), _DECIMALS), round(_overshoot(solid, shapes), _DECIMALS))


def _overshoot(solid: Union, shapes: Any) -> float:
    """The largest distance [m] of a point of the shapes from a solid."""
    corners, sides, touching = faces_not_of(shapes - solid.simplified, solid.simplified)
    if not len(sides):
        return 0.0
    distances = distances_from(*mesh_arrays(solid.simplified))
    accuracy = (_ACCURACY - 2.0 * SIMPLIFIED) * solid.diagonal
    return _distance(solid, *_farthest(distances, corners, sides, touching, accuracy))


def _farthest(
    distances: Distances, corners: Array, sides: Any, touching: NDArray[np.bool_], accuracy: float
) -> tuple[Array, float]:
    """The point (3,) of triangles that is farthest from a solid, up to ``accuracy`` [m], and its distance [m].

    Args:
        distances: From the solid.
        corners: Points (n, 3) [m].
        sides: Triangles (m, 3), indices of corners.
        touching: Which corners (n,) are on the solid.
        accuracy: [m].
    """
    away = np.where(touching, 0.0, _UNKNOWN)
    measured = np.flatnonzero(~touching)[:_MOST_POINTS]
    away[measured] = distances(corners[measured])
    best = int(np.where(away < _UNKNOWN, away, -1.0).argmax())
    farthest, most = corners[best], float(away[best])
    triangles, away, count = corners[sides], away[sides], 0
    bounds = _most_away(triangles, away)
    while (is_far := bounds > most + accuracy).any() and count < _MOST_POINTS:
        triangles, away, bounds = triangles[is_far], away[is_far], bounds[is_far]
        order = np.argsort(-bounds * triangle_areas(triangles), kind="stable")
        first, rest = order[:_AT_ONCE], order[_AT_ONCE:]
        turned, of_turned = _turned(triangles[first], away[first])
        halves, of_halves = np.concatenate([turned, turned]), np.concatenate([of_turned, of_turned])
        middles = 0.5 * (turned[:, 0] + turned[:, 1])
        gaps = distances(middles)
        count += len(middles)
        if gaps.max() > most:
            farthest, most = middles[int(gaps.argmax())], float(gaps.max())
        halves[: len(first), 1], halves[len(first) :, 0] = middles, middles
        of_halves[: len(first), 1], of_halves[len(first) :, 0] = gaps, gaps
        triangles, away = np.concatenate([triangles[rest], halves]), np.concatenate([away[rest], of_halves])
        bounds = np.concatenate([bounds[rest], _most_away(halves, of_halves)])
    return farthest, most


def _turned(triangles: Array, away: Array) -> tuple[Array, Array]:
    """Triangles (m, 3, 3) whose longest side is from the first to the second corner, and distances (m, 3) of these."""
    turns = (_side_lengths(triangles).argmax(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(triangles, turns[:, :, None], axis=1), np.take_along_axis(away, turns, axis=1)


def _most_away(triangles: Array, away: Array) -> Array:
    """Upper bounds (m,) of the distances of points of triangles (m, 3, 3) by the distances (m, 3) of corners.

    A point is within the longest side / sqrt(3) of a corner, and within the longer of the two sides at a corner of that
    one.
    """
    lengths = _side_lengths(triangles)
    of_nearest = away.max(axis=1) + lengths.max(axis=1) / sqrt(3.0)
    of_each = away + np.maximum(lengths, np.roll(lengths, 1, axis=1))
    return np.asarray(np.minimum(of_nearest, of_each.min(axis=1)))


def _side_lengths(triangles: Array) -> Array:
    """Lengths (m, 3) of the sides from each corner to the next."""
    return np.asarray(np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2))


def _distance(solid: Union, point: Array, about: float) -> float:
    """The distance [m] of a point (3,) from a solid, by that from the simplified one."""
    points, faces = solid.arrays
    low, high = points[faces].min(axis=1), points[faces].max(axis=1)
    apart = np.maximum(np.maximum(low - point, point - high), 0.0)
    near = faces[np.linalg.norm(apart, axis=1) <= about + 2.0 * SIMPLIFIED * solid.diagonal]
    return sqrt(float(squared_distances(np.broadcast_to(point, (len(near), 3)), points[near]).min()))
