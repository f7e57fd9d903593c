"""Finds self-intersecting solids: closed, but part of their surface is inside them.

Any integration counts the volume of overlapping lobes twice, so it is not the body's volume.
"""

import numpy as np

from stepbot.geometry.spatial import Array, Pose, cross

from .stitching import Indices, Stitched

_SAMPLES = 64
_LEAST = 0.03
"""Share of the surface from which it is reported: a single sample may be an artefact of the mesh."""
_STEEP = 0.02
"""Cosine below which a triangle is too close to edge-on to determine its sides."""
_AXES = Pose.from_xyz_rpy(rpy=(0.61, -0.37, 0.83)).R
"""A frame in which no typical CAD face is edge-on."""


def share_within(mesh: Stitched) -> float:
    """Share of a closed mesh's surface with the inside on both sides or on neither; 0 if it is small.

    A ray is cast upwards from the middle of a triangle. The number of exits from the solid minus that of entries is 0
    if it starts on an upper side and 1 if it starts on a lower one (Jordan).
    """
    points = mesh.vertices @ _AXES
    a, b, c = (points[mesh.faces[:, corner]] for corner in range(3))
    normals = cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    samples = _spread(lengths)
    samples = samples[np.abs(normals[samples, 2]) > _STEEP * lengths[samples]]
    if not len(samples):
        return 0.0
    starts = (a[samples] + b[samples] + c[samples]) / 3.0
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    x, y = starts[:, :1], starts[:, 1:2]
    near = (low[:, 0] <= x) & (high[:, 0] >= x) & (low[:, 1] <= y) & (high[:, 1] >= y)
    sample, triangle = np.nonzero(near)
    others = triangle != samples[sample]
    sample, triangle = sample[others], triangle[others]
    corners = np.stack([a[triangle], b[triangle], c[triangle]], axis=1)
    crossed = _crossings(starts[sample], corners, normals[triangle, 2])
    leaves = np.bincount(sample, crossed, len(samples))
    share = float((leaves != (normals[samples, 2] < 0.0)).mean())
    return share if share >= _LEAST else 0.0


def _spread(areas: Array) -> Indices:
    """Triangles at equal steps of the surface, each once."""
    total = np.cumsum(areas)
    if not total.size or not total[-1] > 0.0:
        return np.empty(0, dtype=np.int64)
    steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * total[-1]
    return np.unique(np.searchsorted(total, steps))


def _crossings(starts: Array, corners: Array, rises: Array) -> Array:
    """Whether upward rays from points (k, 3) hit their triangles (k, 3, 3): 1 exits, -1 enters, 0 misses."""
    # Twice the signed areas that the point spans with the sides: the weights of the opposite corners.
    a = corners[:, :, :2] - starts[:, None, :2]
    b = np.roll(a, -1, axis=1)
    sides = (a[:, :, 0] * b[:, :, 1] - a[:, :, 1] * b[:, :, 0]) * np.sign(rises)[:, None]
    total = sides.sum(axis=1)
    hit = (sides >= 0.0).all(axis=1) & (total > 0.0)
    heights = (np.roll(corners[:, :, 2], 1, axis=1) * sides).sum(axis=1)
    return np.where(hit & (heights > starts[:, 2] * total), np.sign(rises), 0.0)
