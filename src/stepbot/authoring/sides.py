"""Triangles of the parts of a link that look along the motion of a joint, part after part in one array.

The parts are in a frame whose z axis is that of the joint. A triangle has bounds in what the motion leaves as it is:
distance from z and height for a turn, x and y for a slide.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array

from .runs import chunks, expanded, starts_of
from .sweeps import MARGIN, Indices, Triangles, across, reach

_ALONG = 0.3
"""Cosine of the angle between normal and motion from which a face can stop it."""
_CHUNK = 1_000_000


class Placed:
    """The meshes of the parts of a link."""

    def __init__(
        self, parts: Sequence[int], vertices: Sequence[Array], faces: Sequence[NDArray[np.int32]], *, slides: bool
    ) -> None:
        """Store meshes.

        Args:
            parts: A number for each part.
            vertices: Of each part (n, 3) [m], at least one.
            faces: Of each part (m, 3).
            slides: Whether the joint slides.
        """
        self._parts, self._vertices, self._faces, self._slides = parts, vertices, faces, slides

    @cached_property
    def bounds(self) -> Array:
        """Shape (k, 2, 2): bounds around those of all triangles of each part."""
        points = np.concatenate([np.zeros((0, 3)), *self._vertices])
        starts = starts_of([len(vertices) for vertices in self._vertices])
        low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
        if self._slides:
            return np.stack([low[:, :2], high[:, :2]], axis=1)
        radii = np.linalg.norm(points[:, :2], axis=1)
        nearest = np.minimum.reduceat(radii, starts) - np.linalg.norm(high - low, axis=1)
        least, most = [nearest, low[:, 2]], [np.maximum.reduceat(radii, starts), high[:, 2]]
        return np.stack([np.stack(least, axis=1), np.stack(most, axis=1)], axis=1)

    def within_reach(self, others: "Placed") -> "Placed":
        """The parts that can meet one of the others, by their bounds."""
        if not self._parts or not others._parts:
            return Placed([], [], [], slides=self._slides)
        a, b = self.bounds[:, None], others.bounds[None]
        apart = (a[:, :, 0] >= b[:, :, 1]) | (b[:, :, 0] >= a[:, :, 1])
        kept = np.flatnonzero(~(apart[:, :, 0] | apart[:, :, 1]).all(axis=1)).tolist()
        parts, vertices = [self._parts[k] for k in kept], [self._vertices[k] for k in kept]
        return Placed(parts, vertices, [self._faces[k] for k in kept], slides=self._slides)

    def facing(self, sign: float) -> "Sides":
        """The triangles whose outside looks along the motion, or against it for a negative sign."""
        along, least = self._directions
        rows = np.flatnonzero((least > 0.0) & (sign * along > _ALONG * least))
        counts = np.bincount(self._owners[rows], minlength=len(self._parts))
        shown = np.flatnonzero(counts)
        parts = tuple(self._parts[k] for k in shown.tolist())
        corners = self._corners[rows]
        return Sides(parts, starts_of(counts[shown]), corners, *(across(corners) if self._slides else reach(corners)))

    @cached_property
    def _owners(self) -> Indices:
        """The part of each triangle."""
        return np.repeat(np.arange(len(self._parts)), [len(faces) for faces in self._faces])

    @cached_property
    def _corners(self) -> Array:
        """Shape (n, 3, 3), of all triangles."""
        pairs = zip(self._vertices, self._faces, strict=True)
        return np.concatenate([np.zeros((0, 3, 3)), *(vertices[faces] for vertices, faces in pairs)])

    @cached_property
    def _directions(self) -> tuple[Array, Array]:
        """Of all triangles the products of normal and motion, and the product of their lengths."""
        (x, x1, x2), (y, y1, y2), (z, z1, z2) = np.ascontiguousarray(self._corners.T)
        ux, uy, uz, vx, vy, vz = x1 - x, y1 - y, z1 - z, x2 - x, y2 - y, z2 - z
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        lengths = np.sqrt(nx * nx + ny * ny + nz * nz)
        if self._slides:
            return nz, lengths
        motion_x, motion_y = -(y + y1 + y2) / 3.0, (x + x1 + x2) / 3.0
        return nx * motion_x + ny * motion_y, lengths * np.sqrt(motion_x * motion_x + motion_y * motion_y)


@dataclass(frozen=True, eq=False)
class Sides:
    """Triangles of parts that look one way."""

    parts: tuple[int, ...]
    """The k parts that have any."""
    starts: Indices
    """Shape (k,): the first triangle of each part."""
    corners: Array
    """Shape (n, 3, 3) [m]."""
    low: Array
    """Shape (n, 2): of each triangle the least of what the motion leaves as it is."""
    high: Array
    """Shape (n, 2), likewise the most."""

    @cached_property
    def bounds(self) -> Array:
        """Shape (k, 2, 2): the least and the most of the triangles of each part."""
        least, most = np.minimum.reduceat(self.low, self.starts), np.maximum.reduceat(self.high, self.starts)
        return np.stack([least, most], axis=1)

    def triangles(self, rows: Indices) -> Triangles:
        """Some of the triangles."""
        return Triangles(self.corners[rows], self.low[rows], self.high[rows])

    def counts_near(self, others: "Sides") -> Indices:
        """Shape (m, k): for each of the other parts, how many triangles of each of these can meet some of its."""
        found = np.zeros((len(others.parts), len(self.parts)), dtype=np.int64)
        rows = max(1, _CHUNK // max(1, len(self.low)))
        for start in range(0, len(found) if len(self.low) else 0, rows):
            near = _within(self.low, self.high, others.bounds[start : start + rows, :, :, None])
            found[start : start + rows] = np.add.reduceat(near, self.starts, axis=1, dtype=np.int64)
        return found

    def near(self, rows: Indices, others: "Sides", other_rows: Indices) -> tuple[Indices, Indices]:
        """For p pairs of parts, by their rows (p,) here and there, the triangles here that can meet some of the other.

        Returns:
            Numbers of pairs, ascending, and of triangles, each (q,).
        """
        sizes = np.diff(np.append(self.starts, len(self.low)))[rows]
        found = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))]
        # Parts with many triangles are in many pairs: not all of them at once.
        for some in chunks(sizes):
            runs, offsets = expanded(sizes[some])
            pairs = some[runs]
            triangles = self.starts[rows[pairs]] + offsets
            bounds = np.moveaxis(others.bounds[other_rows[pairs]], 0, -1)
            near = _within(self.low[triangles], self.high[triangles], bounds)
            found.append((pairs[near], triangles[near]))
        return np.concatenate([pairs for pairs, _ in found]), np.concatenate([triangles for _, triangles in found])


def meeting(
    still: Sides, moving: Sides, near_still: tuple[Indices, Indices], near_moving: tuple[Indices, Indices]
) -> tuple[Indices, Indices, Indices]:
    """Pairs of triangles whose bounds overlap, of pairs of parts.

    Args:
        still: Triangles of one link.
        moving: Triangles of the other.
        near_still: Numbers of pairs of parts, ascending, and of triangles of one link, by :meth:`Sides.near`.
        near_moving: The same of the other link.

    Returns:
        Numbers of pairs of parts, of triangles of one link, and of the other, each (q,).
    """
    pairs_still, triangles = near_still
    pairs_moving, others = near_moving
    begins, ends = (np.searchsorted(pairs_still, pairs_moving, side=side) for side in ("left", "right"))
    rows, offsets = expanded(ends - begins)
    i, j = triangles[begins[rows] + offsets], others[rows]
    low, high = still.low[i] - 2.0 * MARGIN, still.high[i] + 2.0 * MARGIN
    others_low, others_high = moving.low[j], moving.high[j]
    meet = (low[:, 0] <= others_high[:, 0]) & (others_low[:, 0] <= high[:, 0])
    meet &= (low[:, 1] <= others_high[:, 1]) & (others_low[:, 1] <= high[:, 1])
    return pairs_moving[rows][meet], i[meet], j[meet]


def _within(low: Array, high: Array, bounds: Array) -> NDArray[np.bool_]:
    """Which triangles overlap bounds (..., 2, 2, n or 1)."""
    near = (low[:, 0] < bounds[..., 1, 0, :]) & (bounds[..., 0, 0, :] < high[:, 0])
    near &= low[:, 1] < bounds[..., 1, 1, :]
    near &= bounds[..., 0, 1, :] < high[:, 1]
    return np.asarray(near)
