"""Finds coincident lines among many, without comparing all pairs.

A line is given by a point near its faces, and a direction whose sign has no meaning; the point must be near the faces,
because lines that are a milliradian apart diverge with distance.
"""

from collections.abc import Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.fixed_point import distinct_rows, merged_labels
from stepbot.geometry.spatial import Array, cross, perpendicular_frame

Indices = NDArray[np.intp]

_SIGN_THRESHOLD = 1e-6
_SAME_DIRECTION = 1e-7
_SAME_FOOT = 1e-7
_CHUNK = 256


class Rays(Struct, frozen=True, eq=False):
    """Lines in space, one per row."""

    centers: Array
    """Shape (n, 3) [m]."""
    directions: Array
    """Shape (n, 3), unit."""

    def rows(self, rows: Indices) -> "Rays":
        """Some of the lines."""
        return Rays(self.centers[rows], self.directions[rows])

    def distances(self, points: Array) -> Array:
        """Distances (n,) [m] of a point (3,), or of one point for each line (n, 3), from the infinite lines."""
        return np.asarray(np.linalg.norm(cross(points - self.centers, self.directions), axis=1))


def coaxial(rays: Rays, distance: float, angle: float) -> list[Indices]:
    """Rows of the rays that share a line within ``distance`` [m] and ``angle`` [rad], in the order of their first rows.

    Rays that coincide to a tenth of a micrometre are joined first: a line may have thousands of them, which leaves few
    to compare in pairs.
    """
    if not len(rays.centers):
        return []
    directions, kinds = _direction_kinds(rays.directions)
    basis = np.array([perpendicular_frame(d)[:, :2] for d in directions])[kinds]
    feet = np.rint(np.einsum("ni,nij->nj", rays.centers, basis) / _SAME_FOOT).astype(np.int64)
    first, rod_of = distinct_rows(np.column_stack([kinds, feet]))
    rods = rays.rows(first)
    groups = merged_labels(len(first), *close_pairs(rods, rods, distance, angle))
    return sorted(_members(groups[rod_of]), key=lambda rows: int(rows[0]))


def _members(kinds: Indices) -> list[Indices]:
    """The rows of each kind, by the kind of each row (n,)."""
    order = np.argsort(kinds, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(kinds[order])) + 1)


def signed(directions: Array) -> Array:
    """The same lines' directions (n, 3), of whose (z, y, x) the first larger than 1e-6 is positive."""
    if len(directions) == 1:  # a tenth of the time for one of them
        x, y, z = directions[0].tolist()
        leading = next((value for value in (z, y, x) if abs(value) > _SIGN_THRESHOLD), z)
        return (-directions if leading < 0.0 else directions) + 0.0
    large = np.abs(directions[:, ::-1]) > _SIGN_THRESHOLD
    leading = np.take_along_axis(directions[:, ::-1], large.argmax(axis=1)[:, None], axis=1)
    return np.where(leading < 0.0, -directions, directions) + 0.0


def _direction_kinds(directions: Array) -> tuple[Array, Indices]:
    """Directions (k, 3) that are not equal except for rounding, and which of them each row (n,) has."""
    first, kinds = distinct_rows(np.rint(signed(directions) / _SAME_DIRECTION).astype(np.int64))
    return directions[first], kinds


def close_pairs(a: Rays, b: Rays, distance: float, angle: float) -> tuple[Indices, Indices]:
    """Pairs of lines, one of each set, within ``distance`` [m] of each other's centre and ``angle`` [rad]."""
    (directions_a, kinds_a), (directions_b, kinds_b) = (_direction_kinds(rays.directions) for rays in (a, b))
    members_a, members_b = _members(kinds_a), _members(kinds_b)
    pairs = [(np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))]
    for i, j in _nearly_parallel(directions_a, directions_b, angle):
        rows_a, rows_b = members_a[i], members_b[j]
        plane = perpendicular_frame(directions_a[i])[:, :2]
        p, q = _close_points(a.centers[rows_a] @ plane, b.centers[rows_b] @ plane, distance)
        rows_a, rows_b = rows_a[p], rows_b[q]
        apart = gaps(a.rows(rows_a), b.rows(rows_b))
        pairs.append((rows_a[apart <= distance], rows_b[apart <= distance]))
    return np.concatenate([rows for rows, _ in pairs]), np.concatenate([rows for _, rows in pairs])


def gaps(a: Rays, b: Rays) -> Array:
    """Distances (n,) [m] between the lines of each row, at the centre of one or the other, whichever is larger."""
    return np.maximum(a.distances(b.centers), b.distances(a.centers))


def _nearly_parallel(A: Array, B: Array, angle: float) -> Iterator[tuple[int, int]]:
    """Indices of directions, one of each set, whose lines are within ``angle`` [rad]."""
    for start in range(0, len(A), _CHUNK):
        close = np.abs(A[start : start + _CHUNK] @ B.T) >= np.cos(angle) - 1e-15
        for i, j in np.argwhere(close).tolist():
            yield start + i, j


def _close_points(P: Array, Q: Array, distance: float) -> tuple[Indices, Indices]:
    """Pairs of points in the plane, (n, 2) and (m, 2), within ``distance``, by sorting them into cells of that size."""
    origin = np.minimum(P.min(axis=0), Q.min(axis=0)) - distance
    cells_p, cells_q = (np.floor((X - origin) / distance).astype(np.int64) for X in (P, Q))
    stride = int(max(cells_p[:, 1].max(), cells_q[:, 1].max())) + 2
    keys_q = cells_q[:, 0] * stride + cells_q[:, 1]
    order = np.argsort(keys_q, kind="stable")
    pairs = [(np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))]
    for dx in (-1, 0, 1):
        # Three cells adjacent in y have consecutive keys.
        keys = (cells_p[:, 0] + dx) * stride + cells_p[:, 1]
        start = np.searchsorted(keys_q[order], keys - 1, side="left")
        counts = np.searchsorted(keys_q[order], keys + 1, side="right") - start
        p = np.repeat(np.arange(len(P)), counts)
        offsets = np.arange(len(p)) - np.repeat(np.cumsum(counts) - counts, counts)
        q = order[np.repeat(start, counts) + offsets]
        close = np.linalg.norm(P[p] - Q[q], axis=1) <= distance * (1 + 1e-9)
        pairs.append((p[close], q[close]))
    return np.concatenate([p for p, _ in pairs]), np.concatenate([q for _, q in pairs])
