"""Where a joint is stopped: the positions at which parts of its two links meet.

Only a face that looks along the motion can stop it. A face of revolution about the axis, or one that contains the
direction of a slide, passes along itself and stops nothing, so shafts in bores and rails in grooves do not count.
Points of the faces that lead are followed along their circle or line to the faces of the other link that they run
into, and the other way round. Parts that touch in the drawn pose are left out. What is found is a stop of the
meshes: edges that cross may meet a little earlier, and cables, other links or software may stop the joint before.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, cross, perpendicular_frame

_ALONG = 0.3
"""Cosine of the angle between normal and motion from which a face can stop it."""
_TOUCHING_ANGLE, _TOUCHING = 2e-3, 1e-5
"""Distances [rad] and [m] within which parts touch in the drawn pose."""
_GRID = 3
"""Parts of each edge of a triangle between the points that are followed."""
_WEIGHTS = np.array([(i, k, _GRID - i - k) for i in range(_GRID + 1) for k in range(_GRID + 1 - i)]) / _GRID
_PER_TRIANGLE = len(_WEIGHTS)
_GRAZE = 1.5e-4
"""Distance [m] from its edges that a face must meet another with: twice what coarse meshes are off by."""
_SLACK_ANGLE, _SLACK = 0.05, 1e-3
"""Differences [rad] and [m] up to which a meeting at an edge is that of the face."""
_INSIDE = 1e-9
_MOST = 4_000_000
"""Points times triangles that are tried for all joints together."""
_CHUNK = 1_000_000
_MARGIN = 1e-6
"""Distance [m] from a triangle's bounds within which a point is tried."""

Indices = NDArray[np.int64]


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


@dataclass(frozen=True, eq=False)
class _Side:
    """Triangles of a part that look one way, in a frame whose z axis is that of the joint."""

    part: int
    corners: Array
    """Shape (n, 3, 3) [m]."""
    low: Array
    """Shape (n, 2): of each triangle the least of what the motion leaves as it is."""
    high: Array
    """Shape (n, 2), likewise."""

    @cached_property
    def least(self) -> Array:
        """Shape (2,): the least of all triangles."""
        return np.asarray(self.low.min(axis=0))

    @cached_property
    def most(self) -> Array:
        """Shape (2,): the most of all triangles."""
        return np.asarray(self.high.max(axis=0))


def _stops(question: Question, share: int) -> Stops:
    touching, least = (_TOUCHING, _SLACK) if question.slides else (_TOUCHING_ANGLE, 2.0 * _SLACK_ANGLE)
    both, skipped = {}, set[tuple[int, int]]()
    for sign in (-1.0, 1.0):
        still = [side for shape in question.still if (side := _facing(question, shape, -sign)) is not None]
        moving = [side for shape in question.moving if (side := _facing(question, shape, sign)) is not None]
        both[sign], left = _ways(still, moving, sign, share, slides=question.slides)
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


def _ways(
    still: Sequence[_Side], moving: Sequence[_Side], sign: float, share: int, *, slides: bool
) -> tuple[dict[tuple[int, int], float], set[tuple[int, int]]]:
    """For pairs of parts how far the moving one goes until they meet, cheap pairs first; and pairs beyond the share."""
    pairs = [(*_near(a, b), a.part, b.part) for b in moving for a in still if _can_meet(a, b)]
    ways, skipped = {}, set()
    for ours, theirs, a, b in sorted(pairs, key=lambda pair: len(pair[0]) * len(pair[1])):
        share -= 2 * _PER_TRIANGLE * len(ours) * len(theirs)
        if share < 0:
            skipped.add((a, b))
        elif len(ours) and len(theirs):
            ways[a, b] = _way(ours, theirs, sign, slides=slides)
    return ways, skipped


def _way(still: Array, moving: Array, sign: float, *, slides: bool) -> float:
    """How far moving triangles go until they meet others.

    What only grazes is none: meshes of a shaft and its bore cut into each other.
    """
    follow = _slides if slides else _turns
    exact, inner = (
        min(follow(_points(moving, inset), still, sign), follow(_points(still, inset), moving, -sign))
        for inset in (0.0, _GRAZE)
    )
    return exact if inner - exact < (_SLACK if slides else _SLACK_ANGLE) else inner


def _facing(question: Question, shape: Shape, sign: float) -> _Side | None:
    """The triangles whose outside looks along the motion, or against it for a negative sign; None without any."""
    frame = perpendicular_frame(question.direction)
    corners = ((shape.vertices - question.point) @ frame)[shape.faces]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    z = np.array([0.0, 0.0, 1.0])
    motion = np.broadcast_to(z, normals.shape) if question.slides else cross(z[None], corners.mean(axis=1))
    lengths = np.linalg.norm(normals, axis=1) * np.linalg.norm(motion, axis=1)
    faces = (lengths > 0.0) & (sign * np.einsum("ij,ij->i", normals, motion) > _ALONG * lengths)
    if not faces.any():
        return None
    corners = corners[faces]
    if question.slides:
        return _Side(shape.part, corners, corners[..., :2].min(axis=1), corners[..., :2].max(axis=1))
    return _Side(shape.part, corners, *_reach(corners))


def _can_meet(a: _Side, b: _Side) -> bool:
    """Whether what the motion leaves as it is overlaps: height and distance from the axis, or the place across."""
    return bool((a.least < b.most).all() and (b.least < a.most).all())


