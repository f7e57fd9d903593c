"""Matches the parts of two snapshots.

1. The same path, shape and pose: unchanged.
2. The same shape and pose under another name: renamed, if no other part is in that pose.
3. The same path: moved or changed.
4. The rest, by shape or by pose if there is only one candidate: probably renamed.

A path that depends on ``#n`` alone is compared after the pose, because ``#n`` shifts when the CAD inserts or removes an
equal part. Parts are compared after the motion that all of them have in common.
"""

from collections import Counter
from collections.abc import Callable, Hashable, Iterable
from enum import StrEnum
from itertools import product

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY, Array, Pose, bounds

from .shapes import ANGLE, PLACE, Motion, centroid, motion, moved_words, same_box, same_shape, shape_words
from .snapshot import Part, Shape, Snapshot

_NEAR_MEASURE = 0.02
"""Relative difference of volumes above which shapes are not compared."""
_NEAR = 0.1
"""Distance, as a share of its diagonal, up to which a part of another shape is probably the same part."""
_LIKE = 0.7
"""Ratio of the smaller to the larger volume of such parts."""


class Certainty(StrEnum):
    """Evidence that two parts correspond."""

    PATH = "path"
    CERTAIN = "certain"
    """Shape and place are the same, and there is no other candidate."""
    PROBABLE = "probable"


class Pair(Struct, frozen=True):
    """A part in both snapshots."""

    old: int
    new: int
    certainty: Certainty
    motion: Motion
    is_same_shape: bool


def pair_words(old: Snapshot, new: Snapshot, pair: Pair) -> str:
    """Similarity of two parts: ``same shape, moved by 3 mm``."""
    shape = "same shape" if pair.is_same_shape else shape_words(old.shape_of(pair.old), new.shape_of(pair.new))
    return f"{shape}, {'same pose' if pair.motion.is_none else moved_words(pair.motion)}"


class Match(Struct, frozen=True):
    """The parts of two snapshots, by index."""

    pairs: tuple[Pair, ...]
    """By the index of the old part."""
    removed: tuple[int, ...]
    """Old parts without a new one."""
    added: tuple[int, ...]
    """New parts without an old one."""
    candidates: dict[int, tuple[int, ...]] = field(default_factory=dict)
    """For removed parts the added ones of the same shape, if there are several candidates."""
    common: Pose = IDENTITY
    """The common motion of all parts; the motion of each pair is relative to it."""

    @property
    def is_moved(self) -> bool:
        """Whether the whole assembly has moved."""
        return not _is_identity(self.common)


def match(old: Snapshot, new: Snapshot) -> Match:
    """Match the parts of two snapshots."""
    common = _common_motion(old, new)
    if not _is_identity(common):
        old = replace(old, parts=tuple(_moved(part, common) for part in old.parts))
    else:
        common = IDENTITY
    return _Matching(old, new).result(common)


