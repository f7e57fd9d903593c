"""Points by position: finding duplicates, and taking a sample of many."""

import numpy as np

from stepbot.geometry.spatial import Array

TOLERANCE = 5e-5
"""Distance [m] up to which vertices are equal: meshes are in single precision, and of other tolerances."""


def spread(points: Array, most: int) -> Array:
    """At most ``most`` of points (n, 3), evenly sampled, without duplicates."""
    unique = points[np.sort(np.unique(np.rint(points / TOLERANCE), axis=0, return_index=True)[1])]
    if len(unique) <= most:
        return unique
    return np.asarray(unique[np.linspace(0, len(unique) - 1, most).astype(int)])