def _near(a: _Side, b: _Side) -> tuple[Array, Array]:
    """The triangles of two sides that can meet some of the other's."""
    ours = ((a.low < b.most) & (b.least < a.high)).all(axis=1)
    theirs = ((b.low < a.most) & (a.least < b.high)).all(axis=1)
    return a.corners[ours], b.corners[theirs]


def _points(corners: Array, inset: float) -> Array:
    """Points all over triangles (n, 3, 3), as far from their edges as ``inset`` [m], where they are that large."""
    middles = corners.mean(axis=1, keepdims=True)
    reach = np.linalg.norm(corners - middles, axis=2, keepdims=True)
    inner = corners + (middles - corners) * np.minimum(1.0, 2.0 * inset / np.maximum(reach, 1e-12))
    return np.asarray((_WEIGHTS @ inner).reshape(-1, 3))


def _slides(points: Array, corners: Array, sign: float) -> float:
    """The shortest way [m] of points (n, 3) along z, or against it, to triangles (m, 3, 3)."""
    triangles, best = _Triangles(corners), np.inf
    places = points[:, :2]
    low, high = corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)
    for i, j in _candidates(places, low, high):
        normals = triangles.normals[j]
        with np.errstate(divide="ignore", invalid="ignore"):
            height = (triangles.offsets[j] - np.einsum("ij,ij->i", places[i], normals[:, :2])) / normals[:, 2]
        at = np.column_stack([places[i], height])
        way = np.where(triangles.contain(at, j), sign * (height - points[i, 2]), np.inf)
        best = min(best, float(np.where(way >= -_TOUCHING, way, np.inf).min(initial=np.inf)))
    return best


def _turns(points: Array, corners: Array, sign: float) -> float:
    """The smallest angle [rad] of points (n, 3) about z, or against it, to triangles (m, 3, 3)."""
    triangles, best = _Triangles(corners), np.inf
    radii, angles = np.linalg.norm(points[:, :2], axis=1), np.arctan2(points[:, 1], points[:, 0])
    low, high = _reach(corners)
    slopes = np.hypot(triangles.normals[:, 0], triangles.normals[:, 1])
    headings = np.arctan2(triangles.normals[:, 1], triangles.normals[:, 0])
    for i, j in _candidates(np.column_stack([radii, points[:, 2]]), low, high):
        with np.errstate(divide="ignore", invalid="ignore"):
            cosines = (triangles.offsets[j] - points[i, 2] * triangles.normals[j, 2]) / (radii[i] * slopes[j])
        half = np.arccos(np.where(np.abs(cosines) <= 1.0, cosines, np.nan))
        for other in (half, -half):
            at_angle = headings[j] + other
            at = np.column_stack([radii[i] * np.cos(at_angle), radii[i] * np.sin(at_angle), points[i, 2]])
            way = (sign * (at_angle - angles[i]) + _TOUCHING_ANGLE) % (2.0 * pi) - _TOUCHING_ANGLE
            best = min(best, float(np.where(triangles.contain(at, j), way, np.inf).min(initial=np.inf)))
    return best


def _reach(corners: Array) -> tuple[Array, Array]:
    """Bounds (n, 2) of triangles (n, 3, 3) in distance from z and in height."""
    heights, radii = corners[..., 2], np.linalg.norm(corners[..., :2], axis=2)
    # A triangle comes nearer to the axis than its corners: by no more than its longest edge.
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    low = np.column_stack([radii.min(axis=1) - edges, heights.min(axis=1)])
    return low, np.column_stack([radii.max(axis=1), heights.max(axis=1)])


def _candidates(places: Array, low: Array, high: Array) -> Iterator[tuple[Indices, Indices]]:
    """Indices of points and of triangles, in chunks: pairs where the motion can take the point into the triangle.

    Args:
        places: Shape (n, 2): of each point what the motion leaves as it is.
        low: Shape (m, 2): the least of it of each triangle.
        high: Shape (m, 2): the most of it.
    """
    rows = max(1, _CHUNK // len(low))
    for start in range(0, len(places), rows):
        some = places[start : start + rows, None]
        i, j = np.nonzero(((some >= low - _MARGIN) & (some <= high + _MARGIN)).all(axis=2))
        if len(i):
            yield i + start, j


class _Triangles:
    """Triangles (n, 3, 3) with what does not depend on the points."""

    def __init__(self, corners: Array) -> None:
        self._first = corners[:, 0]
        self._u, self._v = corners[:, 1] - self._first, corners[:, 2] - self._first
        self.normals = cross(self._u, self._v)
        self.offsets = np.einsum("ij,ij->i", self.normals, self._first)
        self._sizes = np.einsum("ij,ij->i", self.normals, self.normals)

    def contain(self, points: Array, j: Indices) -> NDArray[np.bool_]:
        """For points (k, 3), each in the plane of the triangle with an index (k,), whether it is in the triangle."""
        w, normals, sizes = points - self._first[j], self.normals[j], self._sizes[j]
        with np.errstate(invalid="ignore"):
            s = np.einsum("ij,ij->i", cross(w, self._v[j]), normals) / sizes
            t = np.einsum("ij,ij->i", cross(self._u[j], w), normals) / sizes
            return np.asarray((s >= -_INSIDE) & (t >= -_INSIDE) & (s + t <= 1.0 + _INSIDE))
