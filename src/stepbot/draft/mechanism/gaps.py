"""Connects unconnected clusters: by weaker joints first, then by coaxial surfaces of revolution across a gap.

Two links that are drawn with a gap between them have no contact; faces about one line on both sides of the gap show
that one turns on the other. Such a joint is always a guess.
"""

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Sequence
from enum import StrEnum
from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.draft.contacts.concentric import fitted_circle, symmetric_outline
from stepbot.draft.contacts.freedom import Freedom, FreedomKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.evidence.evidence import ONLY_CONNECTION, JointEvidence, Verdict
from stepbot.draft.mechanism.decide import Decision
from stepbot.draft.parts.axis import SAME_LINE, Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import Array, perpendicular_frame
from stepbot.robot.model import JointKind
from stepbot.step.faces import Face, FaceKind
from stepbot.step.features.coaxial import Rays, coaxial, signed

_SMALLEST_RADIUS = 2e-3
_HALF, _CRADLE = 3.0, 2.0
"""Least angle [rad] that a face of revolution covers, and a bore that only holds a shaft from one side."""
_CIRCLE = 1e-6


class SeamShape(StrEnum):
    """What a face shows by itself."""

    ROUND = "round"
    """A face of revolution that covers at least half of a turn."""
    CRADLE = "cradle"
    """A bore that covers less: it has the axis of a shaft inside it."""
    CENTRED = "centred"
    """A plane with a centre of symmetry, such as a rectangle: it has the axis of a round face on its centre."""


_Outline = tuple[Array, float, SeamShape]


class SeamFace(Struct, frozen=True, eq=False):
    """A face in the assembly, with the line that it is centred on."""

    part: int
    center: Array
    direction: Array
    radius: float
    half: float
    """Half of its length along the axis."""
    shape: SeamShape
    bore: bool


def seam_faces(scene: Scene, parts: Container[int]) -> list[SeamFace]:
    """All such faces of some parts."""
    rows: list[SeamFace] = []
    for kind in (FaceKind.CYLINDER, FaceKind.CONE, FaceKind.TORUS):
        for part in (part for part in scene.parts if part in parts):
            column = scene.columns(part, kind)
            for row, face in enumerate(column.faces):
                shape = _shape(face) if face.radius >= _SMALLEST_RADIUS else None
                if shape is not None:
                    at, direction = column.points[row], column.directions[row]
                    rows.append(SeamFace(part, at, direction, face.radius, 0.5 * face.length, shape, face.bore))
    # The faces of a definition are looked at once.
    known: dict[int, list[tuple[Face, _Outline]]] = {}
    for part in scene.parts:
        if part in parts:
            component = scene.component(part)
            if component.body not in known:
                known[component.body] = _outlines(scene.body(part).faces)
            for face, (center, radius, shape) in known[component.body]:
                at, direction = component.X_WC.apply(center), component.X_WC.turn(face.direction)
                rows.append(SeamFace(part, at, direction, radius, 0.0, shape, bore=False))
    return rows


def _outlines(faces: Iterable[Face]) -> list[tuple[Face, _Outline]]:
    """The planes whose outline shows something."""
    planes = (face for face in faces if face.kind == FaceKind.PLANE and face.rings)
    return [(face, outline) for face in planes if (outline := _outline(face)) is not None]


def _shape(face: Face) -> SeamShape | None:
    """What a face of revolution shows, if anything."""
    if face.span >= _HALF or face.kind == FaceKind.TORUS:
        return SeamShape.ROUND
    is_cradle = face.span >= _CRADLE and face.bore and face.kind == FaceKind.CYLINDER
    return SeamShape.CRADLE if is_cradle else None


def _outline(face: Face) -> _Outline | None:
    """Centre, radius and shape of a plane's outline in the frame of its component; None if it shows nothing."""
    ring = face.rings[0]
    circle, shape = fitted_circle(ring, np.array(face.direction), _CIRCLE), SeamShape.ROUND
    if circle is None:
        circle, shape = symmetric_outline(ring), SeamShape.CENTRED
    if circle is None or circle[1] <= _SMALLEST_RADIUS:
        return None
    return *circle, shape


