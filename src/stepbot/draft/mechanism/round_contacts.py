"""Joints at lone round contacts.

Where all that connects two groups of parts is contacts about one axis, nothing but friction or glue keeps them from
turning on each other. If the mass of neither is symmetric about the axis, as that of a lid, a foot or a knob is, such a
contact is probably a joint: the seam between two shells of an arm, with or without a seal in it.

The stand of a robot is often symmetric about the first axis, as a lid is. Where the whole assembly stands on such a
body alone, and what it carries has another joint, one of the round contacts between both is probably a joint, too.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.concentric import has_free_circle
from stepbot.draft.contacts.contacts import Pair
from stepbot.draft.contacts.relations import Relation, Via, reach
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import SURE
from stepbot.draft.evidence.evidence import JointEvidence, Verdict
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.evidence.wheels import Feet
from stepbot.draft.mechanism.decide import Decision
from stepbot.draft.mechanism.locked import JointKey
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.parts import Part, whole
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.robot.model import JointKind

_REVIEW = "nothing but one round contact holds its two sides together"
"""What to review of such a joint."""
_REVIEW_FLANGE = "a disc with a circle of holes for a tool at the end of a chain: it may be fixed"
_REVIEW_STAND = "only round contacts connect the stand: it may turn at another one of them, or not at all"
_PIVOTS = (Via.FACE, Via.BOLT, Via.PIN)
"""Contacts that may be such a joint, pins in whole bores: others are found without this."""
_LEAST = 0.01
"""Share of the assembly's volume below which a side of a pivot is a handle, a pin or a cover."""
_FLANGE = 5e-4
"""Share of the assembly's volume from which a disc is a tool flange, not a washer; a stand may have such holes, too."""
_STAND = 0.05
"""Share of the assembly's volume from which what is symmetric about its joint may be a stand, not a cap or a pin."""
_WIDER = 1.2
"""Ratio of the radii of a stand's foot and of the contact above it: what overhangs needs a wide foot, unlike a cap."""
_LID = 0.3
"""Share of the smaller of two sides up to which a third one on their axis is none."""
_OBLONG = 0.1
"""Difference of the moments of inertia across an axis, as a share of that about it, from which a side is lopsided."""
_CLEARLY = 2.0
"""Multiple of the tolerances of a turned part beyond which a side is lopsided: a lid with a handle is not."""


class _Pivot(Struct, frozen=True, eq=False):
    """Relations of parts of one cluster about one axis."""

    axis: Axis
    relations: list[Relation]


def lone_pivots(decision: Decision, structure: Structure) -> dict[JointKey, str]:
    """The joints at lone round contacts within clusters, and what to review of each."""
    survey, ties, feet = decision.survey, _ties(decision), Feet(decision.survey)
    driven, turning = defaultdict[int, list[Axis]](list), defaultdict[int, list[JointEvidence]](list)
    jointed = set[int]()
    for h in decision.joints:
        jointed |= {decision.clusters.find(h.a), decision.clusters.find(h.b)}
        if h.drives:
            driven[decision.clusters.find(h.a)].append(h.axis)
        if h.type == JointKind.REVOLUTE:
            turning[h.a].append(h)
            turning[h.b].append(h)
    reviews: dict[Pair, str] = {}
    held = {(w.a, w.b) for w in decision.evidence.welds if w.verdict == Verdict.TAKEN and w.score >= SURE}
    for root, members in decision.clusters.groups().items():
        # What is around the output of a motor in it, such as a plate with a hole for the shaft, is no side of a pivot.
        outputs = driven[root]
        every = (p for p in _pivots(survey, structure, held, members) if not any(p.axis.same(axis) for axis in outputs))
        pivots = [_Sides(survey, pivot, members, ties[root]) for pivot in every]
        between = [
            pair for sides in pivots if (pair := sides.between_lopsided()) and not sides.share_line(decision, turning)
        ]
        reviews |= dict.fromkeys(between, _REVIEW)
        if between or root in jointed:
            below = [pair for sides in pivots if (pair := sides.above_stand(feet)) is not None]
            reviews |= dict.fromkeys(below, _REVIEW_STAND)
            ends = [pair for sides in pivots if (pair := sides.below_flange()) is not None]
            reviews |= dict.fromkeys(ends, _REVIEW_FLANGE)
    hinges = {(h.a, h.b): h for h in decision.evidence.joints if h.relation is not None and h.verdict != Verdict.TAKEN}
    return {(*pair, str(hinges[pair].type)): review for pair, review in reviews.items() if pair in hinges}


def _ties(decision: Decision) -> dict[int, list[tuple[int, int]]]:
    """For each cluster its pairs of parts that are welded, or that one screw fits in."""
    ties: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for weld in decision.evidence.welds:
        if weld.verdict == Verdict.TAKEN:
            ties[decision.clusters.find(weld.a)].append((weld.a, weld.b))
    for screw in decision.survey.small:
        hosts = [other for other, r in decision.survey.around(screw) if r.fits]
        for a, b in pairwise(hosts):
            if decision.clusters.find(a) == decision.clusters.find(b):
                ties[decision.clusters.find(a)].append((a, b))
    return ties


