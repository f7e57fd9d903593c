"""Slides in profiles and on two rods, and crosses of universal joints: what pairs in contact do not reveal."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.contacts import Pair
from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Apart, Evidence, JointEvidence, Priority
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.subassemblies import Structure, is_guide
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.robot.model import JointKind

ON_PIN, CAPTURED = "on a pin and between two faces along it", "captured on four sides"
REVIEW = "{} and free along one direction: it may be fastened"
"""What to review of each slide in a profile or channel, with what holds it."""
_PROFILE, _LOOSE, _TIGHT, _ACROSS = 0.77, 0.72, 0.67, 0.05
"""Scores of profiles, of others with clearance and without, and what is added for parts of two subassemblies."""
_TAG = 5e-4
"""Share of the assembly's volume below which what is captured is a latch, a gear or a plug, not a link."""
_SCREWED, _IN_NUT, _OFFERED = 0.785, 0.25, 0.45
"""Score from which screw and nut are kept apart; those of turning in each other, which connects nothing, and of a slide
that is screwed tight.
"""
_HELD_ROD = 0.775
"""Score of the weld of a rod that a part slides on and what holds it."""
_RODS, _REVIEW_RODS = 0.87, "slides on two parallel rods in bearings"
"""Score of the weld of two rods that slide in bearings and what is on both; what to review of them."""
_EXACT = 1e-6
"""Difference of radii [m] up to which a thread is drawn as thick as the bore of its nut."""
_LONGER = 1.3
"""Ratio of the lengths of a rod and its bore, from which a part can slide on it."""
_LONG_BORE = 3.0
"""Length of a bore in radii, above which it guides, below which it clamps."""
_HEAD = 4.0
"""Length in radii that the head of a screw, or its end behind a nut, is outside of what it holds, at most."""
_APART = 1e-3
"""Distance [m] from which two rods are distinct."""
_SAME_END, _MEET = 1e-4, 1e-5
"""Distances [m] up to which two parts end at one place, and up to which two axes intersect."""
_CROSS_SHARE = 0.02
"""Share of the assembly's volume up to which a part can be a cross."""
_CENTRED = 0.05
"""Distance of a cross's centroid from where its axes intersect, as a share of its size, at most."""


@rule(140)
@rule(60, structure=None)
def captured_evidence(survey: Survey, motors: Sequence[Motor], evidence: Evidence, structure: Structure | None) -> None:
    """Add a joint for each part that is captured in another: as a profile or guide, or in another subassembly.

    Args:
        motors: Their parts do not slide in each other.
        structure: None for profiles and guides, which tell subassemblies that move from links.
    """
    in_motor = {i for motor in motors for i in motor.parts}
    for pair, captured in survey.captured.items():
        tells = captured.is_profile or is_guide(survey, *pair)
        if tells != (structure is None) or in_motor.intersection(pair) or _share_screw(survey, pair):
            continue
        if survey.are_bodies_of_one_part(*pair):
            continue  # bodies that are drawn in one part have clearance to be put together
        if min(survey.parts[i].volume for i in pair) < _TAG * survey.volume:
            continue
        if structure is not None and structure.are_together(*pair):
            continue
        roles = {role for i in pair for role in survey.parts[i].roles}
        if Role.BEAM in roles and roles.isdisjoint((Role.SLIDE, Role.JAW)):
            score = _OFFERED  # screwed tight in its slots
        elif structure is None:
            score = _PROFILE
        elif not captured.has_play and _is_flush(survey, pair, captured.axis):
            score = _OFFERED
        else:
            score = (_LOOSE if captured.has_play else _TIGHT) + _ACROSS * structure.are_across(*pair)
        how, relation = ON_PIN if captured.is_on_pin else CAPTURED, survey.relation(*pair)
        why, review = f"{how} with clearance" if captured.has_play else how, REVIEW.format(how)
        evidence.joint(JointEvidence(score, *pair, JointKind.PRISMATIC, captured.axis, why, relation, review=review))