_WEAKEST = 0.3
"""Score from which a joint may connect otherwise unconnected clusters."""
_SEAM = 6e-3
"""Gap [m] across which faces of two links may still belong to one joint."""
_TEN_MICRONS = 5
"""Decimals of gaps [m]."""
_WIDE = _SEAM + 5e-6
"""The same rounded to the next 10 um: gaps are drawn with errors."""
_FAR = 3e-3
_WIDEST_SHARE = 0.25
"""Share of the assembly's size within which faces on one line are compared."""
_ALIKE = 0.25
"""Ratio of radii below which two faces do not belong to one joint."""
_NEAR_BOX = 3e-3
_PER_PAIR = 4
"""Maximum number of lines offered for one pair of clusters."""
_STACKED = 3
"""Lines with equal faces, the widest, from which two clusters do not turn, as boards with equal capacitors."""
_BUTT, _BAR = 1e-4, 6.0
"""Gap [m] of faces that meet end to end; length of a bar, in widths across its axis."""
_AT_END = "its end meets another part on its axis, as a bar of a frame does"
_TINY = 1e-4
"""Share of the assembly's volume below which a cluster is ignored, if there are many."""


class _Spans:
    """Faces of a cluster on a line, by their positions along it."""

    def __init__(self) -> None:
        self.faces: list[SeamFace] = []
        self.low: list[float] = []
        self.high: list[float] = []

    def add(self, along: float, face: SeamFace) -> None:
        """Add a face whose middle is somewhere along the line."""
        self.faces.append(face)
        self.low.append(along - face.half)
        self.high.append(along + face.half)

    @cached_property
    def lengths(self) -> Array:
        """Shape (4, n) [m]: low, high, radius and half length."""
        return np.array([self.low, self.high, [f.radius for f in self.faces], [f.half for f in self.faces]])

    @cached_property
    def flags(self) -> NDArray[np.bool_]:
        """Shape (3, n): whether faces are round, cradles, bores."""
        shapes = [face.shape for face in self.faces]
        is_round, is_cradle = ([shape == kind for shape in shapes] for kind in (SeamShape.ROUND, SeamShape.CRADLE))
        return np.array([is_round, is_cradle, [face.bore for face in self.faces]])

    def best_with(self, other: "_Spans") -> tuple[float, float, int, int] | None:
        """The pair of faces that best shows that one part turns on the other: not far apart, wide, close.

        Its distance [m] along the line, 0 if they overlap, the smaller radius [m], and the rows of both.
        """
        low, high, radius, half = self.lengths[:, :, None]
        low2, high2, radius2, half2 = other.lengths
        (is_round, is_cradle, is_bore), (is_round2, is_cradle2, is_bore2) = self.flags[:, :, None], other.flags
        gaps = np.maximum(low, low2) - np.minimum(high, high2)
        smaller, larger = np.minimum(radius, radius2), np.maximum(radius, radius2)
        # Of two round faces the other one is the shaft, which a cradle holds.
        shaft, shaft_half = np.where(is_round2, radius2, radius), np.where(is_round2, half2, half)
        shaft_is_bore, held_by = np.where(is_round2, is_bore2, is_bore), np.where(is_round2, radius, radius2)
        play = held_by - shaft
        holds = (play > 0.0) & (play <= _SEAM) & (gaps < 0.0) & (shaft_half > 0.0) & ~shaft_is_bore
        shown = np.where(np.where(is_round2, is_cradle, is_cradle2), holds, smaller >= _ALIKE * larger)
        i, j = np.nonzero(shown & (is_round | is_round2))
        if not len(i):
            return None
        distances, radii = np.maximum(0.0, gaps[i, j]), smaller[i, j]
        best = np.lexsort((distances, -radii, distances > _WIDE))[0]
        return float(distances[best]), float(radii[best]), int(i[best]), int(j[best])


class _Seam(Struct, frozen=True, eq=False):
    """Two faces on one line, of two clusters."""

    radius: float
    gap: float
    a: int
    b: int
    axis: Axis
    meets: bool
    """Whether they meet end to end."""


