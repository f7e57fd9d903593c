"""Finds solids that pass through themselves: closed like any other, but part of their surface lies within them.

Their volume counts twice what lies in two of their lobes, whoever integrates it, so it says nothing of the body.
"""

import numpy as np

from ..spatial import Array, Pose
from .stitching import Indices, Stitched

_SAMPLES = 64
_LEAST = 0.03
"""Share of the surface from which on it is said: one sample alone may be an accident of the mesh."""
_STEEP = 0.02
"""Cosine below which a triangle is seen too nearly edge-on to tell its sides."""
_AXES = Pose.from_xyz_rpy(rpy=(0.61, -0.37, 0.83)).R
"""A frame in which no face that people draw is seen edge-on."""


def share_within(mesh: Stitched) -> float:
    """Share of a closed mesh's surface that has the inside on both its sides or on neither; 0 where that is little.

    From the middle of a triangle a ray goes upwards. How often it leaves the solid minus how often it enters is 0 if it
    starts on an upper side and 1 if it starts on a lower one: that is what inside and outside mean (Jordan).
    """
    corners = (mesh.vertices @ _AXES)[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lows, highs = (np.ascontiguousarray(extreme(axis=1)[:, :2].T) for extreme in (corners.min, corners.max))
    wrong = tried = 0
    for triangle in _spread(np.linalg.norm(normals, axis=1)):
        rise = normals[triangle, 2]
        if abs(rise) > _STEEP * np.linalg.norm(normals[triangle]):
            tried += 1
            x, y, _ = middle = corners[triangle].mean(axis=0)
            near = np.flatnonzero((lows[0] <= x) & (highs[0] >= x) & (lows[1] <= y) & (highs[1] >= y))
            others = near[near != triangle]
            wrong += _leaves(middle, corners[others], normals[others, 2]) != (rise < 0.0)
    share = float(wrong) / tried if tried else 0.0
    return share if share >= _LEAST else 0.0


def _spread(areas: Array) -> Indices:
    """Triangles at even steps of the surface, each once."""
    total = np.cumsum(areas)
    if not total.size or not total[-1] > 0.0:
        return np.empty(0, dtype=np.int64)
    steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * total[-1]
    return np.unique(np.searchsorted(total, steps))


def _leaves(start: Array, corners: Array, rises: Array) -> int:
    """How often a ray upwards from a point leaves through triangles, minus how often it enters."""
    # Twice the signed areas that the point spans with the sides: the weights of the opposite corners.
    a = corners[:, :, :2] - start[:2]
    b = np.roll(a, -1, axis=1)
    sides = (a[:, :, 0] * b[:, :, 1] - a[:, :, 1] * b[:, :, 0]) * np.sign(rises)[:, None]
    hit = (sides >= 0.0).all(axis=1) & (rises != 0.0)
    weights = sides[hit]
    heights = (np.roll(corners[hit, :, 2], 1, axis=1) * weights).sum(axis=1) / weights.sum(axis=1)
    return int(np.sign(rises[hit][heights > start[2]]).sum())