def _is_flush(survey: Survey, pair: Pair, axis: Axis) -> bool:
    """Whether two parts end at the same places along an axis, as magnets and windings in their slots."""
    one, two = (survey.scene.span(i, axis.d) for i in pair)
    return max(abs(one[0] - two[0]), abs(one[1] - two[1])) < _SAME_END


def _share_screw(survey: Survey, pair: Pair) -> bool:
    """Whether a screw or the like is in both parts."""
    near = [{r.other(i) for r in survey.near.get(i, ()) if r.fits} & survey.small for i in pair]
    return bool(near[0] & near[1])


@rule(130)
def guide_evidence(survey: Survey, evidence: Evidence) -> None:
    """A part with bores on two parallel rods of one body, not held along them, slides on them.

    So does one with linear bearings on two parallel rods, which are fixed in what else they fit.
    """
    _slides_in_bearings(survey, evidence)
    _slides_on_its_rods(survey, evidence)
    for slide in on_rods(survey):
        for rod in slide.rods:
            evidence.weld(_HELD_ROD, rod, slide.holder, "rod in its holder")
    for i in survey.parts:
        if i in survey.small:
            continue
        rods, screws = rods_in(survey, i)
        for screw in screws:
            _turns_in_nut(evidence, i, screw)
        for one, two, r in guided(survey, i, rods):
            assert r.axis is not None
            for rod in (one, two):
                for holder, q in survey.around(rod):
                    if holder != i and q.via == Via.PIN and q.length <= _LONG_BORE * q.radius:
                        evidence.weld(_HELD_ROD, rod, holder, "rod in its holder")
                a, b = sorted((i, rod))
                evidence.joint(JointEvidence(0.77, a, b, JointKind.PRISMATIC, r.axis, "slides on two rods", r))


def rods_in(survey: Survey, part: int) -> tuple[list[tuple[int, Relation]], list[int]]:
    """The rods that a part may slide on, with relations, and those in it that fit exactly while others do not."""
    rods = [(other, r) for other, r in survey.around(part) if _is_rod(survey, other, r)]
    guides = [(other, r) for other, r in rods if _play(r) > _EXACT]
    if 1 < len(guides) < len(rods):
        return guides, [other for other, r in rods if (other, r) not in guides]
    return rods, []


def guided(survey: Survey, part: int, rods: Sequence[tuple[int, Relation]]) -> Iterator[tuple[int, int, Relation]]:
    """Pairs of parallel rods that another part holds and that a part can slide on; the relation of the first."""
    for (one, r), (two, s) in combinations(rods, 2):
        if r.axis is None or s.axis is None or not r.axis.is_along(s.axis.d) or r.axis.distance(s.axis.point) < _APART:
            continue
        if _is_blocked(survey, part, r.axis) or not all(
            _has_travel(survey, part, *row) for row in ((one, r), (two, s))
        ):
            continue
        if _holders_of(survey, part, one, two):
            yield one, two, r


def _has_travel(survey: Survey, part: int, rod: int, r: Relation) -> bool:
    """Whether a rod reaches farther out of a part and what is fastened to it on the rod than a screw's head or end."""
    fastened = [i for i in survey.holders(part) if survey.relation(i, rod) is not None]
    if not fastened or r.axis is None:
        return True
    low, high = np.array([survey.scene.span(i, r.axis.d) for i in (part, *fastened)]).T
    start, end = survey.scene.span(rod, r.axis.d)
    return bool(max(low.min() - start, end - high.max()) > _HEAD * r.radius)


def _turns_in_nut(evidence: Evidence, nut: int, screw: int) -> None:
    """Keep a rod that fits exactly in what slides on two others with play apart from it: it is drawn as its screw."""
    pair = {nut, screw}
    for weld in evidence.welds:
        if {weld.a, weld.b} == pair:
            weld.score = min(weld.score, _IN_NUT)
    for h in evidence.joints:
        if {h.a, h.b} == pair:
            h.score = min(h.score, _IN_NUT)
    evidence.apart.append(Apart(_SCREWED, min(pair), max(pair)))