class _Matching:
    """Two snapshots, and the pairs found so far."""

    def __init__(self, old: Snapshot, new: Snapshot) -> None:
        self._old, self._new = old, new
        classes = _shape_classes((*old.shapes, *new.shapes))
        self._old_class = [classes[part.shape] for part in old.parts]
        self._new_class = [classes[len(old.shapes) + part.shape] for part in new.parts]
        self._pairs: dict[int, Pair] = {}
        self._taken: set[int] = set()
        self._old_paths, self._new_paths = old.index_of, new.index_of
        self._old_centroids, self._new_centroids = _centroids(old), _centroids(new)

    def result(self, common: Pose) -> Match:
        """Pair everything, the strongest evidence first."""
        self._pair_same_path(only_unmoved=True)
        self._pair_same_place()
        self._pair_same_path(only_unmoved=False)
        self._pair_same_shape()
        self._pair_near()
        pairs = tuple(self._pairs[index] for index in sorted(self._pairs))
        return Match(pairs, tuple(self._left_old()), tuple(self._left_new()), self._candidates(), common)

    def _left_old(self) -> list[int]:
        return [index for index in range(len(self._old.parts)) if index not in self._pairs]

    def _left_new(self) -> list[int]:
        return [index for index in range(len(self._new.parts)) if index not in self._taken]

    def _pair(self, i: int, j: int, certainty: Certainty) -> None:
        motion_of_pair = self._motion(i, j)
        is_same = self._old_class[i] == self._new_class[j]
        if motion_of_pair.is_none:  # the boxes of two mirror images at one place differ
            is_same = is_same and same_box(self._old.parts[i], self._new.parts[j])
        self._pairs[i] = Pair(i, j, certainty, motion_of_pair, is_same)
        self._taken.add(j)

    def _motion(self, i: int, j: int) -> Motion:
        old, new = self._old, self._new
        return motion(old.parts[i], old.shape_of(i), new.parts[j], new.shape_of(j))

    def _pair_same_path(self, *, only_unmoved: bool) -> None:
        for i in self._left_old():
            j = self._new_paths.get(self._old.parts[i].path)
            if j is None or j in self._taken:
                continue
            if not only_unmoved or (self._old_class[i] == self._new_class[j] and self._motion(i, j).is_none):
                self._pair(i, j, Certainty.PATH)

    def _pair_same_place(self) -> None:
        """Pair equal shapes at one place, if neither has a name that the other snapshot gives to another part."""
        old_left = [i for i in self._left_old() if self._may_be_renamed(self._old.parts[i], self._new_paths)]
        new_left = [j for j in self._left_new() if self._may_be_renamed(self._new.parts[j], self._old_paths)]
        new_by_class = _grouped(new_left, lambda j: self._new_class[j])
        for key, ours in _grouped(old_left, lambda i: self._old_class[i]).items():
            theirs = new_by_class.get(key, [])
            fits = {i: [j for j in self._within(i, theirs, 2.0 * PLACE) if self._is_at_same_place(i, j)] for i in ours}
            self._pair_only_ones(fits, Certainty.CERTAIN)

    def _pair_only_ones(self, fits: dict[int, list[int]], certainty: Certainty) -> None:
        """Pair parts that are each other's only candidate."""
        claims = Counter(j for several in fits.values() for j in several)
        for i, several in fits.items():
            if len(several) == 1 and claims[several[0]] == 1:
                self._pair(i, several[0], certainty)

    @staticmethod
    def _may_be_renamed(part: Part, others: dict[str, int]) -> bool:
        return part.by_ordinal or part.path not in others

    def _is_at_same_place(self, i: int, j: int) -> bool:
        return self._motion(i, j).is_none and same_box(self._old.parts[i], self._new.parts[j])

    def _pair_same_shape(self) -> None:
        """Pair equal shapes with equal last names, then the only ones of a shape."""
        self._pair_unique(
            lambda i: (self._old_class[i], _last(self._old.parts[i].path)),
            lambda j: (self._new_class[j], _last(self._new.parts[j].path)),
        )
        self._pair_unique(lambda i: self._old_class[i], lambda j: self._new_class[j])

    def _pair_unique(self, old_key: Callable[[int], Hashable], new_key: Callable[[int], Hashable]) -> None:
        ours, theirs = _grouped(self._left_old(), old_key), _grouped(self._left_new(), new_key)
        for key, several in ours.items():
            others = theirs.get(key, [])
            if len(several) == len(others) == 1:
                self._pair(several[0], others[0], Certainty.PROBABLE)

    def _pair_near(self) -> None:
        """Pair parts of nearly the same size and place without other candidates."""
        ours, theirs = self._left_old(), self._left_new()
        widest = max((self._new.parts[j].diagonal for j in theirs), default=0.0)
        fits = {}
        for i in ours:
            reach = _NEAR * max(widest, self._old.parts[i].diagonal)
            fits[i] = [j for j in self._within(i, theirs, reach) if self._is_like(i, j)]
        self._pair_only_ones(fits, Certainty.PROBABLE)

    def _is_like(self, i: int, j: int) -> bool:
        a, b = self._old.shape_of(i), self._new.shape_of(j)
        smaller, larger = sorted((a.measure, b.measure))
        if a.basis != b.basis or not larger > 0.0 or smaller < _LIKE * larger:
            return False
        size = max(self._old.parts[i].diagonal, self._new.parts[j].diagonal)
        return float(np.linalg.norm(self._old_centroids[i] - self._new_centroids[j])) <= _NEAR * size

    def _candidates(self) -> dict[int, tuple[int, ...]]:
        theirs = _grouped(self._left_new(), lambda j: self._new_class[j])
        return {i: tuple(theirs[self._old_class[i]]) for i in self._left_old() if self._old_class[i] in theirs}

    def _within(self, i: int, theirs: list[int], reach: float) -> list[int]:
        """New parts whose centroids are within a distance [m] of an old part's."""
        if not theirs:
            return []
        distances = np.linalg.norm(self._new_centroids[theirs] - self._old_centroids[i], axis=1)
        return [theirs[k] for k in np.flatnonzero(distances <= reach).tolist()]


def _centroids(snapshot: Snapshot) -> Array:
    """Centroids (n, 3) [m] of all parts."""
    centroids = [centroid(part, snapshot.shape_of(index)) for index, part in enumerate(snapshot.parts)]
    return np.array(centroids).reshape(-1, 3)


def _grouped(indices: Iterable[int], key: Callable[[int], Hashable]) -> dict[Hashable, list[int]]:
    groups: dict[Hashable, list[int]] = {}
    for index in indices:
        groups.setdefault(key(index), []).append(index)
    return groups


def _last(path: str) -> str:
    return path.rpartition("/")[2]


def _shape_classes(shapes: tuple[Shape, ...]) -> list[int]:
    """For each shape the number of the first equal one."""
    classes = list(range(len(shapes)))
    order = sorted(range(len(shapes)), key=lambda index: (shapes[index].measure, index))
    for place, index in enumerate(order):
        for other in reversed(order[:place]):
            if shapes[other].measure < (1.0 - _NEAR_MEASURE) * shapes[index].measure:
                break
            if classes[other] == other and same_shape(shapes[other], shapes[index]):
                classes[index] = other
                break
    return classes


def _common_motion(old: Snapshot, new: Snapshot) -> Pose:
    """The motion of all parts with the same path and shape; none if one has not moved, or differently."""
    new_paths, common = new.index_of, None
    for i, part in enumerate(old.parts):
        j = new_paths.get(part.path)
        if j is None or not same_shape(old.shape_of(i), new.shape_of(j)):
            continue
        moved = motion(part, old.shape_of(i), new.parts[j], new.shape_of(j))
        if moved.is_none or moved.X_WW is None:
            return IDENTITY
        if part.by_ordinal:
            continue  # it may be another one
        if common is not None and not _equal(common, moved.X_WW):
            return IDENTITY
        common = common or moved.X_WW
    return common or IDENTITY


def _equal(a: Pose, b: Pose) -> bool:
    distance, angle = a.distance_to(b)
    return distance <= 2.0 * PLACE and angle <= ANGLE


def _is_identity(pose: Pose) -> bool:
    return _equal(pose, IDENTITY)


def _moved(part: Part, X_WW: Pose) -> Part:
    X_WC = X_WW @ part.X_WC
    corners = np.array(list(product(*zip(*part.box, strict=True))))
    return replace(part, position=X_WC.position, rotation=X_WC.rotation, box=bounds(X_WW.apply(corners)))
