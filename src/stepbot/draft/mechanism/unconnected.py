"""The root link, and what to do with clusters that no joint connects to it."""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import BY_NAME, BY_SHAPE, JointEvidence, Verdict
from stepbot.draft.evidence.fingers import centroid, direction_between
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.mechanism.decide import Decision, Guess, guesses, nearest
from stepbot.draft.mechanism.joints import Joint, Mechanism
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import box_gap
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import Direction
from stepbot.robot.model import JointKind
from stepbot.step.features.ground import grounds

_BIG = 0.2
"""Share of the assembly's volume from which an unconnected cluster is a link."""
_TRIMMINGS = ("pad", "tip", "cover", "nail")
"""Words for parts on a finger that are not fingers."""
_GROUP = 0.01
"""The same for a subassembly."""
_FEWEST_SCREWS = 2
"""Number of screws from which two bodies with nothing else between them are one."""
_BESIDE, _SAME = 3e-4, 0.01
"""Distance [m] of faces of bodies beside each other; share of a volume up to which two are equal."""
_SCORE_BY_NAME, _SCORE_BY_SHAPE = 0.55, 0.5
_UNKNOWN = "type, axis and parent are unknown"
_BESIDE_ROOT = "stands beside the root on one ground: it may be a robot of its own"
"""What to review of placeholders."""