def _slides_in_bearings(survey: Survey, evidence: Evidence) -> None:
    """Fix the rods of what has linear bearings on two parallel ones."""
    in_bearings: dict[int, list[JointEvidence]] = {}
    for h in evidence.joints:
        if h.type == JointKind.PRISMATIC and h.through >= 0:
            for i in (h.a, h.b):
                in_bearings.setdefault(i, []).append(h)
    for i, slides in in_bearings.items():
        rods = {h.a + h.b - i: h for h in slides if _is_shaft(survey, h.a + h.b - i, h.axis)}
        for one, two in combinations(rods, 2):
            axis = rods[one].axis
            if axis.is_along(rods[two].axis.d) and axis.distance(rods[two].axis.point) > _APART:
                _hold_rods(survey, evidence, (one, two), {i, rods[one].through, rods[two].through})


def _slides_on_its_rods(survey: Survey, evidence: Evidence) -> None:
    """Make the joints of two parallel rods prismatic which are in bearings of one part, and both hold another one."""
    in_bearings: dict[int, dict[int, list[JointEvidence]]] = {}
    for h in evidence.joints:
        for rod, host in ((h.a, h.b), (h.b, h.a)) if h.type == JointKind.REVOLUTE and h.through >= 0 else ():
            if _is_shaft(survey, rod, h.axis):
                in_bearings.setdefault(host, {}).setdefault(rod, []).append(h)
    for host, rods in in_bearings.items():
        for one, two in combinations(sorted(rods), 2):
            axis, other = rods[one][0].axis, rods[two][0].axis
            held = {i for i, r in survey.around(one) if r.via == Via.PIN} & {i for i, _ in survey.around(two)}
            held = {i for i in held - {host} if Role.BEARING not in survey.parts[i].roles}
            if not held or not axis.is_along(other.d) or axis.distance(other.point) < _APART:
                continue
            for h in (*rods[one], *rods[two]):
                h.type, h.review = JointKind.PRISMATIC, _REVIEW_RODS
            for rod in (one, two):
                for holder in held:
                    evidence.weld(_RODS, rod, holder, "rod in its holder")


def _hold_rods(survey: Survey, evidence: Evidence, rods: Sequence[int], sliding: set[int]) -> None:
    """Weld rods to the parts whose bores they fill, other than those that slide on them."""
    for rod in rods:
        for holder, r in survey.around(rod):
            if holder not in sliding and r.via == Via.PIN and Role.BEARING not in survey.parts[holder].roles:
                evidence.weld(_HELD_ROD, rod, holder, "rod in its holder")


def _is_shaft(survey: Survey, part: int, axis: Axis) -> bool:
    """Whether a part is turned about an axis, and longer than it is wide."""
    across = perpendicular_frame(axis.d)[:, 0]
    return survey.parts[part].is_balanced(axis) and np.ptp(survey.scene.span(part, axis.d)) > np.ptp(
        survey.scene.span(part, across)
    )


def _is_rod(survey: Survey, other: int, r: Relation) -> bool:
    if r.via != Via.PIN or r.axis is None or not survey.parts[other].is_balanced(r.axis):
        return False
    fit = max(r.shafts, key=lambda f: f.length)
    box = survey.parts[other].box
    along = float((box[1] - box[0]) @ np.abs(r.axis.d))
    is_long = along > _LONGER * fit.length > _LONGER * _LONG_BORE * r.radius
    return fit.shaft == other and is_long and r.freedom.kind == FreedomKind.CYLINDRICAL


class OnRods(Struct, frozen=True, eq=False):
    """A part that slides on two parallel rods, which another part holds."""

    part: int
    holder: int
    rods: tuple[int, int]
    axis: Axis


