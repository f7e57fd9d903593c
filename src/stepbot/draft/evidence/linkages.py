"""Linkages: bodies that one pin, one screw or one pair of round holes joins, and nothing else locks.

Pairs alone do not show it: a plate that is clamped by one screw and a bar that turns on one look alike. So all lines on
which bodies are held are collected first, with the pins, washers and bearings on each. Bodies that share two lines, or
whose contacts leave nothing free, are one. What is left is a mechanism: its mobility decides which lines can turn, and
those that cannot are no joints.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.contacts import FitKind
from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation, Via, merged
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Apart, Evidence, JointEvidence
from stepbot.draft.evidence.guides import on_rods
from stepbot.draft.evidence.mobility import MOST, Hinge, Mobility, mobility
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.pivots import Pivot, find_pivots, held_by_faces, spaced_pivots
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Part, whole
from stepbot.geometry.spatial import cross
from stepbot.robot.model import JointKind
from stepbot.step.features.axis_contacts import LOOSEST

REVIEW = "held on one line that nothing else locks: it may be clamped"
_REVIEW_UNCERTAIN = "across a gap or at a stop as drawn: the only evidence is the loop that could move with it"
"""What to review of each such joint."""
_RIGID = 0.87
"""Score of a weld from which two parts are one body of a linkage."""
IN_LOOP, _IN_CHAIN, _ALONE, _HIDDEN = 0.79, 0.72, 0.62, 0.35
"""Scores of a joint in a loop that moves, of one of several, of a single one, and of one within a subassembly."""
_TWIN = 0.88
"""Score of a weld of bodies on the same lines that move as one."""
_ON_TWO_LINES = "on the same two lines of a linkage"
_LOCKED = 0.745
"""Score of a weld where the loops of a linkage lock a line."""
_APART = 0.785
"""Score from which bodies that move in a loop are kept apart."""
_CHAIN = 3
"""Number of joints from which connected ones are a linkage."""
_AXLE_HELD = 0.78
"""Score of the weld that keeps a pin on one side of its joint."""
_TAG_OF_HOST = 0.05
"""Share of the smallest body that holds it, up to which such a body is a tag: small hands have small fingers."""
_TRIFLE, _TAG = 1e-4, 2e-3
"""Shares of the assembly's volume below which a body is no link: in a linkage, and held on one line alone."""
_STACK = 2
"""Number of bodies held on one line alone from which on they are a stack of pulleys or disks on a shaft."""
_LEVER, _GUIDED = 1e-4, 3.0
"""Distance [m] beside a line at which a face is a stop; guided length of a shaft in radii, from which it may slide."""
_TURNS = (FreedomKind.REVOLUTE, FreedomKind.CYLINDRICAL)


@rule(40)
def linkage_evidence(survey: Survey, motors: Sequence[Motor], evidence: Evidence) -> None:
    """Add the joints of all linkages."""
    pivots, spaced = find_pivots(survey), list(spaced_pivots(survey))
    if pivots or spaced:
        _Linkages(survey, motors, evidence, [*pivots, *held_by_faces(survey)], spaced).add()


