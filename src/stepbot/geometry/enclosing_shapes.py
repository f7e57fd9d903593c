"""Simple shapes that enclose points: axis-aligned box, smallest sphere, cylinder and capsule.

A cylinder or capsule is aligned with one of the given directions, the one with the smallest volume; its cross-section
is the smallest circle around the points projected along that direction. The result is None if the points enclose no
volume.
"""

from collections.abc import Iterable
from itertools import combinations
from math import pi

import numpy as np

from .primitives import Box, Capsule, Cylinder, Sphere
from .spatial import Array, Pose, corners, cross, dot, matrix_product, perpendicular_frame, rotated

THINNEST = 1e-6
"""Minimum size [m] of a shape."""

_SLACK = 1e-12


def box_around(points: Array) -> tuple[Box, Pose] | None:
    """The axis-aligned box of points (n, 3) [m], and its pose in their frame."""
    low, high = corners(points)
    if float((high - low).min()) < THINNEST:
        return None
    x, y, z = (high - low).tolist()
    return Box((x, y, z)), Pose.of(position=0.5 * (low + high))


def sphere_around(points: Array) -> tuple[Sphere, Pose] | None:
    """The smallest sphere around points (n, 3) [m], and its pose."""
    center, radius = smallest_ball(points)
    return (Sphere(radius), Pose.of(position=center)) if radius >= THINNEST else None


def cylinder_around(points: Array, directions: Iterable[Array]) -> tuple[Cylinder, Pose] | None:
    """The smallest cylinder around points (n, 3) [m] along one of the directions, and its pose."""
    candidates = []
    for R in map(perpendicular_frame, directions):
        across, along = matrix_product(points, R[:, :2]), dot(points, R[:, 2])
        center, radius = smallest_ball(across)
        length = float(along.max() - along.min())
        middle = rotated(R, np.array([*center, 0.5 * (along.max() + along.min())]))
        if radius >= THINNEST and length >= THINNEST:
            candidates.append((pi * radius**2 * length, Cylinder(radius, length), Pose.of(R, middle)))
    return min(candidates, key=lambda fit: fit[0])[1:] if candidates else None


def capsule_around(points: Array, directions: Iterable[Array]) -> tuple[Capsule, Pose] | None:
    """The smallest capsule around points (n, 3) [m] along one of the directions, and its pose."""
    candidates = []
    for R in map(perpendicular_frame, directions):
        across, along = matrix_product(points, R[:, :2]), dot(points, R[:, 2])
        center, radius = smallest_ball(across)
        # Away from the axis the half sphere is lower than at its pole, so the cylinder has to be longer.
        dome = np.sqrt(np.maximum(radius**2 - ((across - center) ** 2).sum(axis=1), 0.0))
        low, high = float((along + dome).min()), float((along - dome).max())
        length = max(high - low, 0.0)
        middle = rotated(R, np.array([*center, 0.5 * (low + high)]))
        if radius >= THINNEST:
            volume = pi * radius**2 * (length + 4.0 / 3.0 * radius)
            candidates.append((volume, Capsule(radius, length), Pose.of(R, middle)))
    return min(candidates, key=lambda fit: fit[0])[1:] if candidates else None


def smallest_ball(points: Array) -> tuple[Array, float]:
    """Centre (d,) and radius of the smallest ball around points (n, d).

    Starts with one point and adds the farthest until no point is outside; each time, the ball around the supporting
    points and the new one is found by trying all subsets of them. The radius grows with each step, so the loop ends.
    """
    center, radius, held_by = points[0], 0.0, points[:1]
    while True:
        distances = np.linalg.norm(points - center, axis=1)
        farthest = int(distances.argmax())
        if distances[farthest] <= radius * (1 + 1e-10) + _SLACK:
            return center, float(distances[farthest])
        grown, bigger, support = _ball_of_few(np.vstack([held_by, points[farthest]]))
        if bigger <= radius:  # rounding: no measurably better ball exists
            return center, float(distances[farthest])
        center, radius, held_by = grown, bigger, support


def _ball_of_few(points: Array) -> tuple[Array, float, Array]:
    """Centre, radius and supporting points of the smallest ball around at most d + 2 points (n, d)."""
    balls = []
    for size in range(2, min(len(points), points.shape[1] + 1) + 1):
        for chosen in combinations(range(len(points)), size):
            support = points[list(chosen)]
            center = _equally_far(support)
            if center is not None:
                balls.append((center, float(np.linalg.norm(points - center, axis=1).max()), support))
    return min(balls, key=lambda ball: ball[1])


def _equally_far(support: Array) -> Array | None:
    """The point equidistant from two to four points (n, d), in their line or plane; None if these are degenerate.

    Uses only products and sums: LAPACK's results differ in the last bits between versions of numpy.
    """
    edges = np.zeros((len(support) - 1, 3))
    edges[:, : support.shape[1]] = support[1:] - support[0]
    halves = 0.5 * (edges**2).sum(axis=1)
    if len(edges) == 1:
        offset = 0.5 * edges[0]
    else:
        u, v = edges[:2]
        n = cross(u, v)
        w, half = (edges[2], halves[2]) if len(edges) == 3 else (n, 0.0)
        volume = float((n * w).sum())
        if volume == 0.0:
            return None
        # The point whose dot products with u, v and w are half their squared lengths, by Cramer's rule.
        offset = (halves[0] * cross(v, w) + halves[1] * cross(w, u) + half * n) / volume
    center: Array = support[0] + offset[: support.shape[1]]
    return center if np.isfinite(center).all() else None