class LooseEnds:
    """Connects unconnected clusters."""

    def __init__(self, decision: Decision, mechanism: Mechanism, structure: Structure) -> None:
        self._decision, self._mechanism, self._structure = decision, mechanism, structure
        self._survey, self._clusters = decision.survey, decision.clusters

    def tie(self, root: int) -> None:
        """Connect everything to one tree; ``root`` represents the root link."""
        self._join_screwed()
        root = self._join_bases(self._clusters.find(root))
        groups = self._clusters.groups()
        jointed = self._jointed()
        loose = [r for r in groups if r not in jointed and r != root]
        standing = [r for r in loose if self._stands_alone(groups[r])]
        named = [r for r in loose if r not in standing and {Role.WHEEL, Role.JAW} & self._roles(groups[r])]
        near = {r: self._nearest_cluster(groups[r], root) for r in loose}
        shaped = guesses(self._survey, {r: groups[r] for r in loose}, near, {r: groups[r] for r in near.values()})
        for r in dict.fromkeys((*standing, *named, *shaped)):
            other = near[r]
            guess = self._by_name(groups, r, other, standing + named)
            if guess is None and r in shaped and other != r:
                guess = self._guess(groups, r, other, shaped[r], _SCORE_BY_SHAPE, BY_SHAPE)
            if guess is None and r in standing:
                guess = self._placeholder(groups, other, r)
            if guess is not None:
                self._mechanism.joints.append(guess)
        self._connect(groups, root)
        jointed = self._jointed() | {root}
        for r in loose:
            if r not in jointed:
                target = self._nearest_cluster(groups[r], root)
                if (target in jointed and self._clusters.join(target, r)) or self._clusters.join(root, r):
                    self._decision.guess(groups[r], "not connected: assigned to the nearest part")
                else:  # kept apart, as gears that mesh are
                    self._mechanism.joints.append(self._placeholder(groups, root, r))
        self._find_again()

    def _join_screwed(self) -> None:
        """Join what no joints connect to the body that two or more screws or standoffs also touch."""
        survey, clusters = self._survey, self._clusters
        tied = self._tied(clusters.groups())
        shared: Counter[tuple[int, int]] = Counter()
        for i in sorted(survey.small):
            shared.update(combinations(sorted({clusters.find(other) for other, _ in survey.around(i)}), 2))
        for (a, b), count in sorted(shared.items(), key=lambda row: (-row[1], row[0])):
            one, two = clusters.find(a), clusters.find(b)
            if count < _FEWEST_SCREWS or one == two or tied.find(one) == tied.find(two):
                continue
            if clusters.join(one, two):
                tied.join(one, two)
        self._find_again()

    def _join_bases(self, root: int) -> int:
        """Join what is named a base and has no joint to a root that is named one; a base may be drawn in pieces.

        Returns:
            The representative of the root, which may change.
        """
        groups, jointed = self._clusters.groups(), self._jointed()
        named = [r for r, members in groups.items() if _is_base_by_name(self._survey, self._structure, members)]
        if root in named:
            for r in named:
                if r not in jointed and r != root and self._clusters.join(root, r):
                    self._decision.guess(groups[r], "named a base, as the root is")
        self._find_again()
        return self._clusters.find(root)

    def _tied(self, groups: Iterable[int]) -> Clusters:
        """Clusters that joints connect."""
        tied = Clusters(groups)
        for j in self._mechanism.joints:
            tied.join(j.a, j.b)
        return tied

    def _find_again(self) -> None:
        """Let joints name the representatives of their clusters, which joining changes."""
        for j in self._mechanism.joints:
            j.a, j.b = self._clusters.find(j.a), self._clusters.find(j.b)

    def _connect(self, groups: dict[int, list[int]], root: int) -> None:
        """Placeholders between unconnected pieces; omnidirectional wheels turn, what stands is fixed to the root."""
        tied = self._tied(groups)
        jointed = {q: n for n, q in enumerate(self._jointed())}
        is_whole = len({tied.find(r) for r in (*jointed, root)}) < 2
        stands = {} if is_whole else _standing(self._decision, {*jointed, root})[1]
        for r in sorted(jointed, key=lambda r: groups[r][0]):
            if tied.find(r) == tied.find(root):
                continue
            piece = sorted((q for q in tied.members(r) if q in jointed), key=jointed.__getitem__)
            other = self._nearest_cluster([i for q in piece for i in groups[q]], root)
            if other not in jointed or tied.find(other) == tied.find(r):
                other = root
            hub = next((i for q in piece for i in groups[q] if i in self._decision.evidence.wheels), None)
            if hub is not None:
                mine = self._clusters.find(hub)
                wheel = Guess(JointKind.REVOLUTE, self._decision.evidence.wheels[hub], "a wheel with rollers around it")
                self._mechanism.joints.append(self._guess(groups, mine, other, wheel, _SCORE_BY_SHAPE, BY_SHAPE))
            else:
                driven = {self._clusters.find(j.evidence.b) for j in self._mechanism.joints if j.evidence.drives}
                held = [q for q in piece if q not in driven] or piece  # a motor is held by its case
                box = self._survey.box_of(groups[other])
                _, mine = min((box_gap(self._survey.box_of(groups[q]), box), q) for q in held)
                ground, review = [q for q in piece if q in stands], _UNKNOWN
                if ground and root in stands:
                    other, review = root, _BESIDE_ROOT
                    mine = max(ground, key=lambda q: (round(stands[q], 6), -groups[q][0]))
                self._mechanism.joints.append(self._placeholder(groups, other, mine, review))
                self._join_equal(groups, mine, held, other)
                self._join_equal(groups, other, [q for q in tied.members(other) if q in jointed or q == other], mine)
            tied.join(mine, other)

    def _join_equal(self, groups: dict[int, list[int]], mine: int, piece: Sequence[int], other: int) -> None:
        """Join equal bodies of a piece that are all beside what it is connected to: the sides of a fork."""
        volumes = {q: self._survey.total_volume(groups[q]) for q in piece}
        equal = [q for q in piece if abs(volumes[q] - volumes[mine]) <= _SAME * volumes[mine]]
        beside = [q for q in equal if self._is_beside(groups[q], groups[other])]
        for q in beside if mine in beside else ():
            if q != mine and self._clusters.join(mine, q):
                self._decision.guess(groups[q], "not connected: beside the same part as its equal")

    def _is_beside(self, one: Sequence[int], two: Sequence[int]) -> bool:
        """Whether faces of two bodies are drawn up to 0.3 mm apart."""
        drawn, inside = [i for i in one if self._survey.parts[i].size], set(two)
        near = self._survey.parts_near(self._survey.box_of(one), _BESIDE)
        return any(self._survey.scene.gap(drawn, i) < _BESIDE for i in near if i in inside)

    def _placeholder(self, groups: dict[int, list[int]], a: int, b: int, review: str = _UNKNOWN) -> Joint:
        axis, ends = Axis(self._survey.box_of(groups[b]).mean(axis=0), None), (groups[a][0], groups[b][0])
        why = "no connection found"
        h = JointEvidence(0.0, *ends, JointKind.FIXED, axis, why, review=review, verdict=Verdict.TAKEN)
        return Joint(h, a, b)

    def _jointed(self) -> set[int]:
        return {r for j in self._mechanism.joints for r in (j.a, j.b)}

    def _stands_alone(self, members: Sequence[int]) -> bool:
        if all(i in self._survey.small for i in members):
            return False
        volume = self._survey.total_volume(members)
        if volume > _BIG * self._survey.volume:
            return True
        children = self._survey.assembly.children
        is_group = any(children[self._structure.link_of[i]] for i in members if i in self._structure.link_of)
        return is_group and len(members) > 1 and volume > _GROUP * self._survey.volume

    def _roles(self, members: Iterable[int]) -> set[Role]:
        roles = {role for i in members for role in self._survey.parts[i].roles}
        return roles.union(*(self._structure.names(i) for i in members))

    def _nearest_cluster(self, members: Sequence[int], root: int) -> int:
        part = nearest(self._survey, members)
        cluster = self._clusters.find(part) if part is not None else root
        return root if cluster == self._clusters.find(members[0]) else cluster

    def _by_name(self, groups: dict[int, list[int]], r: int, other: int, own: Sequence[int]) -> Joint | None:
        """A wheel turns about its own axis; two equal fingers slide towards each other."""
        roles, members = self._roles(groups[r]), groups[r]
        if Role.WHEEL in roles:
            largest_first = sorted(members, key=lambda i: (-self._survey.parts[i].volume, i))
            for i in largest_first:
                for axis in self._survey.turned.get(i, [])[:3]:
                    if self._survey.parts[i].is_balanced(axis):
                        wheel = Guess(JointKind.REVOLUTE, axis, "wheel by name; about its own axis")
                        return self._guess(groups, r, other, wheel, _SCORE_BY_NAME, BY_NAME)
        paths = [self._survey.assembly.components[self._structure.link_of.get(i, i)].path.lower() for i in members]
        if Role.JAW not in roles or any(word in path for path in paths for word in _TRIMMINGS):
            return None
        middle = centroid(self._survey, members)
        for s in sorted(own, key=lambda s: float(np.linalg.norm(centroid(self._survey, groups[s]) - middle))):
            if s != r and Role.JAW in self._roles(groups[s]):
                along = direction_between(self._survey, members, groups[s])
                if along is not None:
                    finger = Guess(JointKind.PRISMATIC, Axis(middle, along), "one of two equal fingers by name")
                    return self._guess(groups, r, other, finger, _SCORE_BY_NAME, BY_NAME)
        return None

    def _guess(
        self, groups: dict[int, list[int]], r: int, other: int, guess: Guess, score: float, review: str
    ) -> Joint:
        a, b = groups[r][0], groups[other][0]
        hinge = JointEvidence(score, a, b, guess.kind, guess.axis, guess.why, review=review, verdict=Verdict.TAKEN)
        return Joint(hinge, other, r)


