"""Finds planes of different parts in contact, and their shared area.

Planes are sorted by direction, then by height, then by their boxes; only then are outlines intersected (Clipper2,
through manifold3d).
"""

from collections.abc import Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.draft.contacts.contacts import Contacts, Patch
from stepbot.draft.parts.scene import Scene, chunks, expanded
from stepbot.geometry.fixed_point import distinct_rows
from stepbot.geometry.solids.outlines import Region
from stepbot.geometry.spatial import Array, perpendicular_frame
from stepbot.step.faces import FaceKind
from stepbot.step.features.coaxial import signed

GAP = 2e-5
"""Gap [m] up to which two planes touch."""
_SMALLEST = 5e-7
"""Minimum shared area [m^2] of a contact."""
_CELLS = 2000.0
"""Directions are sorted into cells of 1 / 2000, twice: neighbours across a border meet in the shifted cells."""

_OPPOSITE = 1.0 - 5e-7
"""Cosine from which two directions are antiparallel: 1 mrad."""
_ROUNDED = 2.0 * GAP
"""The gap [m] with more than what rounding adds to numbers that sort planes."""

Indices = NDArray[np.intp]


class Facing(Struct, frozen=True, eq=False):
    """Two planes that face each other."""

    normal: Array
    """Shape (3,): outward normal of the first part."""
    gap: float
    """[m]."""
    patch: Patch


def find_patches(scene: Scene, contacts: Contacts) -> None:
    """Add all shared areas to the contacts."""
    planes = scene.of_all(Planes)
    part_of = planes.parts.tolist()
    facing = dict.fromkeys((p, q) if part_of[p] < part_of[q] else (q, p) for p, q in planes.candidates())
    placed = dict(scene.shifted(sorted({(part_of[p], part_of[q]) for p, q in facing})))
    known: dict[tuple[bytes, int, int], Patch | None] = {}  # of the first of pairs that are placed likewise
    for p, q in facing:
        a, b = part_of[p], part_of[q]
        key = placed[a, b], p - planes.first(a), q - planes.first(b)
        if key not in known:
            known[key] = patch = planes.patch(p, q)
        else:
            patch = known[key]
            patch = patch and patch.of_others(a, b, scene.shift(patch.a, a))
        if patch is not None:
            contacts.patches[a, b].append(patch)