def tie_by_seams(decision: Decision) -> None:
    """Add joints to clusters that are not connected to the rest."""
    survey, groups = decision.survey, decision.clusters.groups()
    big = {
        root: members
        for root, members in groups.items()
        if len(groups) < 12 or survey.total_volume(members) > _TINY * survey.volume
    }
    tied = Clusters(groups)
    for h in decision.joints:
        tied.join(decision.clusters.find(h.a), decision.clusters.find(h.b))
    if _is_one(tied, big):
        return
    for h in decision.evidence.weaker_joints(_WEAKEST):
        _tie(decision, tied, h, ONLY_CONNECTION)
    if _is_one(tied, big):
        return
    seams = _Seams(decision, big)
    for bar, other in seams.butts():
        if decision.clusters.join(bar, other):
            tied.join(decision.clusters.find(bar), decision.clusters.find(other))
            decision.guess([bar], _AT_END)
    across = seams.joints()
    for h in across:
        decision.evidence.joint(h)
        if tied.find(decision.clusters.find(h.a)) != tied.find(decision.clusters.find(h.b)) and _is_beside_motor(
            decision, h, across
        ):
            smaller = min((h.a, h.b), key=lambda i: decision.survey.total_volume(decision.clusters.members(i)))
            roots, members = (
                (decision.clusters.find(h.a), decision.clusters.find(h.b)),
                decision.clusters.members(smaller),
            )
            if decision.clusters.join(h.a, h.b):
                tied.join(*roots)
                decision.guess(members, "not connected: on the axis of a motor, which turns already")
                continue
        _tie(decision, tied, h, "")


def _is_beside_motor(decision: Decision, h: JointEvidence, across: Sequence[JointEvidence]) -> bool:
    """Whether a joint across a gap repeats that of a motor: one side turns about the same axis on the motor already.

    What is beside both the motor's case and its output may be either's: it is the output's.
    """
    find, sides = decision.clusters.find, {decision.clusters.find(h.a), decision.clusters.find(h.b)}
    for j in decision.joints:
        if not j.drives or not j.axis.same(h.axis, SAME_LINE):
            continue
        case, output = find(j.a), find(j.b)
        if output in sides:
            return True
        beside_output = (sides - {case}) | {output}
        if case in sides and not any({find(k.a), find(k.b)} == beside_output for k in across):
            return True
    return False


def _is_one(tied: Clusters, big: dict[int, list[int]]) -> bool:
    return len({tied.find(root) for root in big}) <= 1


def _tie(decision: Decision, tied: Clusters, h: JointEvidence, note: str) -> None:
    """Accept a joint if it connects unconnected clusters, else offer it."""
    if h.a not in decision.clusters or h.b not in decision.clusters:
        return
    a, b = decision.clusters.find(h.a), decision.clusters.find(h.b)
    if tied.find(a) == tied.find(b):
        h.verdict = Verdict.OFFERED
    elif decision.clusters.forbid(a, b):
        tied.join(a, b)
        h.verdict = Verdict.TAKEN
        h.review = h.review or note


