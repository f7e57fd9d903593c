"""Connects unconnected clusters: by weaker joints first, then by coaxial surfaces of revolution across a gap.

Two links that are drawn with a gap between them have no contact; faces about one line on both sides of the gap show
that one turns on the other. Such a joint is always a guess.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from stepbot.robot.model import JointKind
from stepbot.step.features.coaxial import Rays, coaxial, signed

from .axis import Axis
from .clusters import Clusters
from .decision import Decision
from .evidence import ONLY_CONNECTION, Fate, Hinge
from .fits import LINE_ANGLE, LINE_DISTANCE
from .freedom import Freedom, FreedomKind
from .relations import Relation, Via
from .seam_faces import SeamFace, SeamShape, seam_faces

_WEAKEST = 0.3
"""Score from which a joint may connect otherwise unconnected clusters."""
_SEAM = 6e-3
"""Gap [m] across which faces of two links may still belong to one joint."""
_FAR = 3e-3
_WIDEST_SHARE = 0.25
"""Share of the assembly's size within which faces on one line are compared."""
_ALIKE = 0.25
"""Ratio of radii below which two faces do not belong to one joint."""
_NEAR_BOX = 3e-3
_PER_PAIR = 4
"""Maximum number of lines offered for one pair of clusters."""
_TINY = 1e-4
"""Share of the assembly's volume below which a cluster is ignored, if there are many."""


@dataclass(frozen=True, eq=False)
class _Span:
    """A face on a line, by its position along it."""

    low: float
    high: float
    face: SeamFace

    def gap(self, other: "_Span") -> float:
        """Distance [m] along the line; 0 if they overlap."""
        return max(0.0, max(self.low, other.low) - min(self.high, other.high))

    def shows_axis_with(self, other: "_Span") -> bool:
        """Whether two faces together show that one part turns on the other."""
        one, two = self.face, other.face
        if two.shape == SeamShape.ROUND:
            one, two = two, one
        if one.shape != SeamShape.ROUND:
            return False
        if two.shape == SeamShape.CRADLE:
            holds = 0.0 < two.radius - one.radius <= _SEAM and min(self.high, other.high) > max(self.low, other.low)
            return holds and one.half > 0.0 and not one.bore
        small, large = sorted((one.radius, two.radius))
        return small >= _ALIKE * large


@dataclass(frozen=True, eq=False)
class _Seam:
    """Two faces on one line, of two clusters."""

    radius: float
    gap: float
    a: int
    b: int
    axis: Axis


def tie_by_seams(made: Decision) -> None:
    """Add joints to clusters that are not connected to the rest."""
    survey, groups = made.survey, made.clusters.groups()
    big = {
        root: members
        for root, members in groups.items()
        if len(groups) < 12 or survey.total_volume(members) > _TINY * survey.volume
    }
    tied = Clusters(groups)
    for h in made.hinges:
        tied.join(made.clusters.find(h.a), made.clusters.find(h.b))
    if _is_one(tied, big):
        return
    for h in made.evidence.weaker_hinges(_WEAKEST):
        _tie(made, tied, h, ONLY_CONNECTION)
    if _is_one(tied, big):
        return
    for h in _Seams(made, big).hinges():
        made.evidence.hinge(h)
        _tie(made, tied, h, "")


def _is_one(tied: Clusters, big: dict[int, list[int]]) -> bool:
    return len({tied.find(root) for root in big}) <= 1


def _tie(made: Decision, tied: Clusters, h: Hinge, note: str) -> None:
    """Accept a joint if it connects unconnected clusters, else offer it."""
    if h.a not in made.clusters or h.b not in made.clusters:
        return
    a, b = made.clusters.find(h.a), made.clusters.find(h.b)
    if tied.find(a) == tied.find(b):
        h.fate = Fate.OFFERED
    elif made.clusters.forbid(a, b):
        tied.join(a, b)
        h.fate = Fate.TAKEN
        h.review = h.review or note