def _pivots(survey: Survey, structure: Structure, held: set[Pair], members: Sequence[int]) -> Iterator[_Pivot]:
    """The axes that parts of a cluster touch each other about, where neither a screw clamps nor a weld holds them."""
    inside, pivots = set(members), list[_Pivot]()
    for i in members:
        for r in survey.near.get(i, ()):
            axis = r.turns
            is_within = r.a == i and r.b in inside and not structure.are_together(r.a, r.b)
            is_within &= (r.a, r.b) not in held
            if not is_within or r.via not in _PIVOTS or axis is None or not all(fit.full for fit in r.shafts):
                continue
            same = next((pivot for pivot in pivots if pivot.axis.same(axis)), None)
            if same is None:
                pivots.append(_Pivot(axis, [r]))
            else:
                same.relations.append(r)
    return (pivot for pivot in pivots if not survey.has_screw_at(pivot.axis))


class _Sides:
    """The groups of parts that nothing but the contacts of a pivot connects."""

    def __init__(self, survey: Survey, pivot: _Pivot, members: Sequence[int], ties: Sequence[tuple[int, int]]) -> None:
        self._survey, self._pivot, self._members = survey, pivot, members
        about = {(r.a, r.b) for r in pivot.relations}
        self._groups = Clusters(members)
        for a, b in ties:
            if (a, b) not in about:
                self._groups.join(a, b)
        groups = self._groups.groups().items()
        lopsided = {root: parts for root, parts in groups if _is_lopsided(survey, parts, pivot.axis)}
        sizes = {root: survey.total_volume(parts) for root, parts in lopsided.items()}
        # What is small beside both is a motor or a lid on one of them.
        least = _LID * sorted([0.0, 0.0, *sizes.values()])[-2]
        self._lopsided = [root for root, size in sizes.items() if size > least]

    def between_lopsided(self) -> Pair | None:
        """The joint between two lopsided sides, if there are two."""
        return self._weakest(*self._lopsided)[0] if len(self._lopsided) == 2 else None

    def share_line(self, decision: Decision, turning: Mapping[int, Sequence[JointEvidence]]) -> bool:
        """Whether two lopsided sides turn about one other line, on the same body: a bar between them moves neither.

        Args:
            turning: The accepted hinges of each part.
        """
        lines: list[list[tuple[Axis, int]]] = []
        for root in self._lopsided:
            inside = set(self._groups.members(root))
            out = (h for i in inside for h in turning.get(i, ()) if len(inside & {h.a, h.b}) == 1)
            lines.append([(h.axis, decision.clusters.find(h.b if h.a in inside else h.a)) for h in out])
        one, *others = lines or [[]]
        return any(
            body == other and axis.same(line) and line.is_along(self._pivot.axis.d)
            for axis, body in one
            for line, other in (others[0] if len(others) == 1 else ())
        )

    def above_stand(self, feet: Feet) -> Pair | None:
        """The joint between the only lopsided side and the stand that it is on, if there is one."""
        if len(self._lopsided) != 1:
            return None
        (above,) = self._lopsided
        for foot, width in feet.below(self._groups, self._pivot.axis):
            pair, stand = self._weakest(above, foot)
            if pair is None or self._survey.total_volume(stand) < _STAND * self._survey.volume:
                continue
            if width > _WIDER * reach(self._pivot.axis, [self._survey.relations[pair]]):
                return pair
        return None

    def below_flange(self) -> Pair | None:
        """The joint between a lopsided side and one part with a circle of holes for a tool that it carries."""
        if not self._lopsided:
            return None
        for r in self._pivot.relations:
            for part in (r.a, r.b):
                others = [other for other, _ in self._survey.around(part) if other != r.other(part)]
                share = self._survey.parts[part].volume / self._survey.volume
                if self._groups.members(part) != [part] or others or not _FLANGE < share < _STAND:
                    continue
                is_disc = r.via == Via.FACE and self._survey.parts[part].is_balanced(self._pivot.axis)
                if is_disc and has_free_circle(self._survey.contacts.lines, [part], self._pivot.axis):
                    return r.a, r.b
        return None

    def _weakest(self, one: int, two: int) -> tuple[Pair | None, list[int]]:
        """Of the contacts between two sides the one with the least area, and the parts on the second's side of it.

        What lies between them, such as a seal, goes with one of them.
        """
        chain = Clusters(self._members)
        for group in self._groups.groups().values():
            for i in group:
                chain.join(group[0], i)
        for r in sorted(self._pivot.relations, key=lambda r: (-round(r.area, 9), r.a, r.b)):
            if {chain.find(r.a), chain.find(r.b)} == {chain.find(one), chain.find(two)} and one != two:
                return (r.a, r.b), chain.members(two)
            chain.join(r.a, r.b)
        return None, []


def _is_lopsided(survey: Survey, members: Sequence[int], axis: Axis) -> bool:
    """Whether the mass of parts is considerable and not symmetric about an axis."""
    body = whole([survey.parts[i] for i in members if survey.parts[i].volume])
    if body is None or body.volume <= _LEAST * survey.volume:
        return False
    return not body.is_balanced(axis, _CLEARLY) or _is_oblong(body, axis)


def _is_oblong(body: Part, axis: Axis) -> bool:
    """Whether a body is wider in one direction across an axis than in the other: a fork at the end of a long tube."""
    across = perpendicular_frame(axis.d)
    moments = np.diag(across.T @ body.inertia @ across)
    (a, b), c = moments[:2], float(across[:, 0] @ body.inertia @ across[:, 1])
    return float(np.hypot(a - b, 2.0 * c)) > _OBLONG * float(moments[2])
