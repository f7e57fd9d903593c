"""Decides from the evidence which parts move as one, the strongest evidence first.

A weld joins two clusters unless there is already a joint between them; a joint keeps its sides apart unless they are
already joined. Fasteners do not join clusters: they are assigned to their tightest host at the end.
"""

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import Struct, field

from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence.evidence import BY_SHAPE, Apart, Evidence, JointEvidence, Priority, Verdict, Weld
from stepbot.draft.evidence.fingers import centroid, direction_between
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.parts.axis import SAME_LINE, Axis, are_parallel
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Boxes, largest
from stepbot.robot.model import JointKind

_TINY = 2e-3
"""Share of the assembly's volume below which an unconnected cluster does not become a link."""
_OFFERED = 0.3
_OWN_BODIES = 0.5
"""Share of a motor's volume up to which what is welded to it is its own bodies, such as its plug, and no support, and
what is welded to its output is its horn.
"""
_BESIDE = 1e-3
"""Distance [m] up to which a body is beside the output of a motor."""
_REVIEW_BESIDE = "what the motor turns is only drawn beside its output"
_OUT = 1e-3
"""Distance [m] from which a body reaches out of another one's bounding box."""


class Decision(Struct, eq=False):
    """Clusters, and the reasons for guessed assignments."""

    survey: Survey
    evidence: Evidence
    clusters: Clusters
    guesses: dict[int, str] = field(default_factory=dict)
    hinges: dict[int, list[JointEvidence]] = field(default_factory=lambda: defaultdict(list))
    """Those that were accepted, by part."""

    def guess(self, members: Sequence[int], why: str) -> None:
        """Record that the assignment of some parts is a guess."""
        for i in members:
            self.guesses.setdefault(i, why)

    @property
    def joints(self) -> list[JointEvidence]:
        """The accepted joints."""
        return [h for h in self.evidence.joints if h.verdict == Verdict.TAKEN]


def decide(survey: Survey, motors: Sequence[Motor], evidence: Evidence) -> Decision:
    """Apply the evidence, then assign motors, surfaces and fasteners that it leaves unconnected."""
    stated = {i for e in evidence.ranked() if e.priority == Priority.STATED for i in (e.a, e.b)}
    made = Decision(survey, evidence, Clusters([i for i in survey.parts if i not in survey.small or i in stated]))
    for one in evidence.ranked():
        accept(made, one)
    _homeless_motors(made, motors)
    _bare_outputs(made)
    for i in sorted(survey.small - stated):
        made.clusters.add(i)
    surfaces = _join_surfaces(made)
    for i in sorted(survey.small - surfaces - stated):
        # The part with the tightest fit around a fastener.
        hosts = [(_tightness(r), -other) for other, r in survey.around(i)]
        host = -max(hosts)[1] if hosts else None
        if host is not None:
            made.clusters.join(host, i)
    return made


def accept(decision: Decision, one: Weld | JointEvidence | Apart) -> None:
    """Accept or reject one piece of evidence."""
    clusters = decision.clusters
    if one.a not in clusters or one.b not in clusters:
        one.verdict = Verdict.REFUSED
    elif isinstance(one, Weld):
        is_taken = not _locks(decision, one) and clusters.join(one.a, one.b)
        one.verdict = Verdict.TAKEN if is_taken else Verdict.REFUSED
    elif isinstance(one, Apart):
        one.verdict = Verdict.TAKEN if clusters.forbid(one.a, one.b) else Verdict.REFUSED
    elif one.score < CHOSEN:
        one.verdict = Verdict.OFFERED
    else:
        one.verdict = Verdict.TAKEN if clusters.forbid(one.a, one.b) else Verdict.REFUSED
        if one.verdict == Verdict.TAKEN and _is_implied(decision, one):
            one.verdict = Verdict.REPEATED
        elif one.verdict == Verdict.TAKEN and one.type in (JointKind.REVOLUTE, JointKind.PRISMATIC):
            decision.hinges[one.a].append(one)
            decision.hinges[one.b].append(one)