class _Seams:
    """Faces of revolution of clusters, line by line."""

    def __init__(self, decision: Decision, big: dict[int, list[int]]) -> None:
        self._survey, self._big = decision.survey, big
        self._cluster_of = {i: root for root, members in big.items() for i in members if i not in decision.survey.small}
        self._adjacent: dict[tuple[int, int], bool] = {}
        self._between: dict[tuple[int, int], list[_Seam]] = defaultdict(list)
        for pair, seam in self._seams():
            self._between[pair].append(seam)

    def butts(self) -> Iterator[tuple[int, int]]:
        """Long bars, such as tubes of a frame, and the parts of other clusters that their ends meet."""
        for seams in self._between.values():
            for seam in seams:
                for bar, other in ((seam.a, seam.b), (seam.b, seam.a)):
                    if seam.meets and self._is_bar(bar, seam.axis):
                        yield bar, other

    def _is_bar(self, part: int, axis: Axis) -> bool:
        """Whether a part is balanced about an axis, and much longer than wide."""
        if not self._survey.parts[part].is_balanced(axis):
            return False
        spans = (self._survey.scene.span(part, u) for u in perpendicular_frame(axis.d).T)
        *wide, long = (high - low for low, high in spans)
        return long > _BAR * max(wide)

    def joints(self) -> list[JointEvidence]:
        """A joint for each of the best lines between two clusters, the likeliest first."""
        joints = []
        for (one, two), seams in self._between.items():
            seams.sort(key=lambda s: (-round(s.radius, 6), s.gap, s.a, s.b))
            if len(seams) >= _STACKED and seams[_STACKED - 1].radius > seams[0].radius - _CIRCLE:
                continue
            size = min(self._survey.size_of(self._big[one]), self._survey.size_of(self._big[two]))
            is_clear = len(seams) == 1 or seams[1].radius < 0.7 * seams[0].radius
            for n, seam in enumerate(seams[:_PER_PAIR]):
                score = 0.5 + 0.2 * min(1.0, 2.5 * seam.radius / size) + 0.05 * (is_clear and n == 0)
                score -= 0.1 * ((seam.gap > _FAR) + (seam.gap > _SEAM) + (n > 0))
                joints.append(self._joint(seam, score))
        return sorted(joints, key=lambda h: (-round(h.score, 6), h.a, h.b))

    def _joint(self, seam: _Seam, score: float) -> JointEvidence:
        a, b = sorted((seam.a, seam.b))
        free = Freedom(FreedomKind.CYLINDRICAL, 2, seam.axis.point, seam.axis.direction)
        relation = Relation(a, b, (), (), (), free, Via.SEAM, seam.axis, radius=seam.radius)
        why = f"coaxial surfaces of revolution, {seam.gap * 1e3:.1f} mm apart"
        return JointEvidence(score, a, b, JointKind.REVOLUTE, seam.axis, why, relation)

    def _seams(self) -> Iterator[tuple[tuple[int, int], _Seam]]:
        rows = seam_faces(self._survey.scene, self._cluster_of)
        if not rows:
            return
        rays = Rays(np.array([r.center for r in rows]), np.array([r.direction for r in rows]))
        for group in coaxial(rays, *self._survey.slack):
            base, direction = rays.centers[group[0]], signed(rays.directions[group[:1]])[0]
            spans: dict[int, _Spans] = defaultdict(_Spans)
            for k in group.tolist():
                spans[self._cluster_of[rows[k].part]].add(float((rays.centers[k] - base) @ direction), rows[k])
            for one, two in self._near_each_other(spans):
                seam = self._seam(one, two, spans, Axis(base, direction))
                if seam is not None:
                    yield (min(one, two), max(one, two)), seam

    def _near_each_other(self, spans: dict[int, _Spans]) -> Iterator[tuple[int, int]]:
        far = max(_SEAM, _WIDEST_SHARE * self._survey.extent)
        active: list[tuple[float, int]] = []
        for low, high, root in sorted((min(seam.low), max(seam.high), root) for root, seam in spans.items()):
            active = [(end, other) for end, other in active if end >= low - far]
            for _, other in active:
                yield root, other
            active.append((high, root))

    def _seam(self, one: int, two: int, spans: dict[int, _Spans], line: Axis) -> _Seam | None:
        """The two faces with the strongest evidence; a wide gap must have parts of both in between, as in a fork."""
        some, others = spans[one], spans[two]
        best = some.best_with(others)
        if best is None:
            return None
        gap, radius, i, j = best
        at = line.point + line.d * (0.5 * (max(some.low[i], others.low[j]) + min(some.high[i], others.high[j])))
        meets = abs(max(some.low[i], others.low[j]) - min(some.high[i], others.high[j])) < _BUTT
        gap = round(gap, _TEN_MICRONS)  # often drawn as whole millimetres, at which rounding must not decide
        seam = _Seam(radius, gap, some.faces[i].part, others.faces[j].part, Axis(at, line.direction), meets)
        if gap > _SEAM and (gap > 2.0 * radius or not self._touch(one, two)):
            return None
        return seam

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
