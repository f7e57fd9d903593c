"""The largest distance of points of a mesh from another mesh that was made from it, or the other way round."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .spatial import Array, cross, dot

PROBE = 1e-9
"""Radius [m] of the sphere in place of a point, by which distances are too small."""


Distances = Callable[[Array], Array]
"""Distances (n,) [m] of points (n, 3) from a surface."""


def distances_from(vertices: Array, faces: Any) -> Distances:
    """The distances from a surface of vertices (n, 3) [m] and triangles (m, 3)."""
    import fcl

    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(vertices, faces)
    model.endModel()
    surface, sphere = fcl.CollisionObject(model, fcl.Transform()), fcl.Sphere(PROBE)

    def distances(points: Array) -> Array:
        probes = (fcl.CollisionObject(sphere, fcl.Transform(point)) for point in points)
        results = [fcl.distance(probe, surface, fcl.DistanceRequest(), fcl.DistanceResult()) for probe in probes]
        return np.asarray(np.maximum(results, 0.0))

    return distances


Integers = NDArray[np.int64]
_CHUNK = 200_000
"""Number of pairs of point and triangle to measure at once."""
_MOST_QUERIES = 2_000
"""Maximum number of exact distances."""


def largest_distance(points: Array, places: Integers, vertices: Array, surface: Integers, at: Integers) -> float:
    """The largest distance [m] of points from a surface.

    Each point is first compared with the triangles of the surface at its place, which gives an upper bound. Points with
    large bounds are then compared with the whole surface, until no bound exceeds the largest distance.

    Args:
        points: Shape (n, 3) [m].
        places: A place for each point (n,).
        vertices: Shape (k, 3) [m].
        surface: Triangles (m, 3) of these vertices.
        at: The places (m, 3) of the corners of the triangles.
    """
    if not len(points) or not len(surface):
        return 0.0
    bounds = _bounds(points, places, vertices, surface, at)
    distances, farthest = distances_from(vertices, surface), 0.0
    for number, index in enumerate(np.argsort(-bounds, kind="stable").tolist()):
        if bounds[index] <= farthest:
            break
        if number == _MOST_QUERIES:
            return float(bounds[index])
        farthest = max(farthest, min(float(bounds[index]), float(distances(points[index][None])[0])))
    return farthest


def _bounds(points: Array, places: Integers, vertices: Array, surface: Integers, at: Integers) -> Array:
    """Distances (n,) [m] of points from the triangles at their places; infinite without any."""
    by_place = np.argsort(at.reshape(-1), kind="stable")
    faces_at, sorted_places = by_place // 3, at.reshape(-1)[by_place]
    low, high = (np.searchsorted(sorted_places, places, side) for side in ("left", "right"))
    with_any = np.flatnonzero(high > low)
    counts = (high - low)[with_any]
    ends = np.cumsum(counts)
    bounds = np.full(len(points), np.inf)
    first = 0
    while first < len(with_any):
        done = int(ends[first - 1]) if first else 0
        last = max(int(np.searchsorted(ends, done + _CHUNK, "right")), first + 1)
        chosen, number = with_any[first:last], counts[first:last]
        starts = np.cumsum(number) - number
        within = np.arange(int(ends[last - 1]) - done) - np.repeat(starts, number)
        near = surface[faces_at[np.repeat(low[chosen], number) + within]]
        squared = squared_distances(np.repeat(points[chosen], number, axis=0), vertices[near])
        bounds[chosen] = np.sqrt(np.minimum.reduceat(squared, starts))
        first = last
    return bounds


def squared_distances(p: Array, triangles: Array) -> Array:
    """Squared distances (n,) [m^2] of points (n, 3) from triangles (n, 3, 3)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = cross(b - a, c - a)
    size = dot(normal, normal)
    over = size > 0.0
    for start, end in ((a, b), (b, c), (c, a)):
        over &= dot(cross(end - start, p - start), normal) >= 0.0
    height = dot(p - a, normal)
    plane = height * height / np.where(size > 0.0, size, 1.0)
    squared = np.where(over, plane, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        squared = np.minimum(squared, _squared_from_segment(p, start, end))
    return squared


def _squared_from_segment(p: Array, a: Array, b: Array) -> Array:
    along = b - a
    length = dot(along, along)
    share = np.clip(dot(p - a, along) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
    gap = p - a - share[:, None] * along
    return dot(gap, gap)