def _beside(decision: Decision, a: int, b: int) -> Iterator[tuple[list[JointEvidence], list[JointEvidence]]]:
    """The accepted hinges and slides of two clusters on each link that both are joined to."""
    clusters = decision.clusters
    for common in sorted(clusters.apart_from_both(a, b)):
        one, two = (
            [h for i in members for h in decision.hinges.get(i, ()) if common in map(clusters.find, (h.a, h.b))]
            for members in map(clusters.members, (a, b))
        )
        yield one, two


def _locks(decision: Decision, weld: Weld) -> bool:
    """Whether a weld would lock firmer joints: hinges and slides of its two clusters on one link leave no motion."""
    if weld.priority is not Priority.FOUND or decision.clusters.find(weld.a) == decision.clusters.find(weld.b):
        return False
    return any(_exclude(h, k) for one, two in _beside(decision, weld.a, weld.b) for h in one for k in two)


def _exclude(one: JointEvidence, two: JointEvidence) -> bool:
    if one.type is two.type is JointKind.PRISMATIC:
        return not are_parallel(one.axis.d, two.axis.d)
    return not one.axis.same(two.axis, SAME_LINE)


def _is_implied(decision: Decision, h: JointEvidence) -> bool:
    """Whether firmer joints let a shaft turn and slide in its bore already: a screw in its nut holds neither."""
    if h.type is not JointKind.REVOLUTE or h.relation is None or h.relation.freedom.kind != FreedomKind.CYLINDRICAL:
        return False
    return any(
        any(k.type is JointKind.REVOLUTE and k.axis.same(h.axis, SAME_LINE) for k in turning)
        and any(k.type is JointKind.PRISMATIC and k.axis.is_along(h.axis.d) for k in sliding)
        for sides in _beside(decision, h.a, h.b)
        for turning, sliding in (sides, sides[::-1])
    )


def _homeless_motors(decision: Decision, motors: Sequence[Motor]) -> None:
    """Assign an unsupported motor, drawn without its screws, to the nearest part, not to the part it drives."""
    survey, clusters = decision.survey, decision.clusters
    carried = {x for w in decision.evidence.welds if w.verdict == Verdict.TAKEN and w.holds_motor for x in (w.a, w.b)}
    for motor in motors:
        case = motor.case
        own = clusters.members(case) if case not in survey.small else []
        others = set(own) - set(motor.parts)
        # What touches an unnamed motor may be a body of it.
        least = 0.0 if motor.is_named else _OWN_BODIES * survey.parts[case].volume
        if not own or (motor.is_named and case in carried) or survey.total_volume(others) > least:
            continue
        turned = [h for h in decision.joints if h.drives and h.a == case]
        apart = [(survey.parts[h.b].com - survey.parts[case].com) @ h.axis.d for h in turned if h.b not in motor.parts]
        if apart and min(apart) < 0.0 < max(apart):
            continue  # held at both ends of its axis
        outputs = {clusters.find(h.b) for h in turned}
        if any(
            {h.a, h.b}.intersection(own) and outputs.isdisjoint(map(clusters.find, (h.a, h.b))) for h in decision.joints
        ):
            continue
        best = _nearest_apart(decision, own, 0.5 * survey.parts[case].size)
        if best is not None and clusters.join(case, best):
            decision.guess(own, "unsupported motor: assigned to the nearest part")


def _bare_outputs(decision: Decision) -> None:
    """Assign the nearest larger body that nothing connects to the motor to an output that carries nothing.

    An arm may be drawn around its horn, so that the two overlap and no faces are in contact.
    """
    survey, clusters = decision.survey, decision.clusters
    tied = Clusters(clusters.groups())
    for h in decision.joints:
        tied.join(clusters.find(h.a), clusters.find(h.b))
    for h in decision.joints:
        own = clusters.members(h.b)
        volume = survey.total_volume(own)
        if not h.drives or volume > _OWN_BODIES * survey.parts[h.a].volume:
            continue
        box, drawn = survey.box_of(own), [i for i in own if survey.parts[i].size]
        near: dict[int, list[int]] = defaultdict(list)
        for i in survey.parts_near(box, _BESIDE):
            if i in clusters:
                near[clusters.find(i)].append(i)
        best: tuple[float, float, int] | None = None
        for root, some in near.items():
            theirs = survey.total_volume(clusters.members(root))
            if tied.find(root) == tied.find(clusters.find(h.b)) or theirs <= volume:
                continue
            gap = min(survey.scene.gap(drawn, i) for i in some)
            if gap < _BESIDE:
                mine = round(gap, 4), -theirs, root
                best = mine if best is None else min(best, mine)
        if best is not None:
            members = clusters.members(best[-1])
            roots = tied.find(clusters.find(h.b)), tied.find(best[-1])
            if clusters.join(h.b, best[-1]):
                tied.join(*roots)
                h.review = h.review or _REVIEW_BESIDE
                decision.guess(members, "not connected: assigned to the output of a motor beside it")