class _Linkages:
    def __init__(
        self,
        survey: Survey,
        motors: Sequence[Motor],
        evidence: Evidence,
        pivots: Sequence[Pivot],
        spaced: Sequence[Pivot],
    ) -> None:
        self._survey, self._evidence, self._spaced_pivots = survey, evidence, spaced
        self._on_rods = on_rods(survey)
        guides = {rod for one in self._on_rods for rod in one.rods}
        self._pivots = [pivot for pivot in pivots if guides.isdisjoint((*pivot.axles, *pivot.hosts))]
        self._in_motor = {i for motor in motors for i in motor.parts}
        larger = [i for i in survey.parts if i not in survey.small]
        self._bodies = Clusters(larger)
        self._stopped: list[Hinge] = []
        """Pairs of bodies on one line that are locked only by faces which hold against turning one way."""
        self._twins: list[tuple[int, int, list[Axis]]] = []
        """Parts that do not touch, on the same lines."""
        self._unite_rigid()
        while self._unite_locked():
            pass

    def add(self) -> None:
        """Add the joints, by linkage."""
        every = [*self._hinges(), *self._spaced()]
        uncertain = self._in_moving_loops(every)
        turning = {self._ends(h) for h in uncertain}
        for h in self._stopped:
            if self._ends(h) not in turning:
                self._bodies.join(h.a, h.b)
        while self._unite_locked():
            pass
        hinges = self._pruned([*(h for h in self._hinges() if not h.is_uncertain), *uncertain])
        hinges = [h for h in hinges if not {h.a, h.b} & self._in_motor]
        hinges += self._slides(hinges)
        for group in self._connected(hinges):
            tree = [h for h in group if not h.is_extra]
            moving = self._mobility_of(tree)
            pistons = [replace(h, slides=True) if self._is_piston(h, tree) else h for h in tree]
            if len(moving.turning) < len(tree) and any(h.slides for h in pistons):
                freed = self._mobility_of(pistons)
                if len(freed.turning) > len(moving.turning):
                    tree, moving = pistons, freed
            self._say(group, tree, moving)

    def _say(self, group: Sequence[Hinge], tree: Sequence[Hinge], moving: Mobility) -> None:
        """Add the joints of one linkage."""
        turning, looped = moving.turning, moving.looped
        self._evidence.apart.extend(Apart(_APART, a, b) for a, b in moving.apart)
        self._unite_twins(tree, moving)
        for n, h in enumerate(tree):
            if h.slides and n not in looped:
                continue
            if n in turning:
                self._joint(h, len(turning), is_looped=n in looped)
            else:
                self._evidence.weld(_LOCKED, h.a, h.b, "on one line of a loop that cannot move")
        for h in group:
            if h.is_extra and any(tree[n].axis.same(h.axis) for n in turning):
                self._joint(h, len(turning), is_looped=False)
        self._keep_axles([tree[n].axis for n in turning if not tree[n].slides])

    def _unite_twins(self, tree: Sequence[Hinge], moving: Mobility) -> None:
        """Weld bodies on the same two lines that move as one, such as bars on both sides of a link."""
        lines, turning = self._lines_of(tree, moving.looped), self._lines_of(tree, moving.turning)
        for a, b, axes in self._twins:
            body = self._bodies.find(a)
            if body in lines or sum(any(axis.same(one) for one in axes) for axis in turning.get(body, ())) > 1:
                self._evidence.weld(_TWIN, a, b, _ON_TWO_LINES)
        for a, b in combinations(sorted(lines), 2):
            shared = sum(any(one.same(two) for two in lines[b]) for one in lines[a])
            if shared > 1 and (a, b) not in moving.apart:
                self._evidence.weld(_TWIN, a, b, _ON_TWO_LINES)

    def _lines_of(self, tree: Sequence[Hinge], chosen: set[int]) -> dict[int, list[Axis]]:
        """The distinct lines of some hinges, by body."""
        lines: dict[int, list[Axis]] = {}
        for n in sorted(chosen):
            for body in self._ends(tree[n]) if not tree[n].slides else ():
                mine = lines.setdefault(body, [])
                if not any(axis.same(tree[n].axis) for axis in mine):
                    mine.append(tree[n].axis)
        return lines

    def _spaced(self) -> list[Hinge]:
        """Bodies that do not touch, on one line across a gap."""
        lines: dict[tuple[int, int], list[Hinge]] = defaultdict(list)
        for pivot in self._spaced_pivots:
            h = Hinge(pivot.axis, min(pivot.hosts), max(pivot.hosts), is_uncertain=True)
            if not any(h.axis.same(known.axis, LOOSEST) for known in lines[self._ends(h)]):
                lines[self._ends(h)].append(h)
        between = self._between()
        return [
            pivots[0]
            for pair, pivots in lines.items()
            if len(pivots) == 1 and pair[0] != pair[1] and pair not in between
        ]

    def _in_moving_loops(self, hinges: list[Hinge]) -> list[Hinge]:
        """The uncertain hinges in loops that move with them, if they do not hold what moves without."""
        uncertain = []
        for group in self._connected(self._pruned(hinges)) if any(h.is_uncertain for h in hinges) else ():
            tree = [h for h in group if not h.is_extra]
            rest = [h for h in tree if not h.is_uncertain]
            moving = self._mobility_of(tree)
            still = {id(h) for n, h in enumerate(tree) if n not in moving.turning}
            if len(rest) < len(tree) and not any(id(rest[n]) in still for n in self._mobility_of(rest).turning):
                uncertain += [tree[n] for n in sorted(moving.looped) if tree[n].is_uncertain]
        return uncertain

    def _ends(self, h: Hinge) -> tuple[int, int]:
        one, two = sorted((self._bodies.find(h.a), self._bodies.find(h.b)))
        return one, two

    def _mobility_of(self, hinges: Sequence[Hinge]) -> Mobility:
        result = mobility(hinges, self._bodies)
        if result is None:
            self._survey.cut[f"the mobility of linkages of more than {MOST} bodies was not computed"] = None
            return Mobility(set(range(len(hinges))), set(), [])
        return result

    def _is_piston(self, h: Hinge, tree: Sequence[Hinge]) -> bool:
        """Whether one side is a shaft that is long in the other, or a rod in a barrel, with a pin across each."""
        pinned = {body for k in tree if not k.slides and _intersect(h.axis, k.axis) for body in self._ends(k)}
        are_pinned, r = pinned.issuperset(self._ends(h)), self._survey.relation(h.a, h.b)
        if r is None:  # the rod, with play in one of them, is a part of its own
            rods = {i for pivot in self._pivots if pivot.axis.same(h.axis) for i in pivot.axles} - self._survey.small
            return are_pinned and any(near.journals for i in rods for near in self._survey.near.get(i, ()))
        is_sliding = r.via == Via.PIN and r.freedom.kind == FreedomKind.CYLINDRICAL
        return is_sliding and (r.guided > _GUIDED * r.radius or are_pinned)

    def _keep_axles(self, axes: Sequence[Axis]) -> None:
        """Weld each pin of a joint to the part that it fits most tightly: it is no link that turns in both."""
        survey = self._survey
        for pivot in self._pivots:
            for i in pivot.axles if any(axis.same(pivot.axis) for axis in axes) else ():
                held = [r for r in survey.near.get(i, ()) if r.shafts and r.other(i) in pivot.hosts]
                if i not in survey.small and Role.BEARING not in survey.parts[i].roles and held:
                    tightest = min(held, key=lambda r: (round(r.shafts[0].clearance, 7), -round(r.length, 6), r.a, r.b))
                    self._evidence.weld(_AXLE_HELD, i, tightest.other(i), "a pin of a joint")
                    self._evidence.pins.add(i)

    def _joint(self, h: Hinge, count: int, *, is_looped: bool) -> None:
        survey = self._survey
        a, b = sorted((h.a, h.b))
        score = IN_LOOP if is_looped else _IN_CHAIN if count >= _CHAIN else _ALONE
        home = survey.scene.component(a).parent
        together = survey.sources.tree and home == survey.scene.component(b).parent and home not in survey.tops
        if together and not is_looped and count < _CHAIN:
            score = _HIDDEN
        why = "faces that guide it" if h.slides else "the only line that holds both"
        why += ", in a loop that moves" if is_looped else ""
        kind, relation = JointKind.PRISMATIC if h.slides else JointKind.REVOLUTE, survey.relation(a, b)
        review = _REVIEW_UNCERTAIN if h.is_uncertain else REVIEW
        self._evidence.joint(JointEvidence(score, a, b, kind, h.axis, why, relation, review=review, of_linkage=True))

    def _unite_rigid(self) -> None:
        for weld in self._evidence.welds:
            if weld.score >= _RIGID and weld.a in self._bodies and weld.b in self._bodies:
                self._bodies.join(weld.a, weld.b)
        for (a, b), r in self._survey.pairs():
            if r.is_rigid:
                self._bodies.join(a, b)

    def _unite_locked(self) -> bool:
        """Unite two bodies that share two lines, or that are locked together; False if there are none."""
        lines: dict[tuple[int, int], list[Axis]] = defaultdict(list)
        for pivot in self._pivots:
            for pair in combinations(sorted({self._bodies.find(i) for i in pivot.hosts}), 2):
                if not any(axis.same(pivot.axis) for axis in lines[pair]):
                    lines[pair].append(pivot.axis)
        done = False
        between = self._between()
        for (a, b), axes in lines.items():
            relations = between.get((a, b), [])
            locked = len(axes) > 1
            if not locked and len(relations) > 1:
                locked = merged(relations, (a, b), ()).freedom.kind == FreedomKind.RIGID
                if locked and self._opens(relations, axes[0]):
                    self._stopped.append(Hinge(axes[0], relations[0].a, relations[0].b))
                    continue
            if locked and self._bodies.find(a) != self._bodies.find(b):
                if not relations:
                    self._twins.append((a, b, axes))
                done |= self._bodies.join(a, b)
        return done

    def _opens(self, relations: Sequence[Relation], axis: Axis) -> bool:
        """Whether turning one way about the line that holds two bodies takes all faces beside it off each other."""
        if any(
            r.sockets or any(fit.kind != FitKind.FLUSH and not fit.axis.same(axis) for fit in r.fits) for r in relations
        ):
            return False
        one = self._bodies.find(relations[0].a)
        speeds = [
            ((cross(axis.d, p.hull - axis.point) @ p.normal) * (1.0 if self._bodies.find(p.a) == one else -1.0))
            for r in relations
            for p in r.patches
            if not axis.is_along(p.normal)
        ]
        all_speeds = np.concatenate([*speeds, np.zeros(0)])
        least, most = float(all_speeds.min(initial=0.0)), float(all_speeds.max(initial=0.0))
        return most > _LEVER > -least or least < -_LEVER < -most

    def _between(self) -> dict[tuple[int, int], list[Relation]]:
        between: dict[tuple[int, int], list[Relation]] = defaultdict(list)
        for (a, b), r in self._survey.pairs():
            one, two = sorted((self._bodies.find(a), self._bodies.find(b)))
            if one != two:
                between[one, two].append(r)
        return between

    def _hinges(self) -> Iterator[Hinge]:
        """Pairs on each line whose contacts let them turn about it: those that touch first, then neighbours."""
        between = self._between()
        seen: list[tuple[int, int, Axis]] = []
        for pivot in (pivot for pivot in self._pivots if pivot.turns):
            first = {self._bodies.find(i): i for i in reversed(pivot.hosts)}
            ordered = sorted(first.values(), key=pivot.hosts.index)
            keys = {pair: tuple(sorted(map(self._bodies.find, pair))) for pair in combinations(ordered, 2)}
            touching = [pair for pair in combinations(ordered, 2) if keys[pair] in between]
            tied = Clusters(ordered)
            for a, b in dict.fromkeys([*touching, *pairwise(ordered)]):
                one, two = keys[a, b]
                known = any((one, two) == (x, y) and axis.same(pivot.axis) for x, y, axis in seen)
                relations = between.get((one, two), [])
                can_turn = not known and _can_turn(relations, (one, two), pivot.axis)
                if known or not (can_turn or (relations and self._opens(relations, pivot.axis))):
                    continue
                seen.append((one, two, pivot.axis))
                is_extra = tied.find(a) == tied.find(b)
                if not is_extra or (a, b) in touching:
                    if can_turn:
                        tied.join(a, b)
                    yield Hinge(pivot.axis, min(a, b), max(a, b), is_extra, is_uncertain=not can_turn)

    def _slides(self, hinges: Sequence[Hinge]) -> list[Hinge]:
        """Pairs of bodies of linkages whose contacts leave nothing but one translation, or that two rods guide."""
        on, hinged = {self._bodies.find(i) for h in hinges for i in (h.a, h.b)}, {self._ends(h) for h in hinges}
        slides = []
        for pair, relations in self._between().items():
            r = merged(relations, pair, ()) if on.issuperset(pair) and pair not in hinged else None
            if r is not None and r.freedom.kind == FreedomKind.PRISMATIC and r.freedom.direction is not None:
                largest = max(relations, key=lambda relation: (round(relation.area, 9), -relation.a, -relation.b))
                axis = Axis(r.patches[0].point if r.patches else r.fits[0].axis.point, r.freedom.direction)
                slides.append(Hinge(axis, largest.a, largest.b, slides=True))
        for rod in self._on_rods:
            h = Hinge(rod.axis, rod.part, rod.holder, slides=True)
            a, b = self._ends(h)
            if a != b and on.issuperset((a, b)) and not any((a, b) == self._ends(k) for k in (*hinges, *slides)):
                slides.append(h)
        return slides

    def _pruned(self, hinges: list[Hinge]) -> list[Hinge]:
        """Without bodies that are held on one line alone and are turned about it, or are tags."""
        while True:
            by_body = self._by_body(hinges)
            gone = self._stacked(by_body) | {
                id(mine[0])
                for body, mine in by_body.items()
                if all(h.axis.same(mine[0].axis) for h in mine) and self._is_idle(body, mine)
            }
            tiny = {id(h) for body, mine in by_body.items() for h in mine if self._share(body) < _TRIFLE}
            gone |= tiny
            if not gone:
                return hinges
            hinges = [h for h in hinges if id(h) not in gone]

    def _stacked(self, by_body: Mapping[int, Sequence[Hinge]]) -> set[int]:
        """Hinges of bodies that are held on one line alone, where there are several: a stack on a shaft."""
        stacks: list[tuple[Axis, list[Hinge]]] = []
        for mine in by_body.values():
            axis = mine[0].axis
            if any(not h.axis.same(axis) for h in mine):
                continue
            stack = next((hinges for other, hinges in stacks if other.same(axis)), None)
            if stack is None:
                stacks.append((axis, [mine[0]]))
            else:
                stack.append(mine[0])
        lines = [axis for axis, stack in stacks if len(stack) > _STACK]
        return {id(h) for mine in by_body.values() for h in mine if any(axis.same(h.axis) for axis in lines)}

    def _is_idle(self, body: int, mine: Sequence[Hinge]) -> bool:
        """Whether a body that is held on one line alone is turned about it, or a tag on what holds it."""
        parts = [self._survey.parts[i] for i in self._bodies.members(body) if self._survey.parts[i].volume]
        one: Part | None = whole(parts)
        if one is None or one.is_balanced(mine[0].axis):
            return True
        hosts = ({self._bodies.find(h.a), self._bodies.find(h.b)} - {body} for h in mine)
        least = min(self._survey.total_volume(self._bodies.members(host)) for pair in hosts for host in pair)
        return one.volume < min(_TAG * self._survey.volume, _TAG_OF_HOST * least)

    def _share(self, body: int) -> float:
        return self._survey.total_volume(self._bodies.members(body)) / self._survey.volume

    def _by_body(self, hinges: Sequence[Hinge]) -> dict[int, list[Hinge]]:
        by_body: dict[int, list[Hinge]] = defaultdict(list)
        for h in hinges:
            by_body[self._bodies.find(h.a)].append(h)
            by_body[self._bodies.find(h.b)].append(h)
        return by_body

    def _connected(self, hinges: Sequence[Hinge]) -> list[list[Hinge]]:
        tied = Clusters({self._bodies.find(i) for h in hinges for i in (h.a, h.b)})
        for h in hinges:
            tied.join(self._bodies.find(h.a), self._bodies.find(h.b))
        groups: dict[int, list[Hinge]] = defaultdict(list)
        for h in hinges:
            groups[tied.find(self._bodies.find(h.a))].append(h)
        return list(groups.values())


def _intersect(one: Axis, two: Axis) -> bool:
    """Whether two lines intersect at a right angle."""
    across = cross(one.d, two.d)
    return abs(float(one.d @ two.d)) < _LEVER and abs(float((two.point - one.point) @ across)) < _LEVER


def _can_turn(relations: Sequence[Relation], pair: tuple[int, int], axis: Axis) -> bool:
    """Whether all contacts of two bodies leave the rotation about a line free; bodies on one pin need not touch."""
    if not relations:
        return True
    r = merged(relations, pair, ())
    free = r.freedom
    if free.kind not in _TURNS or free.direction is None or not axis.is_along(free.direction):
        return all(axis.is_along(p.normal) for p in r.patches) and not r.shafts and not r.holes
    return True
