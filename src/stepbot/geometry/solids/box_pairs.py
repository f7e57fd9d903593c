"""Finds overlapping boxes: pairs among many, and two boxes at many poses."""

import numpy as np
from numpy.typing import NDArray

from ..spatial import Array, length, rotated

_OTHERS = ((1, 2), (2, 0), (0, 1))
"""For each axis, the two others in cyclic order."""
_PARALLEL = 1e-9
"""Added to cosines, so that the cross product of parallel edges, whose direction is rounding, separates nothing."""
_SLACK = 1.0 + 1e-12
"""Factor of radii, so that rounding separates nothing."""
_AT_ONCE = 1 << 18
"""Pairs that are compared at once, which limits memory."""


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
    """All pairs i < j of boxes (n, 3) that overlap by more than ``depth`` along every axis, sorted.

    Of the boxes in the order along one axis, only those that overlap along it are compared: a row or a layer of
    thousands takes nearly linear time.
    """
    low = low + depth
    axis = min(range(3), key=lambda one: int(_behind(low[:, one], high[:, one])[1].sum()))
    order, counts = _behind(low[:, axis], high[:, axis])
    low, high = low[order], high[order]
    pairs = [np.empty((0, 2), dtype=np.int64)]
    for rows in np.split(np.arange(len(order)), np.flatnonzero(np.diff(np.cumsum(counts) // _AT_ONCE)) + 1):
        first = np.repeat(rows, counts[rows])
        second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(counts[rows]) - counts[rows], counts[rows])
        for one in range(3):
            meet = (low[second, one] < high[first, one]) & (low[first, one] < high[second, one])
            first, second = first[meet], second[meet]
        pairs.append(np.column_stack([order[first], order[second]]))
    rows = np.sort(np.concatenate(pairs), axis=1)
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    return rows[:, 0], rows[:, 1]


def _behind(low: Array, high: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Intervals (n,) in the order of their beginning, and how many begin within each after it."""
    order = np.argsort(low, kind="stable")
    ends = np.searchsorted(low[order], high[order])
    return order, np.maximum(ends - np.arange(len(order)) - 1, 0)


def boxes_meet(box_a: tuple[Array, Array], box_b: tuple[Array, Array], R: Array, p: Array) -> NDArray[np.bool_]:
    """Whether two boxes overlap, at each of many poses: no separating axis among face normals and edges.

    Gottschalk, Lin, Manocha 1996, section 5. Boxes that nearly touch may count as overlapping.

    Args:
        box_a: Lowest and highest corner (3,) [m] of a box in A.
        box_b: Lowest and highest corner (3,) [m] of a box in B.
        R: Rotations R_AB (n, 3, 3).
        p: Positions p_AB (n, 3) [m].
    """
    (centre_a, half_a), (centre_b, half_b) = ((0.5 * (low + high), 0.5 * (high - low)) for low, high in (box_a, box_b))
    t = rotated(R, centre_b) + p - centre_a
    reach = _SLACK * (length(half_a) + length(half_b))
    near = np.flatnonzero(t[:, 0] ** 2 + t[:, 1] ** 2 + t[:, 2] ** 2 <= reach * reach)  # spheres around the boxes
    meet = np.zeros(len(R), dtype=bool)
    meet[near] = _none_separates(half_a, half_b, R[near], t[near])
    return meet


def _none_separates(half_a: Array, half_b: Array, R: Array, t: Array) -> NDArray[np.bool_]:
    """Whether no axis separates boxes with half edges (3,) [m], the second at R (n, 3, 3), t (n, 3) in the first."""
    size = np.abs(R) + _PARALLEL
    meet = (np.abs(t) <= half_a + rotated(size, half_b)).all(axis=1)
    meet &= (np.abs(np.einsum("nij,ni->nj", R, t)) <= half_b + np.einsum("nij,i->nj", size, half_a)).all(axis=1)
    for i, (i1, i2) in enumerate(_OTHERS):
        for j, (j1, j2) in enumerate(_OTHERS):
            reach = half_a[i1] * size[:, i2, j] + half_a[i2] * size[:, i1, j]
            reach += half_b[j1] * size[:, i, j2] + half_b[j2] * size[:, i, j1]
            meet &= np.abs(t[:, i2] * R[:, i1, j] - t[:, i1] * R[:, i2, j]) <= reach
    return np.asarray(meet)