class _Seams:
    """Faces of revolution of clusters, line by line."""

    def __init__(self, made: Decision, big: dict[int, list[int]]) -> None:
        self._survey, self._big = made.survey, big
        self._cluster_of = {i: root for root, members in big.items() for i in members if i not in made.survey.small}
        self._adjacent: dict[tuple[int, int], bool] = {}

    def hinges(self) -> list[Hinge]:
        """A joint for each of the best lines between two clusters, the likeliest first."""
        between: dict[tuple[int, int], list[_Seam]] = defaultdict(list)
        for pair, seam in self._seams():
            between[pair].append(seam)
        found = []
        for (one, two), seams in between.items():
            seams.sort(key=lambda s: (-round(s.radius, 6), s.gap, s.a, s.b))
            size = min(self._survey.size_of(self._big[one]), self._survey.size_of(self._big[two]))
            is_clear = len(seams) == 1 or seams[1].radius < 0.7 * seams[0].radius
            for n, seam in enumerate(seams[:_PER_PAIR]):
                score = 0.5 + 0.2 * min(1.0, 2.5 * seam.radius / size) + 0.05 * (is_clear and n == 0)
                score -= 0.1 * ((seam.gap > _FAR) + (seam.gap > _SEAM) + (n > 0))
                found.append(self._hinge(seam, min(0.74, score)))
        return sorted(found, key=lambda h: (-round(h.score, 6), h.a, h.b))

    def _hinge(self, seam: _Seam, score: float) -> Hinge:
        a, b = sorted((seam.a, seam.b))
        free = Freedom(FreedomKind.CYLINDRICAL, 2, seam.axis.point, seam.axis.direction)
        relation = Relation(a, b, (), (), (), free, Via.SEAM, seam.axis, radius=seam.radius)
        why = f"coaxial surfaces of revolution, {seam.gap * 1e3:.1f} mm apart"
        return Hinge(score, a, b, JointKind.REVOLUTE, seam.axis, why, relation)

    def _seams(self) -> Iterator[tuple[tuple[int, int], _Seam]]:
        rows = seam_faces(self._survey.scene, self._cluster_of)
        if not rows:
            return
        rays = Rays(np.array([r.center for r in rows]), np.array([r.direction for r in rows]))
        for group in coaxial(rays, LINE_DISTANCE, LINE_ANGLE):
            base, direction = rays.centers[group[0]], signed(rays.directions[group[:1]])[0]
            spans: dict[int, list[_Span]] = defaultdict(list)
            for k in group.tolist():
                along = float((rays.centers[k] - base) @ direction)
                row = rows[k]
                span = _Span(along - row.half, along + row.half, row)
                spans[self._cluster_of[row.part]].append(span)
            for one, two in self._near_each_other(spans):
                seam = self._seam(one, two, spans, Axis(base, direction))
                if seam is not None:
                    yield (min(one, two), max(one, two)), seam

    def _near_each_other(self, spans: dict[int, list[_Span]]) -> Iterator[tuple[int, int]]:
        far = max(_SEAM, _WIDEST_SHARE * self._survey.extent)
        active: list[tuple[float, int]] = []
        for low, high, root in sorted(
            (min(s.low for s in v), max(s.high for s in v), root) for root, v in spans.items()
        ):
            active = [(end, other) for end, other in active if end >= low - far]
            for _, other in active:
                yield root, other
            active.append((high, root))

    def _seam(self, one: int, two: int, spans: dict[int, list[_Span]], line: Axis) -> _Seam | None:
        """The two faces with the strongest evidence; a wide gap must have parts of both in between, as in a fork."""
        best, rank = None, (True, 0.0, np.inf)
        for s, t in product(spans[one], spans[two]):
            gap, radius = s.gap(t), min(s.face.radius, t.face.radius)
            mine = round(gap, 5) > _SEAM, -radius, gap
            if (best is None or mine < rank) and s.shows_axis_with(t):
                at = line.point + line.d * (0.5 * (max(s.low, t.low) + min(s.high, t.high)))
                best, rank = _Seam(radius, gap, s.face.part, t.face.part, Axis(at, line.direction)), mine
        if best is None or (best.gap > _SEAM and (best.gap > 2.0 * best.radius or not self._touch(one, two))):
            return None
        return best

    def _touch(self, one: int, two: int) -> bool:
        """Whether parts of two clusters are close to each other, by their bounding boxes."""
        key = min(one, two), max(one, two)
        if key not in self._adjacent:
            a, b = (
                np.array([self._survey.parts[i].box for i in self._big[n] if self._survey.parts[i].size]) for n in key
            )
            gaps = np.maximum(a[:, None, 0] - b[None, :, 1], b[None, :, 0] - a[:, None, 1])
            self._adjacent[key] = bool((gaps.max(axis=2) <= _NEAR_BOX).any())
        return self._adjacent[key]
