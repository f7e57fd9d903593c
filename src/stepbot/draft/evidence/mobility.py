"""The mobility of a linkage: which of its hinges can turn or slide, and which of its bodies move with each other."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct

from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.geometry.spatial import Array, cross_matrix, perpendicular_frame

MOST = 150
"""Number of bodies of one linkage up to which its mobility is computed."""
_NULL = 1e-4
_METRES = 10.0
"""Twists are in decimetres, so that rotations and translations have similar magnitudes."""


class Hinge(Struct, frozen=True, eq=False):
    """A line between two bodies, given by a part of each."""

    axis: Axis
    a: int
    b: int
    is_extra: bool = False
    """Whether other pairs on the same line already connect its sides; it keeps them from being one."""
    slides: bool = False
    """Whether faces guide its sides along the line instead."""
    is_uncertain: bool = False
    """Whether the only evidence for it is a loop that could move: across a gap, or at a stop."""


class Mobility(Struct, frozen=True):
    """Which of some hinges can turn."""

    turning: set[int]
    looped: set[int]
    """Those of them that are in loops."""
    apart: list[tuple[int, int]]
    """Bodies of loops that move relative to each other: they are not one, whatever touches what."""


def mobility(hinges: Sequence[Hinge], bodies: Clusters) -> Mobility | None:
    """What can move if these hinges alone hold the bodies on them, the parts of which are united; None if too many."""
    ends = [(bodies.find(h.a), bodies.find(h.b)) for h in hinges]
    moving = sorted({body for pair in ends for body in pair})
    looped = _in_loops(ends, moving)
    if not looped:
        return Mobility(set(range(len(hinges))), set(), [])
    if len(moving) > MOST:
        return None
    number = {body: n for n, body in enumerate(moving)}
    rows, turns = [], []
    for h, (one, two) in zip(hinges, ends, strict=True):
        a, b = number[one], number[two]
        rows.append(_held(h, a, b, len(moving)))
        turn, at = np.zeros(6 * len(moving)), 3 * h.slides
        turn[6 * a + at : 6 * a + at + 3], turn[6 * b + at : 6 * b + at + 3] = h.axis.d, -h.axis.d
        turns.append(turn)
    still = np.eye(6, 6 * len(moving))
    _, values, basis = np.linalg.svd(np.concatenate([still, *rows]), full_matrices=True)
    free = basis[int((values > _NULL).sum()) :]
    moves = np.abs(np.array(turns) @ free.T).max(axis=1, initial=0.0) > _NULL
    turning = set(np.flatnonzero(moves).tolist())
    tied = Clusters(moving)
    for n in looped & turning:
        tied.join(*ends[n])
    # What no loop connects may rest on one body, as the brackets at both ends of a chain.
    pairs = _moving_pairs(moving, free) if looped & turning else []
    apart = [(a, b) for a, b in pairs if tied.find(a) == tied.find(b)]
    return Mobility(turning, looped & turning, apart)


def _in_loops(ends: Sequence[tuple[int, int]], bodies: Sequence[int]) -> set[int]:
    """Hinges whose bodies stay connected without them."""
    in_loops = set()
    for n, (one, two) in enumerate(ends):
        tied = Clusters(bodies)
        for m, (a, b) in enumerate(ends):
            if m != n:
                tied.join(a, b)
        if tied.find(one) == tied.find(two):
            in_loops.add(n)
    return in_loops


def _moving_pairs(bodies: Sequence[int], free: Array) -> list[tuple[int, int]]:
    """Bodies, in ascending order, that move relative to each other by some free twists (k, 6 n)."""
    twists = free.reshape(-1, len(bodies), 6)
    return [
        (bodies[n], bodies[m])
        for n, m in combinations(range(len(bodies)), 2)
        if float(np.abs(twists[:, n] - twists[:, m]).max(initial=0.0)) > _NULL
    ]


def _held(h: Hinge, a: int, b: int, count: int) -> Array:
    """Rows (5, 6 n) that a joint keeps from moving: twists (w, v) of bodies, v of what is at the origin [dm/s]."""
    rows = np.zeros((5, 6 * count))
    across = perpendicular_frame(h.axis.d)[:, :2].T
    at = -cross_matrix(h.axis.point * _METRES)
    for body, sign in ((a, 1.0), (b, -1.0)):
        if h.slides:
            rows[:3, 6 * body : 6 * body + 3] = sign * np.eye(3)
            rows[3:, 6 * body + 3 : 6 * body + 6] = sign * across
            continue
        rows[:2, 6 * body : 6 * body + 3] = sign * across
        rows[2:, 6 * body : 6 * body + 3] = sign * at
        rows[2:, 6 * body + 3 : 6 * body + 6] = sign * np.eye(3)
    return rows