def _nearest_apart(decision: Decision, own: Sequence[int], reach: float) -> int | None:
    """The part with the nearest faces within reach [m] of a cluster that no joint keeps apart from it."""
    survey, clusters = decision.survey, decision.clusters
    box, drawn = survey.box_of(own), [i for i in own if survey.parts[i].size]
    ranked = []
    for i in survey.parts_near(box, reach):
        if i not in clusters or clusters.find(i) == clusters.find(own[0]):
            continue
        if not clusters.are_apart(i, own[0]):
            volume = survey.parts[i].volume
            ranked.append((round(survey.scene.gap(drawn, i), 5), -volume, i))
    gap, _, best = min(ranked, default=(reach, 0.0, -1))
    return best if gap < reach else None


def _join_surfaces(decision: Decision) -> set[int]:
    """Join bodies without volume to the other bodies of the part that they belong to; returns them.

    Nothing without mass is a link: a joint that such a body alone has is one of its part, or none.
    """
    clusters, parts, joined = decision.clusters, decision.survey.parts, set()
    for i, part in parts.items():
        if part.volume or any(parts[k].volume for k in clusters.members(i)):
            continue
        inside = clusters.members(i)
        others = [k for k in decision.survey.bodies_of_same_part(i) if k not in inside]
        others = [k for k in others if parts[k].volume] or others
        if others and len({clusters.find(k) for k in others}) == 1:
            clusters.allow(others[0], i)
            if clusters.join(others[0], i):
                joined.add(i)
    for h in decision.joints:
        if clusters.find(h.a) == clusters.find(h.b):
            h.verdict = Verdict.REFUSED
    return joined


def _tightness(r: Relation) -> tuple[float, ...]:
    """The order of hosts of a fastener, in which fits and faces that are drawn equal are equal despite rounding."""
    shafts = r.shafts
    clearance, length = min((f.clearance for f in shafts), default=1.0), max((f.length for f in shafts), default=0.0)
    return bool(shafts), -round(clearance, 6), round(length, 6), round(r.area, 9)


def adopt(decision: Decision, structure: Structure) -> None:
    """Assign small unconnected clusters to the nearest cluster, of the same subassembly if there is one."""
    survey, clusters = decision.survey, decision.clusters
    jointed = {x for h in decision.joints for x in (h.a, h.b)}
    adopted: dict[int, tuple[list[int], int]] = {}
    for root, members in clusters.groups().items():
        if jointed.intersection(members) or any({Role.WHEEL, Role.JAW} & structure.names(i) for i in members):
            continue
        if survey.total_volume(members) < _TINY * survey.volume or all(i in survey.small for i in members):
            target = nearest(survey, members)
            if target is not None:
                adopted[root] = members, target
    _offer_twins(decision, adopted)
    for members, target in adopted.values():
        if clusters.join(target, members[0]):
            decision.guess(members, "not connected: assigned to the nearest part")