_LOOSE = 0.2
"""Share of the assembly's volume below which a cluster without joints is not the root."""
_NAMED_SHARE = 0.05
"""Share of its cluster's volume from which a part's name counts."""
_TRUNK_SHARE = 0.25
"""Share of the largest cluster's volume up to which one with branches is a wrist, a hand or a bar, not a trunk."""
_BASE_NAME = 2.5
"""What the name of a base counts: more than branches, and more than standing on the ground."""
_GROUND, _RIVAL, _ON_GROUND = 0.08, 0.5, 2.0
"""Share of the footprint from which a flat side is the ground, that of another side up to which it is the only one,
and what standing on it counts.
"""
_USUAL: tuple[Direction, ...] = ("z", "y")
"""Directions that CAD programs have as up; a chain stands towards another one only on its largest link."""
_TWIN, _TWIN_WHOLE = 1e-5, 0.3
"""Shares of a volume up to which the largest parts of two clusters, but motors, are equal, or mirror images, and up to
which the clusters are, which may have other screws and pins.
"""
_FLAT = 0.1
"""Cosine of the angle to the vertical up to which an axis lies flat: what is turned about it is a roller, no stand."""
_STUB = 0.1
"""Share of a cluster's volume up to which one at the end of a chain is a stub on it."""
_BRANCHES, _TRUNK = 3, 1.6
"""Number of joints from which a cluster is a trunk, and what that counts: more joints do not count more, since the
platform of a parallel robot has as many as its base, and a hand as many as a torso.
"""
_HAND, _EVEN = 3.2, 0.05
"""What counts against a trunk that one branch outweighs, unless it is the largest link: the root is on that branch. Up
to which share branches are equal.
"""