def on_rods(survey: Survey) -> list[OnRods]:
    """The parts that slide on two parallel rods of another part: loose on them, in their middle, or by bearings."""
    slides = []
    for i in (i for i in survey.parts if i not in survey.small and Role.BEARING not in survey.parts[i].roles):
        for rods, is_free in ((rods_in(survey, i)[0], False), (_rods_in_bearings(survey, i), True)):
            for one, two, r in guided(survey, i, rods):
                relations = dict(rods)
                for holder in sorted(_holders_of(survey, i, one, two)):
                    held = [(rod, survey.relation(rod, holder)) for rod in (one, two)]
                    tells = all(
                        q is not None and q.shafts and (is_free or _is_looser(survey, rod, relations[rod], q))
                        for rod, q in held
                    )
                    if tells and r.axis is not None:
                        slides.append(OnRods(i, holder, (one, two), r.axis))
    return slides


def _rods_in_bearings(survey: Survey, part: int) -> list[tuple[int, Relation]]:
    """The rods in bearings that a part has in its bores, each with the relation of rod and bearing."""
    seated = (
        (bearing, r.turns)
        for bearing, r in survey.around(part)
        if Role.BEARING in survey.parts[bearing].roles and any(fit.shaft == bearing for fit in r.shafts)
    )
    return [
        (rod, s)
        for bearing, axis in seated
        for rod, s in survey.around(bearing)
        if rod != part and axis is not None and s.turns is not None and s.turns.same(axis) and _is_rod(survey, rod, s)
    ]


def _is_looser(survey: Survey, rod: int, sliding: Relation, held: Relation) -> bool:
    """Whether a rod has more play in what slides than in what holds it, or as much and is only through that."""
    if abs(_play(sliding) - _play(held)) > _EXACT:
        return _play(held) < _play(sliding)
    return _reaches_through(survey, rod, sliding) and not _reaches_through(survey, rod, held)


def _reaches_through(survey: Survey, rod: int, r: Relation) -> bool:
    """Whether a rod ends outside of a part on both sides."""
    if r.axis is None:
        return False
    (start, end), (low, high) = (survey.scene.span(i, r.axis.d) for i in (rod, r.other(rod)))
    return bool(start < low and high < end)


def _play(r: Relation) -> float:
    return min(fit.clearance for fit in r.shafts)


def _holders_of(survey: Survey, part: int, one: int, two: int) -> set[int]:
    """The other parts that touch both rods; the pins of a linkage are each in another link."""
    holders = [{other for other, _ in survey.around(rod)} for rod in (one, two)]
    return holders[0] & holders[1] - {part}


def _is_blocked(survey: Survey, part: int, axis: Axis) -> bool:
    """Whether a face of what is not fastened to a part blocks it along an axis."""
    beside = (r for _, r in survey.around(part) if not r.is_rigid and r.via != Via.RING)
    return any(abs(float(p.normal @ axis.d)) > 0.99 for r in beside for p in r.patches)


@rule(150)
def screw_evidence(survey: Survey, evidence: Evidence) -> None:
    """A shaft that turns elsewhere, in a bore along a slide, is the screw of that slide: neither holds the other.

    So is one named a drive screw, or in a nut named one of a drive, which may turn by way of a coupling.
    """
    slides = [h for h in evidence.joints if h.type == JointKind.PRISMATIC and h.score >= CHOSEN]
    turns = [h for h in evidence.joints if h.type == JointKind.REVOLUTE and (h.by_role or h.drives)]
    for (a, b), r in survey.pairs() if slides else ():
        if r.via != Via.PIN or r.axis is None or not any(h.axis.is_along(r.axis.d) for h in slides):
            continue
        screw = max(r.shafts, key=lambda fit: fit.length).shaft
        nut = r.other(screw)
        held = [h for h in turns if screw in (h.a, h.b) and nut not in (h.a, h.b) and h.axis.same(r.axis)]
        is_named = any(Role.SLIDE in survey.parts[i].roles for i in (screw, nut)) and any(
            h.axis.same(r.axis) for h in turns if nut not in (h.a, h.b)
        )
        # It ends in a coupling.
        if _reaches_through(survey, screw, r) and Role.BEARING not in survey.parts[nut].roles and (held or is_named):
            for h in held:
                h.priority = max(h.priority, Priority.NEEDED)  # it is no pin of what holds it
            evidence.apart.append(Apart(_SCREWED, a, b))
            for h in evidence.joints:
                if (h.a, h.b) == (a, b):
                    h.score, h.why = min(h.score, _IN_NUT), "a shaft that turns, in what slides along it: its screw"


