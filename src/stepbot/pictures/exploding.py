"""Exploded views: each component moves away from the middle of the one that it belongs to.

Components of a common centre, such as a shaft and its bearing, stay inside each other.
"""

from collections.abc import Collection, Sequence

import numpy as np

from stepbot.geometry.spatial import Array


def exploded(boxes: Array, parents: Sequence[int], units: Collection[int], apart: float) -> Array:
    """A displacement [m] for each component of a tree.

    Args:
        boxes: Lowest and highest corner [m] of each component and everything below it, shape (n, 2, 3); NaN for empty
            ones.
        parents: Index of the component above each; -1 for the root, which is the first; parents precede their children.
        units: Components whose parts stay together.
        apart: Displacement relative to the distance between the centres of a component and its parent.

    Returns:
        Shape (n, 3).
    """
    centres: Array = boxes.mean(axis=1)
    moves: Array = np.zeros(centres.shape)
    inside = np.zeros(len(parents), dtype=bool)
    for index, parent in enumerate(parents):
        if parent < 0:
            continue
        moves[index] = moves[parent]
        inside[index] = inside[parent] or parent in units
        if not inside[index] and np.isfinite(boxes[index]).all():
            moves[index] += apart * (centres[index] - centres[parent])
    return moves