def _offer_twins(decision: Decision, adopted: Mapping[int, tuple[Sequence[int], int]]) -> None:
    """Offer the motion of equal small bodies that reach out of the body that they are assigned to."""
    survey = decision.survey
    free = {root: members for root, (members, _) in adopted.items() if not survey.small.issuperset(members)}
    floating = {i for members in free.values() for i in members}
    fixed = survey.boxes_of(i for i in survey.parts if i not in survey.small and i not in floating)
    near = {root: nearest(survey, members, fixed) for root, members in free.items()}
    host = {root: part for root, part in near.items() if part is not None}
    on = {root: decision.clusters.find(part) for root, part in host.items()}
    carriers = {carrier: decision.clusters.members(carrier) for carrier in dict.fromkeys(on.values())}
    boxes = {carrier: survey.box_of(members) for carrier, members in carriers.items()}
    for root, guess in guesses(survey, free, on, carriers).items():
        box, around = survey.box_of(free[root]), boxes[on[root]]
        if bool(np.any(box[0] < around[0] - _OUT) or np.any(box[1] > around[1] + _OUT)):
            a, b = free[root][0], host[root]
            offered = JointEvidence(
                _OFFERED, a, b, guess.kind, guess.axis, guess.why, review=BY_SHAPE, verdict=Verdict.OFFERED
            )
            decision.evidence.joint(offered)


def nearest(survey: Survey, members: Sequence[int], others: tuple[Sequence[int], Boxes] | None = None) -> int | None:
    """The larger part, of ``others`` if given, nearest to some parts by its faces; a tie goes to their subassembly.

    Bounding boxes alone would put a body that stands in an arm's bend or under a chassis into the largest part around.
    """
    (numbers, boxes), inside = others or survey.larger, set(members)
    home = survey.scene.component(members[0]).parent
    drawn = [i for i in members if survey.parts[i].size]
    best: tuple[float, bool, float, int] | None = None
    for k, gap in boxes.nearest(survey.box_of(members)):
        i = numbers[k]
        if best is not None and round(gap, 3) > best[0]:
            break
        if i in inside:
            continue
        elsewhere = not (survey.sources.tree and survey.scene.component(i).parent == home)
        gap = round(survey.scene.gap(drawn, i) if drawn else gap, 3)
        mine = gap, elsewhere, -survey.parts[i].volume, i
        best = mine if best is None else min(best, mine)
    return best[-1] if best is not None else None


_EQUAL = 1e-3
"""Relative difference of volume up to which two bodies are equal."""
_LARGER = 2.0
"""Ratio of volumes from which a body may carry another one."""


class Guess(Struct, frozen=True, eq=False):
    """A joint by the shape of a body that nothing holds."""

    kind: JointKind
    axis: Axis
    why: str


def guesses(
    survey: Survey, free: Mapping[int, Sequence[int]], on: Mapping[int, int], carriers: Mapping[int, Sequence[int]]
) -> dict[int, Guess]:
    """The joints of unconnected bodies that are equal to others on the same carrier, by their keys.

    Args:
        free: Parts of each body that is not connected.
        on: The key of the nearest other body, for those that have one.
        carriers: Parts of these other bodies, by their keys.
    """
    volume = {carrier: survey.total_volume(members) for carrier, members in carriers.items()}
    beside: defaultdict[tuple[int, int], list[tuple[float, int]]] = defaultdict(list)
    for key, carrier in on.items():
        beside[carrier, len(free[key])].append((survey.total_volume(free[key]), key))
    guesses = {}
    for (carrier, _), bodies in beside.items():
        bodies.sort()
        sizes = [size for size, _ in bodies]
        for size, key in bodies:
            first, end = bisect_left(sizes, (1.0 - _EQUAL) * size), bisect_right(sizes, (1.0 + _EQUAL) * size)
            if end - first > 1 and volume[carrier] > _LARGER * size > 0.0:
                twins = [free[other] for _, other in bodies[first:end] if other != key] if end - first == 2 else []
                guess = _guess(survey, free[key], twins[0] if twins else None)
                if guess is not None:
                    guesses[key] = guess
    return {key: guesses[key] for key in free if key in guesses}


def _guess(survey: Survey, members: Sequence[int], twin: Sequence[int] | None) -> Guess | None:
    part = largest([survey.parts[i] for i in members])
    for axis in survey.turned.get(part.index, [])[:3]:
        if part.is_balanced(axis):
            return Guess(JointKind.REVOLUTE, axis, "one of several equal round bodies that nothing holds")
    along = direction_between(survey, members, twin) if twin is not None else None
    if along is None:
        return None
    return Guess(
        JointKind.PRISMATIC, Axis(centroid(survey, members), along), "one of two equal bodies that nothing holds"
    )
