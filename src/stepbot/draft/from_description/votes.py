"""Rotation of a body about a line, or translation along it, that most pairs of equal vertices agree on."""

import numpy as np
from numpy.typing import NDArray

from stepbot.draft.from_description.surfaces import TOLERANCE
from stepbot.draft.parts.axis import Axis
from stepbot.geometry.spatial import Array, perpendicular_frame

_LEAST_RADIUS = 2e-3
"""Distance [m] from the line above which a vertex gives an angle."""
_ANGLE, _SLIDE = 2e-3, 1e-4
"""Widths [rad] and [m] of the bins of the vote."""
_OFFERED = 4
_BITS = 21
_MOST_PAIRS = 2_000_000


def turns(points: Array, vertices: Array, axis: Axis) -> list[float]:
    """Angles [rad] about a line that map points (n, 3) to vertices (m, 3), the most frequent first."""
    r, phi, z = _cylindrical(points, axis)
    far = r > _LEAST_RADIUS
    radius, angle, height = _cylindrical(vertices, axis)
    pairs = _alike(np.column_stack([r, z])[far], np.column_stack([radius, height]))
    delta = np.angle(np.exp(1j * (angle[pairs[1]] - phi[far][pairs[0]])))
    return _peaks(delta, _ANGLE)


def slides(points: Array, vertices: Array, axis: Axis) -> list[float]:
    """Distances [m] along a line, likewise."""
    frame = perpendicular_frame(axis.d)
    ours, theirs = (points - axis.point) @ frame, (vertices - axis.point) @ frame
    pairs = _alike(ours[:, :2], theirs[:, :2])
    along = float(frame[:, 2] @ axis.d)
    return _peaks(along * (theirs[pairs[1], 2] - ours[pairs[0], 2]), _SLIDE)


def translations(points: Array, vertices: Array) -> list[Array]:
    """Translations (3,) [m] that map a few points (n, 3) to vertices (m, 3), the most frequent first."""
    deltas = (vertices[None] - points[:, None]).reshape(-1, 3)
    cells = np.rint(deltas / _SLIDE).astype(np.int64)
    _, first, counts = np.unique(_keys(cells), return_index=True, return_counts=True)
    best = np.argsort(-counts, kind="stable")[:_OFFERED]
    shifts = []
    for cell in cells[first[best]]:
        near = np.abs(deltas - cell * _SLIDE).max(axis=1) < _SLIDE
        shifts.append(np.median(deltas[near], axis=0))
    return shifts


def _cylindrical(points: Array, axis: Axis) -> tuple[Array, Array, Array]:
    frame = perpendicular_frame(axis.d)
    x, y, z = ((points - axis.point) @ frame).T
    return np.hypot(x, y), np.arctan2(y, x), z


def _alike(ours: Array, theirs: Array) -> tuple[Array, Array]:
    """Indices of all pairs of rows (n, 2) and (m, 2) that agree within the tolerance."""
    keys = _keys(np.rint(theirs / TOLERANCE).astype(np.int64))
    order = np.argsort(keys, kind="stable")
    sorted_keys = keys[order]
    mine, other = [], []
    low = np.floor(ours / TOLERANCE).astype(np.int64)
    for corner in ((0, 0), (0, 1), (1, 0), (1, 1)):
        wanted = _keys(low + np.array(corner))
        first, last = np.searchsorted(sorted_keys, wanted), np.searchsorted(sorted_keys, wanted, side="right")
        counts = last - first
        total = int(counts.sum())
        if not total or total > _MOST_PAIRS:
            continue
        row = np.repeat(np.arange(len(ours)), counts)
        start = np.repeat(first - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
        mine.append(row)
        other.append(order[start + np.arange(total)])
    if not mine:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    return np.concatenate(mine), np.concatenate(other)


def _keys(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number for each row (n, 2) or (n, 3)."""
    keys = np.zeros(len(cells), dtype=np.int64)
    for column in cells.T:
        keys = (keys << _BITS) + column + (1 << (_BITS - 1))
    return keys


def _peaks(values: Array, width: float) -> list[float]:
    if not len(values):
        return []
    cells, counts = np.unique(np.rint(values / width).astype(np.int64), return_counts=True)
    best = np.argsort(-counts, kind="stable")[:_OFFERED]
    return [float(np.median(values[np.abs(values - cell * width) < width])) for cell in cells[best]]