def find_root(decision: Decision, structure: Structure, joints: Sequence[Joint], motors: Sequence[Motor]) -> int:
    """The representative of the root cluster."""
    degree = Counter(root for j in joints if not j.evidence.of_roller for root in (j.a, j.b))
    neighbours: dict[int, list[int]] = defaultdict(list)
    only: dict[int, JointEvidence] = {}
    tied = Clusters(decision.clusters.groups())  # limbs are those of one body: not what stands apart
    for j in joints:
        tied.join(j.a, j.b)
        neighbours[j.a].append(j.b)
        neighbours[j.b].append(j.a)
        only[j.a] = only[j.b] = j.evidence
    cases = {i for motor in motors for i in motor.parts}
    holds: Counter[int] = Counter()
    for j in joints:
        if j.evidence.drives and j.evidence.a in cases:
            holds[decision.clusters.find(j.evidence.a)] += 1
            holds[decision.clusters.find(j.evidence.b)] -= 1
    groups = decision.clusters.groups()
    volumes = {root: decision.survey.total_volume(members) for root, members in groups.items()}
    largest = max(volumes.values(), default=0.0) or 1.0
    candidates = {
        root for root in groups if not degree or degree[root] or volumes[root] >= _LOOSE * decision.survey.volume
    }
    up, stands = _standing(decision, candidates)
    is_chain = max(degree.values(), default=0) < _BRANCHES
    beneath = [q for q, share in stands.items() if share > _RIVAL]
    named = {q for q in candidates if _is_base_by_name(decision.survey, structure, groups[q])}
    is_base = named.intersection(beneath) if named else not is_chain or all(volumes[q] >= largest for q in beneath)
    if up not in _USUAL and not is_base:
        up, stands = "z", {}
    mains = {
        root: max((decision.survey.parts[i].volume for i in members if i not in cases), default=0.0)
        for root, members in groups.items()
    }
    ranked = []
    for root in candidates:
        share, members = volumes[root] / decision.survey.volume, groups[root]
        stubs = sum(degree[q] == 1 and volumes[q] < _STUB * volumes[root] for q in neighbours[root])
        is_end = degree[root] <= 1 or (holds[root] > 0 and degree[root] - stubs <= 1)
        one = _Candidate(members, share, volumes[root] / largest, degree[root] or 1, is_end, holds[root])
        twins = (q for q in tied.members(root) if abs(mains[q] - mains[root]) < _TWIN * mains[root])
        is_twin = any(q != root and abs(volumes[q] - volumes[root]) < _TWIN_WHOLE * volumes[root] for q in twins)
        # One of several equal limbs may stand while the others are lifted.
        rank = _rank(decision.survey, structure, one, up) + (-_TRUNK if is_twin else _ON_GROUND * stands.get(root, 0.0))
        if degree[root] == 1 and root not in stands and _is_roller(decision.survey, members, only[root], up):
            rank -= _TRUNK
        if degree[root] >= _BRANCHES and volumes[root] < largest and _is_outweighed(root, joints, volumes):
            rank -= _HAND
        ranked.append((round(rank, 9), -members[0], root))
    return max(ranked)[-1] if ranked else next(iter(groups))


def _is_roller(survey: Survey, members: Sequence[int], h: JointEvidence, up: Direction) -> bool:
    """Whether a body turns about an axis that lies flat, and its large pieces other than belts are turned about it."""
    if h.type != JointKind.REVOLUTE or abs(h.axis.d["xyz".index(up[-1])]) > _FLAT:
        return False
    parts = [survey.parts[i] for i in members if i not in survey.small]
    least = _NAMED_SHARE * exact_sum(part.volume for part in parts)
    return bool(parts) and all(part.is_balanced(h.axis) for part in parts if part.volume > least)


