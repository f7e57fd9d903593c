"""Points by position: finding duplicates, and taking a sample of many."""

import numpy as np

from stepbot.geometry.distinct_rows import distinct_rows
from stepbot.geometry.spatial import Array

TOLERANCE = 5e-5
"""Distance [m] up to which vertices are equal: meshes are in single precision, and of other tolerances."""


def spread(points: Array, most: int) -> Array:
    """At most ``most`` of points (n, 3), evenly sampled, without duplicates."""
    unique = points[np.sort(distinct_rows(np.rint(points / TOLERANCE))[0])]
    if len(unique) <= most:
        return unique
    return np.asarray(unique[np.linspace(0, len(unique) - 1, most).astype(int)])