class Planes:
    """All planes of an assembly as arrays."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        columns = [scene.columns(part, FaceKind.PLANE) for part in scene.parts]
        counts = [len(column.faces) for column in columns]
        nothing = np.zeros((0, 3))
        self.points, self.normals, self._low, self._high = (
            np.concatenate([nothing, *(getattr(column, name) for column in columns)])
            for name in ("points", "directions", "low", "high")
        )
        self._faces = [face for column in columns for face in column.faces]
        self.parts = np.repeat(np.array(scene.parts, dtype=np.int64), counts)
        self._first: dict[int, int] = dict(zip(scene.parts, np.cumsum([0, *counts]).tolist(), strict=False))
        self._signed = signed(self.normals)
        self._heights = np.einsum("ij,ij->i", self.points, self._signed)
        self._up = np.einsum("ij,ij->i", self.normals, self._signed) > 0.0
        self._outlined = np.flatnonzero([bool(face.rings) for face in self._faces])
        outlined = np.bincount(self.parts[self._outlined], minlength=max(scene.parts, default=-1) + 1)
        self._of = np.split(self._outlined, np.cumsum(outlined[:-1]))
        self._regions: dict[tuple[int, bytes], Region] = {}

    def first(self, part: int) -> int:
        """The number of the first plane of a part."""
        return self._first[part]

    def of(self, part: int) -> Indices:
        """The numbers of the planes of a part that have an outline."""
        return self._of[part]

    def facing(
        self, a: int, b: int, reach: float, overlap: float = GAP, opposite: float = _OPPOSITE
    ) -> Iterator[Facing]:
        """Planes of two parts that face each other, up to ``reach`` [m] apart or ``overlap`` in each other."""
        one, two = self.of(a), self.of(b)
        gaps = self.points[two] @ self.normals[one].T - np.einsum("ij,ij->i", self.points[one], self.normals[one])
        near = ((self.normals[two] @ self.normals[one].T) < -opposite) & (gaps > -overlap) & (gaps < reach)
        for m, n in np.argwhere(near).tolist():
            p, q = int(one[n]), int(two[m])
            if (self._low[q] <= self._high[p] + reach).all() and (self._low[p] <= self._high[q] + reach).all():
                patch = self.patch(p, q)
                if patch is not None:
                    yield Facing(self.normals[p], float(gaps[m, n]), patch)

    def candidates(self) -> Iterator[tuple[int, int]]:
        """Pairs of planes of different parts that face each other at one height and have overlapping boxes."""
        if not len(self._outlined):
            return
        for shift in (0.0, 0.5):
            cells = np.floor(self._signed[self._outlined] * _CELLS + shift).astype(np.int64)
            _, kinds = distinct_rows(cells)
            heights = self._heights[self._outlined]
            order = np.lexsort((heights, kinds))
            begins = np.ones(len(order), dtype=bool)
            begins[1:] = (np.diff(kinds[order]) != 0) | (np.diff(heights[order]) > GAP)
            starts = np.flatnonzero(begins)
            ups = np.add.reduceat(self._up[self._outlined][order], starts, dtype=np.int64)
            sizes = np.diff(np.append(starts, len(order)))
            # Most levels have planes that look one way only.
            facing = np.repeat((ups > 0) & (ups < sizes), sizes)
            yield from self._facing(self._outlined[order[facing]], np.cumsum(begins[facing]) - 1)

    def _facing(self, planes: Indices, levels: Indices) -> Iterator[tuple[int, int]]:
        """Pairs of planes, of levels in ascending order, each with planes that look either way."""
        if not len(planes):
            return
        starts = np.flatnonzero(np.diff(levels, prepend=-1))
        low, high = np.minimum.reduceat(self._low[planes], starts), np.maximum.reduceat(self._low[planes], starts)
        axes, is_up = np.argmax(high - low, axis=1), self._up[planes]
        up, up_level, down, down_level = planes[is_up], levels[is_up], planes[~is_up], levels[~is_up]
        order = np.lexsort((self._low[down, axes[down_level]], down_level))
        down, down_level = down[order], down_level[order]
        begins, ends = (np.searchsorted(down_level, np.arange(len(starts)), side=side) for side in ("left", "right"))
        below, above = self._low[down, axes[down_level]], self._high[down, axes[down_level]]
        longest = np.maximum.reduceat(above - below, begins)
        # One number sorts by level, then along its axis; what rounding adds to a range is left out below.
        stride = float(np.ptp(self._low)) + 1.0
        least = float(self._low.min())
        keys, base = down_level * stride + (below - least), up_level * stride - least
        bottom, top = self._low[up, axes[up_level]], self._high[up, axes[up_level]]
        first = np.searchsorted(keys, base + bottom - longest[up_level] - _ROUNDED)
        last = np.searchsorted(keys, base + top + _ROUNDED, side="right")
        first, last = np.maximum(first, begins[up_level]), np.minimum(last, ends[up_level])
        counts = np.maximum(0, last - first)
        for some in chunks(counts):
            runs, offsets = expanded(counts[some])
            rows = some[runs]
            p, q = up[rows], down[first[rows] + offsets]
            near = (np.abs(self._heights[q] - self._heights[p]) <= GAP) & (self.parts[q] != self.parts[p])
            p, q = p[near], q[near]
            near = (self._low[q] <= self._high[p] + GAP).all(axis=1) & (self._low[p] <= self._high[q] + GAP).all(axis=1)
            yield from zip(p[near].tolist(), q[near].tolist(), strict=True)

    def patch(self, p: int, q: int) -> Patch | None:
        """The shared area of two planes; None if it is too small."""
        normal = self.normals[p]
        frame = perpendicular_frame(signed(normal[None, :])[0])[:, :2]
        shared = self._region(p, frame).shared(self._region(q, frame), _SMALLEST)
        if shared is None:
            return None
        height = normal * float(self.points[p] @ normal)
        rings = tuple(np.concatenate([ring, ring[:1]]) @ frame.T + height for ring in shared.rings)
        point = frame @ shared.centroid + height
        other = self.normals[q]
        gap = float((self.points[q] - point) @ other) / float(normal @ other)
        hull = shared.hull @ frame.T + height
        return Patch(int(self.parts[p]), int(self.parts[q]), point, normal, shared.area, hull, rings, other, gap)

    def _region(self, p: int, frame: Array) -> Region:
        key = p, frame.tobytes()
        if key not in self._regions:
            outline = self._scene.outline(int(self.parts[p]), self._faces[p])
            self._regions[key] = Region([ring @ frame for ring in outline])
        return self._regions[key]
