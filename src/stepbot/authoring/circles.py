"""Circles in outlines, and centres of symmetry of others."""

import numpy as np

from stepbot.geometry.spatial import Array, perpendicular_frame

_FEWEST = 12
"""Minimum number of points of a circle, below which an outline is a polygon."""
_FEWEST_CORNERS = 4
_SYMMETRIC = 2e-6
"""Distance [m] up to which opposite points are symmetric."""


def fitted_circle(points: Array, normal: Array, tolerance: float) -> tuple[Array, float] | None:
    """Centre (3,) and radius of the circle through coplanar points (n, 3); None if they are not on a circle.

    An arc counts if no gap in it is larger than half of the circle.
    """
    if len(points) < _FEWEST:
        return None
    frame = perpendicular_frame(normal)[:, :2]
    middle = points.mean(axis=0)
    flat = (points - middle) @ frame
    A = np.column_stack([2.0 * flat, np.ones(len(flat))])
    x, y, rest = np.linalg.lstsq(A, (flat**2).sum(axis=1), rcond=None)[0].tolist()
    centre = np.array([x, y])
    radius = float(np.sqrt(max(0.0, rest + x * x + y * y)))
    spokes = flat - centre
    if np.abs(np.linalg.norm(spokes, axis=1) - radius).max() > max(tolerance, 1e-3 * radius * (tolerance > 1e-5)):
        return None
    angles = np.sort(np.arctan2(spokes[:, 0], spokes[:, 1]))
    if np.diff(np.append(angles, angles[0] + 2.0 * np.pi)).max() > np.pi:
        return None
    return middle + frame @ centre, radius


def symmetric_outline(points: Array) -> tuple[Array, float] | None:
    """Centre (3,) and inner radius of an outline (n, 3) with a centre of symmetry, such as a rectangle, else None."""
    if len(points) < _FEWEST_CORNERS or len(points) % 2:
        return None
    half = len(points) // 2
    # Opposite points of a symmetric outline are half of its length apart.
    sums = points[:half] + points[half:]
    if float(np.abs(sums - sums[0]).max()) > _SYMMETRIC:
        return None
    middle = points.mean(axis=0)
    starts, edges = points - middle, np.roll(points, -1, axis=0) - points
    squares = np.maximum((edges**2).sum(axis=1), 1e-24)
    feet = starts + edges * np.clip(-(starts * edges).sum(axis=1) / squares, 0.0, 1.0)[:, None]
    return middle, float(np.linalg.norm(feet, axis=1).min())
