"""Finds planes of different parts in contact, and their shared area.

Planes are sorted by direction, then by height, then by their boxes; only then are outlines intersected (Clipper2,
through manifold3d).
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from stepbot.geometry.distinct_rows import distinct_rows
from stepbot.geometry.solids.outlines import Region, Shared
from stepbot.geometry.spatial import Array, perpendicular_frame
from stepbot.step.faces import FaceKind
from stepbot.step.features.coaxial import signed

from .contacts import Contacts, Patch
from .scene import PlacedFace, Scene

GAP = 2e-5
"""Gap [m] up to which two planes touch."""
_SMALLEST = 5e-7
"""Minimum shared area [m^2] of a contact."""
_CELLS = 2000.0
"""Directions are sorted into cells of 1 / 2000, twice: neighbours across a border meet in the shifted cells."""

Indices = Any


def find_patches(scene: Scene, found: Contacts) -> None:
    """Add all shared areas to the contacts."""
    planes = _Planes(scene)
    seen: set[tuple[int, int]] = set()
    for p, q in planes.candidates():
        one, two = (p, q) if planes.rows[p].part < planes.rows[q].part else (q, p)
        if (one, two) not in seen:
            seen.add((one, two))
            patch = planes.patch(one, two)
            if patch is not None:
                found.patches[patch.a, patch.b].append(patch)


class _Planes:
    """All planes of an assembly as arrays."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.rows: list[PlacedFace] = [row for row in scene.faces[FaceKind.PLANE] if row.face.rings]
        nothing = np.zeros(0)
        points, self._normals, self._low, self._high = (
            np.concatenate([nothing, *column]).reshape(-1, 3)
            for column in (
                (r.point for r in self.rows),
                (r.direction for r in self.rows),
                (r.low for r in self.rows),
                (r.high for r in self.rows),
            )
        )
        self._parts = np.array([r.part for r in self.rows], dtype=np.int64)
        self._signed = signed(self._normals) if self.rows else self._normals
        self._heights = np.einsum("ij,ij->i", points, self._signed)
        self._up = np.einsum("ij,ij->i", self._normals, self._signed) > 0.0
        self._regions: dict[tuple[int, bytes], Region] = {}

    def candidates(self) -> Iterator[tuple[int, int]]:
        """Pairs of planes of different parts that face each other at one height and have overlapping boxes."""
        if not self.rows:
            return
        for shift in (0.0, 0.5):
            cells = np.floor(self._signed * _CELLS + shift).astype(np.int64)
            _, kinds = distinct_rows(cells)
            order = np.lexsort((self._heights, kinds))
            begins = np.ones(len(order), dtype=bool)
            begins[1:] = (np.diff(kinds[order]) != 0) | (np.diff(self._heights[order]) > GAP)
            starts = np.flatnonzero(begins)
            levels, ups = np.append(starts, len(order)), np.add.reduceat(self._up[order], starts, dtype=np.int64)
            for n in np.flatnonzero((ups > 0) & (ups < np.diff(levels))).tolist():
                yield from self._facing(order[levels[n] : levels[n + 1]])

    def _facing(self, level: Indices) -> Iterator[tuple[int, int]]:
        up, down = level[self._up[level]], level[~self._up[level]]
        axis = int(np.argmax(np.ptp(self._low[level], axis=0)))
        down = down[np.argsort(self._low[down, axis], kind="stable")]
        starts = self._low[down, axis]
        longest = float((self._high[down, axis] - starts).max())
        first = np.searchsorted(starts, self._low[up, axis] - longest - GAP)
        last = np.searchsorted(starts, self._high[up, axis] + GAP, side="right")
        for p, i, j in zip(up.tolist(), first.tolist(), last.tolist(), strict=True):
            near = down[i:j]
            near = near[
                np.all(self._low[near] <= self._high[p] + GAP, axis=1)
                & np.all(self._low[p] <= self._high[near] + GAP, axis=1)
                & (np.abs(self._heights[near] - self._heights[p]) <= GAP)
                & (self._parts[near] != self._parts[p])
            ]
            for q in near.tolist():
                yield p, q

    def patch(self, p: int, q: int) -> Patch | None:
        """The shared area of two planes; None if it is too small."""
        one, two = self.rows[p], self.rows[q]
        frame = perpendicular_frame(signed(one.direction[None, :])[0])[:, :2]
        shared = self._region(p, frame).shared(self._region(q, frame), _SMALLEST)
        if shared is None:
            return None
        height = one.direction * float(one.point @ one.direction)
        return _patch(one, two, shared, frame, height)

    def _region(self, p: int, frame: Array) -> Region:
        key = p, frame.tobytes()
        if key not in self._regions:
            self._regions[key] = Region([ring @ frame for ring in self._scene.outline(self.rows[p])])
        return self._regions[key]


def _patch(one: PlacedFace, two: PlacedFace, shared: Shared, frame: Array, height: Array) -> Patch:
    rings = tuple(np.concatenate([ring, ring[:1]]) @ frame.T + height for ring in shared.rings)
    return Patch(
        *(one.part, two.part, frame @ shared.centroid + height, one.direction, shared.area),
        *(shared.hull @ frame.T + height, rings),
    )