@rule(100)
def cross_evidence(survey: Survey, structure: Structure, evidence: Evidence) -> None:
    """A small part that turns in two others about axes that intersect at a right angle is a universal joint's cross.

    With pins of its own in bushes it is a link, which turns in both.
    """
    pins: dict[int, dict[Relation, int]] = {}
    for (a, b), r in survey.pairs():
        if r.via == Via.PIN:
            for i in (a, b):
                pins.setdefault(i, {})[r] = _fork(survey, i, r)
    for i, forks in pins.items():
        bushed: dict[Relation, None] = {}
        for r, s in combinations(forks, 2):
            centre, one, two = _crossing(r, s), forks[r], forks[s]
            if centre is None or one == two:
                continue
            sides = min(survey.parts[one].volume, survey.parts[two].volume)
            if survey.parts[i].volume > min(_CROSS_SHARE * survey.volume, 2.0 * sides):
                continue
            if float(np.linalg.norm(survey.parts[i].com - centre)) > _CENTRED * survey.parts[i].size:
                continue  # a link of a wrist
            if {one, two} != {r.other(i), s.other(i)}:
                if all(fit.shaft == i for fit in (*r.shafts, *s.shafts)):
                    bushed |= {r: None, s: None}
                continue
            # The cross goes with the side of its subassembly.
            moving, still = (r, s) if structure.are_together(i, two) else (s, r)
            assert moving.axis is not None
            assert still.axis is not None
            axes = Axis(centre, moving.axis.d), Axis(centre, still.axis.d)
            why = "a cross with two axes at a right angle"
            evidence.joint(JointEvidence(0.86, moving.a, moving.b, JointKind.UNIVERSAL, axes[0], why, moving, axes[1]))
            evidence.weld(0.87, i, still.other(i), "cross of a universal joint")
        for r in bushed:
            assert r.axis is not None
            evidence.joint(JointEvidence(0.86, r.a, r.b, JointKind.REVOLUTE, r.axis, "a pin of a cross in its bush", r))
            if forks[r] != r.other(i):
                evidence.weld(0.87, r.other(i), forks[r], "a bush in its fork")


def _fork(survey: Survey, part: int, pin: Relation) -> int:
    """What a part has a pin in: another one, or that which alone is around this one, if it is a bush."""
    bush = pin.other(part)
    assert pin.axis is not None
    around = [
        other
        for other, s in survey.around(bush)
        if s.turns is not None and s.turns.same(pin.axis) and any(fit.shaft == bush for fit in s.shafts)
    ]
    return around[0] if len(around) == 1 and survey.parts[bush].is_balanced(pin.axis) else bush


def _crossing(r: Relation, s: Relation) -> np.ndarray | None:
    """The point where the axes of two relations intersect at a right angle."""
    assert r.axis is not None
    assert s.axis is not None
    if abs(float(r.axis.d @ s.axis.d)) > 1e-3:
        return None
    normal = np.cross(r.axis.d, s.axis.d)
    between = s.axis.point - r.axis.point
    if abs(float(between @ normal)) > _MEET:
        return None
    t = float(np.cross(between, s.axis.d) @ normal) / float(normal @ normal)
    return np.asarray(r.axis.point + t * r.axis.d)
