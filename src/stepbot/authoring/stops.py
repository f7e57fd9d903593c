"""Where a joint is stopped: the positions at which parts of its two links meet.

Only a face that looks along the motion can stop it. A face of revolution about the axis, or one that contains the
direction of a slide, passes along itself and stops nothing, so shafts in bores and rails in grooves do not count.
Points of the faces that lead are followed along their circle or line to the faces of the other link that they run
into, and the other way round. Parts that touch in the drawn pose are left out. What is found is a stop of the
meshes: edges that cross may meet a little earlier, and cables, other links or software may stop the joint before.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, cross, perpendicular_frame

from .sweeps import TOUCHING, TOUCHING_ANGLE, Triangles, across, reach, slide, turn

_ALONG = 0.3
"""Cosine of the angle between normal and motion from which a face can stop it."""
_GRID = 3
"""Parts of each edge of a triangle between the points that are followed."""
_WEIGHTS = np.array([(i, k, _GRID - i - k) for i in range(_GRID + 1) for k in range(_GRID + 1 - i)]) / _GRID
_PER_TRIANGLE = len(_WEIGHTS)
_GRAZE = 1.5e-4
"""Distance [m] from its edges that a face must meet another with: twice what coarse meshes are off by."""
_SLACK_ANGLE, _SLACK = 0.05, 1e-3
"""Differences [rad] and [m] up to which a meeting at an edge is that of the face."""
_MOST = 4_000_000
"""Points times triangles that are tried for all joints together."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The mesh of a part in the assembly."""

    part: int
    vertices: Array
    """Shape (n, 3) [m]."""
    faces: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Question:
    """A joint whose stops are looked for."""

    slides: bool
    point: Array
    """On the axis [m]."""
    direction: Array
    """Unit direction of the axis."""
    still: tuple[Shape, ...]
    """Parts of the parent link."""
    moving: tuple[Shape, ...]
    """Parts of the child link."""


@dataclass(frozen=True)
class Stop:
    """A position from the drawn one at which two parts meet."""

    position: float
    """[rad] or [m]; negative against the direction of the axis."""
    still: int
    moving: int


@dataclass(frozen=True)
class Stops:
    """What was found of a joint."""

    found: tuple[Stop, ...]
    """The first stop in either direction, where there is one."""
    skipped: int = 0
    """Pairs of parts that were not compared, because the work is bounded; one of them may stop the joint earlier."""


def find_stops(questions: Sequence[Question]) -> tuple[Stops, ...]:
    """For each joint the first stop in either direction, where one is found.

    The work is bounded: each joint has its share of a fixed number of pairs of points and triangles.
    """
    share = _MOST // max(1, 2 * len(questions))
    return tuple(_stops(question, share) for question in questions)


def _stops(question: Question, share: int) -> Stops:
    touching, least = (TOUCHING, _SLACK) if question.slides else (TOUCHING_ANGLE, 2.0 * _SLACK_ANGLE)
    frame = perpendicular_frame(question.direction)
    still, moving = (
        [
            _Placed(shape.part, (shape.vertices - question.point) @ frame, shape.faces, slides=question.slides)
            for shape in shapes
        ]
        for shapes in (question.still, question.moving)
    )
    still, moving = _within_reach(still, moving), _within_reach(moving, still)
    both, skipped = {}, set[tuple[int, int]]()
    for sign in (-1.0, 1.0):
        ours = [side for placed in still if (side := placed.facing(-sign)) is not None]
        theirs = [side for placed in moving if (side := placed.facing(sign)) is not None]
        both[sign], left = _ways(ours, theirs, sign, share, _Sweep(question.slides, least + 2.0 * touching))
        skipped |= left
    # A pair that leaves the joint no motion at all is a fit with play, and no stop.
    fits = {pair for pair, way in both[1.0].items() if way + both[-1.0].get(pair, np.inf) < least}
    found = []
    for sign, ways in both.items():
        free = [(way, *pair) for pair, way in ways.items() if touching < way < np.inf and pair not in fits]
        if free:
            way, a, b = min(free)
            found.append(Stop(sign * way, a, b))
    return Stops(tuple(found), len(skipped))


@dataclass(frozen=True, eq=False)
class _Side:
    """Triangles of a part that look one way."""

    part: int
    corners: Array
    """Shape (n, 3, 3) [m]."""
    low: Array
    """Shape (n, 2): of each triangle the least of what the motion leaves as it is."""
    high: Array
    """Shape (n, 2), likewise."""

    @cached_property
    def bounds(self) -> Array:
        """Shape (2, 2): the least and the most of all triangles."""
        return np.array([self.low.min(axis=0), self.high.max(axis=0)])

    def near(self, other: "_Side") -> Triangles | None:
        """The triangles that can meet some of another side; None if there is none."""
        rows = ((self.low < other.bounds[1]) & (other.bounds[0] < self.high)).all(axis=1)
        return Triangles(self.corners[rows], self.low[rows], self.high[rows]) if rows.any() else None