def _is_outweighed(trunk: int, joints: Sequence[Joint], volumes: Mapping[int, float]) -> bool:
    """Whether one branch of a trunk has more volume than the trunk, and no other branch has as much."""
    branches = Clusters(root for root in volumes if root != trunk)
    for j in joints:
        if trunk not in (j.a, j.b):
            branches.join(j.a, j.b)
    beside = {branches.find(q) for j in joints if trunk in (j.a, j.b) for q in (j.a, j.b) if q != trunk}
    totals = sorted((exact_sum(volumes[q] for q in branches.members(r)) for r in beside), reverse=True)
    return len(totals) > 1 and totals[0] > volumes[trunk] and totals[1] < (1.0 - _EVEN) * totals[0]


def _is_base_by_name(survey: Survey, structure: Structure, members: Sequence[int]) -> bool:
    """Whether a cluster has a part, or is in a subassembly, named a base other than that of a wheel or finger."""
    least = _NAMED_SHARE * survey.total_volume(members)
    for i in members:
        own = {*survey.parts[i].roles} if survey.parts[i].volume > least else set()
        if Role.BASE in own | structure.names(i) and not {Role.WHEEL, Role.JAW} & _roles_above(survey, i):
            return True
    return False


def _roles_above(survey: Survey, part: int) -> set[Role]:
    """The roles in the names of a part and of all subassemblies that it is in."""
    roles, node = {*survey.parts[part].roles}, survey.assembly.components[part].parent
    while node > 0:
        roles |= survey.node_roles(node)
        node = survey.assembly.components[node].parent
    return roles


def _standing(decision: Decision, candidates: Collection[int]) -> tuple[Direction, dict[int, float]]:
    """The direction away from the ground, and the share of it of each cluster that the assembly stands on.

    If no flat side is clearly the largest: z, and no shares. What is no candidate for the root, such as a foot that
    nothing holds, counts for the cluster next to it.
    """
    ground = grounds(decision.survey.assembly)
    totals = {up: exact_sum(shares.values()) for up, shares in ground.items()}
    up = max(totals, key=lambda one: totals[one], default=None)
    if (
        up is None
        or totals[up] < _GROUND
        or any(total > _RIVAL * totals[up] for one, total in totals.items() if one != up)
    ):
        return "z", {}
    stands: dict[int, list[float]] = defaultdict(list)
    for i, share in ground[up].items():
        home = decision.clusters.find(i)
        if home not in candidates:
            part = nearest(decision.survey, decision.clusters.members(home))
            home = home if part is None else decision.clusters.find(part)
        stands[home].append(share / totals[up])
    return up, {home: exact_sum(shares) for home, shares in stands.items()}


class _Candidate(Struct, frozen=True):
    """A cluster that may be the root."""

    members: Sequence[int]
    share: float
    """Its share of the assembly's volume."""
    relative: float
    """The same of the largest cluster's."""
    branches: int
    """Number of joints on it."""
    is_end: bool
    """Whether it has one joint at most, but for those of stubs, such as shafts, if it holds a motor."""
    holds: int
    """Number of motors whose cases it has, less those that drive it."""


def _rank(survey: Survey, structure: Structure, candidate: _Candidate, up: Direction) -> float:
    along, side = "xyz".index(up[-1]), int(up.startswith("-"))
    bottom = min(abs(float(survey.parts[i].box[side][along] - survey.box[side][along])) for i in candidate.members)
    rank = _BASE_NAME * _is_base_by_name(survey, structure, candidate.members) + candidate.share
    rank += 0.5 * (1.0 - bottom / max(1e-9, survey.extent))
    if candidate.branches >= _BRANCHES and candidate.relative > _TRUNK_SHARE:
        rank += _TRUNK
    if candidate.is_end:
        rank += 0.3 + 0.4 * ((candidate.holds > 0) - (candidate.holds < 0))
    return rank
