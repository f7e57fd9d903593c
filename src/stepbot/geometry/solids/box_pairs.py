"""Finds overlapping pairs among many boxes; sorting along x makes a row of thousands nearly linear."""

import numpy as np
from numpy.typing import NDArray

from ..spatial import Array


def moved_boxes(low: Array, high: Array, R: Array, p: Array) -> tuple[Array, Array]:
    """Boxes aligned with A that enclose boxes given in B.

    Args:
        low: Lowest corners (n, 3) in B [m].
        high: Highest corners (n, 3) in B [m].
        R: Rotations R_AB (n, 3, 3).
        p: Positions p_AB (n, 3) [m].
    """
    middle = np.einsum("nij,nj->ni", R, 0.5 * (low + high)) + p
    reach = np.einsum("nij,nj->ni", np.abs(R), 0.5 * (high - low))
    return middle - reach, middle + reach


def box_pairs(low: Array, high: Array, depth: float = 0.0) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """All pairs i < j of boxes (n, 3) that overlap by more than ``depth`` along every axis, sorted."""
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order] + depth, high[order]
    ends = np.searchsorted(low[:, 0], high[:, 0])
    pairs = [np.empty((0, 2), dtype=np.int64)]
    for i, end in enumerate(ends.tolist()):
        behind = slice(i + 1, end)
        meets = (low[behind, 1:] < high[i, 1:]).all(axis=1) & (low[i, 1:] < high[behind, 1:]).all(axis=1)
        others = order[behind][meets]
        pairs.append(np.column_stack([np.full(len(others), order[i]), others]))
    found = np.sort(np.concatenate(pairs), axis=1)
    found = found[np.lexsort((found[:, 1], found[:, 0]))]
    return found[:, 0], found[:, 1]