class _Placed:
    """A part in a frame whose z axis is that of the joint."""

    def __init__(self, part: int, vertices: Array, faces: NDArray[np.int32], *, slides: bool) -> None:
        self._part, self._vertices, self._faces, self._slides = part, vertices, faces, slides

    @cached_property
    def bounds(self) -> Array:
        """Shape (2, 2): bounds of what the motion leaves as it is, around those of all triangles."""
        low, high = self._vertices.min(axis=0), self._vertices.max(axis=0)
        if self._slides:
            return np.array([low[:2], high[:2]])
        radii = np.linalg.norm(self._vertices[:, :2], axis=1)
        return np.array([[radii.min() - np.linalg.norm(high - low), low[2]], [radii.max(), high[2]]])

    def facing(self, sign: float) -> _Side | None:
        """The triangles whose outside looks along the motion, or against it for a negative sign; None without any."""
        corners, low, high, along, least = self._triangles
        faces = (least > 0.0) & (sign * along > _ALONG * least)
        return _Side(self._part, corners[faces], low[faces], high[faces]) if faces.any() else None

    @cached_property
    def _triangles(self) -> tuple[Array, Array, Array, Array, Array]:
        """Corners, bounds, products of normal and motion, and the product of their lengths."""
        corners = self._vertices[self._faces]
        normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        z = np.array([0.0, 0.0, 1.0])
        motion = np.broadcast_to(z, normals.shape) if self._slides else cross(z[None], corners.mean(axis=1))
        lengths = np.linalg.norm(normals, axis=1) * np.linalg.norm(motion, axis=1)
        low, high = across(corners) if self._slides else reach(corners)
        return corners, low, high, np.einsum("ij,ij->i", normals, motion), lengths


def _within_reach(some: Sequence[_Placed], others: Sequence[_Placed]) -> list[_Placed]:
    """The parts that can meet one of the others, by their bounds."""
    if not some or not others:
        return []
    meet = _overlaps([placed.bounds for placed in some], [placed.bounds for placed in others])
    return [some[k] for k in np.flatnonzero(meet.any(axis=1)).tolist()]


def _overlaps(one: Sequence[Array], two: Sequence[Array]) -> NDArray[np.bool_]:
    """Which of n and m bounds (2, 2) overlap: shape (n, m)."""
    a, b = np.array(one).reshape(-1, 1, 2, 2), np.array(two).reshape(1, -1, 2, 2)
    return np.asarray(((a[:, :, 0] < b[:, :, 1]) & (b[:, :, 0] < a[:, :, 1])).all(axis=2))


def _ways(
    still: Sequence[_Side], moving: Sequence[_Side], sign: float, share: int, sweep: "_Sweep"
) -> tuple[dict[tuple[int, int], float], set[tuple[int, int]]]:
    """For pairs of parts how far the moving one goes until they meet, cheap pairs first; and pairs beyond the share.

    A way is infinite if it is longer than that of a pair that can only be a stop.
    """
    met = _overlaps([side.bounds for side in moving], [side.bounds for side in still])
    pairs = []
    for m, s in np.argwhere(met).tolist():
        ours, theirs = still[s].near(moving[m]), moving[m].near(still[s])
        if ours is not None and theirs is not None:
            work = len(ours.corners) * len(theirs.corners)
            pairs.append((work, ours, theirs, still[s].part, moving[m].part))
    ways, skipped, most = {}, set(), np.inf
    for work, ours, theirs, a, b in sorted(pairs, key=lambda pair: pair[0]):
        share -= 2 * _PER_TRIANGLE * work
        if share < 0:
            skipped.add((a, b))
            continue
        ways[a, b] = sweep.way(ours, theirs, sign, most)
        if ways[a, b] > sweep.least:
            most = min(most, ways[a, b])
    return ways, skipped


@dataclass(frozen=True)
class _Sweep:
    """How triangles are followed."""

    slides: bool
    least: float
    """Way beyond which a pair is no fit with play [rad] or [m]."""

    def way(self, still: Triangles, moving: Triangles, sign: float, most: float) -> float:
        """How far moving triangles go until they meet others; infinite beyond ``most``.

        What only grazes is none: meshes of a shaft and its bore cut into each other.
        """
        exact = self._shortest(still, moving, sign, 0.0, most)
        if exact == np.inf:
            return exact
        slack = _SLACK if self.slides else _SLACK_ANGLE
        inner = self._shortest(still, moving, sign, _GRAZE, most + slack)
        return exact if inner - exact < slack else inner

    def _shortest(self, still: Triangles, moving: Triangles, sign: float, inset: float, most: float) -> float:
        follow = slide if self.slides else turn
        way = follow(_points(moving.corners, inset), still, sign, most)
        return min(way, follow(_points(still.corners, inset), moving, -sign, min(way, most)))


def _points(corners: Array, inset: float) -> Array:
    """Points all over triangles (n, 3, 3), as far from their edges as ``inset`` [m], where they are that large."""
    middles = corners.mean(axis=1, keepdims=True)
    reach = np.linalg.norm(corners - middles, axis=2, keepdims=True)
    inner = corners + (middles - corners) * np.minimum(1.0, 2.0 * inset / np.maximum(reach, 1e-12))
    return np.asarray((_WEIGHTS @ inner).reshape(-1, 3))
