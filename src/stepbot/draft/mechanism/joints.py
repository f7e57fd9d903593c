"""Joints between clusters: one per pair of clusters, and none for parts that only spin about their own axis.

Of two joints in a row about one axis, a driven one and a plain one, the plain one is none: a motor's horn is fastened
to what it turns, and a motor to its seat.
"""

from collections import defaultdict
from collections.abc import Sequence
from heapq import heapify, heappop, heappush
from math import hypot, nan

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.concentric import has_free_circle
from stepbot.draft.contacts.relations import Via
from stepbot.draft.evidence.evidence import SAME_AXIS, SAME_CENTRE, JointEvidence, Priority, Verdict, same_joint
from stepbot.draft.evidence.gears import SAME_GEAR
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.evidence.wheels import Feet, is_wheel
from stepbot.draft.mechanism.decide import Decision
from stepbot.draft.parts.axis import SAME_LINE, Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import box_gap
from stepbot.geometry.spatial import cross, perpendicular_frame
from stepbot.robot.model import JointKind

_SPINNER, _SPINNING_ROD, _SCREW = 0.05, 0.1, 2e-3
"""Shares of the assembly's volume up to which a body that spins is a pin or a ring, a rod at the end of a chain is no
link, and a subassembly is a screw.
"""
_TRIFLE, _AROUND = 0.02, 1e-3
"""Share of a cluster's volume below which a part is ignored; distance [m] of two boxes that may be around a third."""
_IDLER, _EQUAL = 0.02, 0.01
"""Share of a body's volume up to which another one on it is its horn or idler; difference up to which two are equal."""
_ROD, _CRUMB, _TOOL = 2.0, 5e-5, 5e-4
"""Length in diagonals of its section from which a body is a rod; shares of all volume below which it is a pin, and no
flange for a tool.
"""
_PINNED, _IN_SERIES = 1, "turns about the same axis as the motor or pin it is beside"
_WHEEL = 0.08
"""Share of the assembly's size from which a spinning body in its own subassembly is a wheel."""


class Joint(Struct, eq=False):
    """A joint between two clusters, each given by its representative."""

    evidence: JointEvidence
    a: int
    b: int

    def other(self, root: int) -> int:
        """The cluster on the other side."""
        return self.b if root == self.a else self.a

    @property
    def axis(self) -> Axis:
        """The axis of its joint."""
        return self.evidence.axis


class Mechanism:
    """The accepted joints, and those that are only offered."""

    def __init__(self, decision: Decision, structure: Structure) -> None:
        self._decision, self._survey, self._structure = decision, decision.survey, structure
        self._clusters, self._feet = decision.clusters, Feet(decision.survey)
        self._off = max(SAME_LINE, decision.survey.slack[0])
        self.joints: list[Joint] = []
        self.offered: list[JointEvidence] = []
        self._dropped: list[float] = []
        """Volumes of the spinning bodies that were united with what holds them."""
        while self._gather():
            pass
        self._drop_repeated()
        while self._drop_spinners() or self._unite_locked():
            pass
        while self._unite_in_series() or self._unite_two_sides():
            pass

    def _gather(self) -> bool:
        """One joint per pair of clusters: the strongest; True if lines apart were found to lock a pair, now one."""
        taken: dict[tuple[int, int], Joint] = {}
        self.offered = []
        every = self._decision.evidence.joints
        for h in sorted(every, key=lambda h: (-h.priority, -round(h.score, 6), not h.drives, h.a, h.b)):
            if h.a not in self._clusters or h.b not in self._clusters:
                continue
            a, b = sorted((self._clusters.find(h.a), self._clusters.find(h.b)))
            if h.verdict != Verdict.TAKEN or a == b:
                self.offered.append(h)
            elif (a, b) not in taken:
                taken[a, b] = Joint(h, a, b)
            elif same_joint(h, taken[a, b].evidence):
                h.verdict = Verdict.REPEATED
                first = taken[a, b].evidence
                first.drives = first.drives or h.drives
                first.motor = first.motor or h.motor
            elif h.is_plain and taken[a, b].evidence.is_plain:
                # Shafts in bores on two lines hold each other.
                self._clusters.allow(a, b)
                return self._clusters.join(a, b)
            else:
                h.review = "a second axis between two links"
                self.offered.append(h)
        self.joints = list(taken.values())
        return False

    def _unite_locked(self) -> bool:
        """Unite two bodies that shafts in bores on two lines lock, as pins that were united with either side show."""
        plain = [j for j in self.joints if j.evidence.is_plain]
        beside = defaultdict[frozenset[int], list[Joint]](list)
        for j in plain:
            beside[frozenset((j.a, j.b))].append(j)
        for j in plain:
            some = beside[frozenset((j.a, j.b))]
            for k in some[some.index(j) + 1 :]:
                if not j.axis.same(k.axis, SAME_AXIS):
                    self._unite(k.a, k.b, self.joints)
                    return True
        return False

    def _drop_repeated(self) -> None:
        """Leave out joints between bodies that others on the same line connect: three plates on a pin have two."""
        axes = [j.axis for j in self.joints if j.evidence.type == JointKind.REVOLUTE]
        points, directions = np.array([(axis.point, axis.d) for axis in axes]).reshape(-1, 2, 3).swapaxes(0, 1)
        tied_on: dict[int, Clusters] = {}
        kept, row = [], -1
        for j in self.joints:
            if j.evidence.type != JointKind.REVOLUTE:
                kept.append(j)
                continue
            row += 1
            apart = cross(j.axis.point - points[:row], directions[:row])
            near = np.flatnonzero(np.linalg.norm(apart, axis=1) < 2.0 * SAME_AXIS).tolist()
            first = next((n for n in near if n in tied_on and axes[n].same(j.axis, SAME_AXIS)), row)
            tied = tied_on.setdefault(first, Clusters(()))
            for one in {j.a, j.b}:
                if one not in tied:
                    tied.add(one)
            if tied.find(j.a) == tied.find(j.b):
                j.evidence.verdict = Verdict.REPEATED
            else:
                tied.join(j.a, j.b)
                kept.append(j)
        self.joints = kept

    def _of(self) -> dict[int, list[Joint]]:
        return by_cluster(self.joints)

    def _drop_spinners(self) -> bool:
        """Unite bodies that only spin about their own axes with their supports, the smallest first; False for none."""
        joints_of, order = self._of(), {id(j): n for n, j in enumerate(self.joints)}
        volumes = {root: self._volume(root) for root in joints_of}
        waiting = [(volume, root) for root, volume in volumes.items()]
        heapify(waiting)
        while waiting:
            volume, root = heappop(waiting)
            # What was united waits again, with its new volume.
            if root not in joints_of or volume != volumes[root]:
                continue
            victim = self._held_by(root, joints_of[root], is_one_of_two=len(joints_of) <= 2)
            if victim is None:
                continue
            self._dropped.append(volume)
            other = victim.other(root)
            ends = joints_of.pop(root) + joints_of.pop(other)
            self._unite(root, other, ends)
            left = {order[id(j)]: j for j in ends if j.a != j.b}
            if left:
                new = self._clusters.find(root)
                joints_of[new], volumes[new] = [left[n] for n in sorted(left)], self._volume(new)
                heappush(waiting, (volumes[new], new))
        return len(self.joints) < len(order)

    def _held_by(self, root: int, joints: Sequence[Joint], *, is_one_of_two: bool) -> Joint | None:
        """The joint of a body that only spins with what it is to be united with; None if it does more."""
        if any(j.evidence.drives or j.evidence.priority or j.evidence.is_bolted for j in joints):
            return None
        members = self._clusters.members(root)
        first, *others = sorted(joints, key=lambda j: j.evidence.type == JointKind.BALL)
        if len({h.through for h in self._decision.evidence.joints if h.through in members}) > 1:
            return None  # a roller on bearings in both of its ends
        is_rod = len(joints) == 1 and self._is_rod(members, first)
        if not self._spins(members, first.axis, _SPINNING_ROD if is_rod else _SPINNER):
            return None
        balls = [j for j in others if j.evidence.type == JointKind.BALL]
        relation, is_line = first.evidence.relation, first.axis.direction is not None
        # A stud with balls on its axis, which turn in their sockets; a shaft in a bore with one is that of a strut.
        is_strut = len(balls) == 1 and relation is not None and bool(relation.shafts)
        if balls and balls == others and is_line and not is_strut:
            return first if all(first.axis.distance(j.axis.point) < SAME_CENTRE for j in others) else None
        if len(joints) >= 2 and not is_one_of_two and all(j.axis.same(joints[0].axis, self._off) for j in joints):
            return min(joints, key=self._hold)
        if len(joints) == 1 and self._is_pin(members, joints[0]) and not self._is_flange(root, members, joints[0]):
            return joints[0] if joints[0].evidence.type in (JointKind.REVOLUTE, JointKind.UNIVERSAL) else None
        return None

    def _volume(self, root: int) -> float:
        """Volume [m^3] of a cluster."""
        return self._survey.total_volume(self._clusters.members(root))

    def _unite(self, one: int, two: int, joints: Sequence[Joint]) -> None:
        """Unite two clusters instead of joining them; ``joints`` has theirs."""
        self._clusters.allow(one, two)
        self._clusters.join(one, two)
        for j in joints:
            j.a, j.b = self._clusters.find(j.a), self._clusters.find(j.b)
        self.joints = [j for j in self.joints if j.a != j.b]

    def _unite_in_series(self) -> bool:
        """Unite a body with two joints about one axis, and no other, across the plain one or a face beside a pin."""
        joints_of = self._of()
        for middle, joints in sorted(joints_of.items()):
            if len(joints) != 2 or not joints[0].axis.same(joints[1].axis, max(SAME_CENTRE, self._off)):
                continue
            plain, other = sorted(joints, key=lambda j: _firmness(j.evidence))
            weak, strong = plain.evidence, other.evidence
            is_beside = strong.drives and not weak.drives and (weak.is_plain or weak.of_linkage)
            is_seat = _firmness(weak) < _firmness(strong) == _PINNED and weak.priority < Priority.STATED
            is_beside |= is_seat and len(joints_of[plain.other(middle)]) == 1
            if is_beside and weak.type == strong.type == JointKind.REVOLUTE:
                self._decision.guess(self._clusters.members(middle), _IN_SERIES)
                self.joints.remove(plain)
                self._unite(plain.a, plain.b, self.joints)
                return True
        return False

    def _unite_two_sides(self) -> bool:
        """Unite two bodies that turn on a third about one axis, if one has no other joint, or both have the same."""
        joints_of = self._of()
        count = {body: len(joints) for body, joints in joints_of.items()}
        for hub, joints in sorted(joints_of.items()):
            turning = [j for j in joints if j.evidence.type == JointKind.REVOLUTE]
            turning = [j for j in turning if j.evidence.priority < Priority.STATED]
            for m, j in enumerate(turning):
                for k in turning[m + 1 :]:
                    one, two = j.other(hub), k.other(hub)
                    if one == two or not j.axis.same(k.axis, max(SAME_CENTRE, self._off)):
                        continue
                    if self._has_wheel(one) or self._has_wheel(two):
                        continue
                    are_twins = _are_twins(joints_of, one, two)
                    if count[one] > 1 and count[two] > 1 and not are_twins:
                        continue
                    # Two equal bodies that are connected to nothing else are wheels, not two sides of one.
                    if count[one] == count[two] == 1 and self._are_equal(one, two):
                        continue
                    is_chain = self._is_carried(hub, j) + self._is_carried(hub, k) == 1
                    if (is_chain or self._are_serial(hub, one, two)) and not are_twins:
                        continue
                    if j.evidence.of_linkage and k.evidence.of_linkage:
                        continue
                    first_goes = count[one] == 1 and (count[two] > 1 or j.evidence.score < k.evidence.score)
                    gone, kept, leaf = (j, k, one) if first_goes else (k, j, two)
                    members = self._clusters.members(leaf)
                    if self._move_apart(one, two) or self._is_sun(members, hub, two if leaf == one else one, j.axis):
                        continue  # the sun of a planetary gear, beside the carrier
                    self.joints.remove(gone)
                    self._unite(one, two, self.joints)
                    self._decision.guess(members, "turns about the same axis as the parts it was merged with")
                    if gone.evidence.drives and not kept.evidence.drives:
                        kept.evidence.drives, kept.evidence.motor = True, gone.evidence.motor
                        kept.evidence.why = gone.evidence.why
                        kept.evidence.score = max(kept.evidence.score, gone.evidence.score)
                    kept.evidence.review = kept.evidence.review or "two bodies that turn about it were merged"
                    return True
        return False

    def _move_apart(self, one: int, two: int) -> bool:
        """Whether something would be locked if two bodies were one."""
        pairs = ({e.a, e.b} for e in self._decision.evidence.apart if e.verdict == Verdict.TAKEN)
        return any({one, two} == set(map(self._clusters.find, pair)) for pair in pairs)

    def _is_sun(self, members: Sequence[int], hub: int, other: int, axis: Axis) -> bool:
        """Whether a body meshes with others than a hub, and touches nothing of what turns beside it on the hub."""
        meshed = {self._clusters.find(i) for i in self._meshes(members, axis)} - {hub, other}
        near = (r.other(i) for i in members for r in self._survey.near.get(i, ()))
        return bool(meshed) and other not in map(self._clusters.find, near)

    def _are_serial(self, hub: int, one: int, two: int) -> bool:
        """Whether two bodies on one axis are links before and after a third, as stand and neck of a torso.

        The two sides of a fork reach around the third body, and a horn or an idler is much smaller than its motor.
        """
        members = [self._clusters.members(root) for root in (one, two)]
        if box_gap(*map(self._survey.box_of, members)) < _AROUND:
            return False
        least = _IDLER * self._survey.total_volume(self._clusters.members(hub))
        return all(self._survey.total_volume(parts) > least for parts in members)

    def _is_carried(self, hub: int, joint: Joint) -> float:
        """Whether a body carries the housing of an actuator, 1, or what it turns, 0; of one on each side, it is both.

        Not a number if the joint is that of no actuator.
        """
        h = joint.evidence
        if not (h.drives or (h.is_bolted and h.relation is not None and h.relation.shafts)):
            return nan
        inner = h.b if h.drives or h.relation is None else max(h.relation.shafts, key=lambda f: f.length).shaft
        return float(self._clusters.find(inner) != hub)

    def _hold(self, joint: Joint) -> tuple[float, ...]:
        """Looseness of a spinning body on one side, most in a bearing: the tightest side is not a joint."""
        h, r = joint.evidence, joint.evidence.relation
        clearance = min((f.clearance for f in r.shafts), default=1.0) if r is not None else 1.0
        tight = round(clearance, 7), round(h.score, 6), -round(r.length if r is not None else 0.0, 6)
        return h.through >= 0, not self._structure.are_together(h.a, h.b), *tight

    def _spins(self, members: Sequence[int], axis: Axis, most: float) -> bool:
        """Whether a body is symmetric about an axis, and has a share of the volume up to a bound."""
        volume = self._survey.total_volume(members)
        if axis.direction is None or not 0.0 < volume <= most * self._survey.volume:
            return False
        if self._meshes(members, axis):
            return False
        parts = [self._survey.parts[i] for i in members if i not in self._survey.small]
        return all(part.is_balanced(axis) for part in parts if part.volume > _TRIFLE * volume)

    def _meshes(self, members: Sequence[int], axis: Axis) -> list[int]:
        """The racks and gears that a body moves, as a gear about an axis."""
        pairs = [(pair.gear, pair.part) for pair in self._survey.rack_meshes]
        for mesh in self._survey.meshes:
            pairs += [] if mesh.belt else [(mesh.one, mesh.two.part), (mesh.two, mesh.one.part)]
        return [other for gear, other in pairs if gear.part in members and gear.axis.same(axis, SAME_GEAR)]

    def _is_pin(self, members: Sequence[int], joint: Joint) -> bool:
        """Whether a body that only spins is a rod, or a ring beside other joints, and neither a wheel nor in a belt."""
        if self._survey.total_volume(members) < _CRUMB * self._survey.volume or self._is_rod(members, joint):
            return True
        # The last of several equal feet is none, either; a lone disc may be all that moves.
        volume = self._survey.total_volume(members)
        is_like_others = any(abs(volume - other) <= _EQUAL * volume for other in self._dropped)
        is_moved = self._is_wheel(members, joint) or not self._survey.belted.keys().isdisjoint(members)
        return (len(self.joints) > 1 or is_like_others) and not is_moved

    def _is_rod(self, members: Sequence[int], joint: Joint) -> bool:
        """Whether a body is long, and in a bore of the other side of its joint."""
        r = joint.evidence.relation
        if r is None or joint.axis.direction is None or not any(fit.shaft in members for fit in r.shafts):
            return False
        drawn = [i for i in members if self._survey.parts[i].size]
        frame = perpendicular_frame(joint.axis.d).T
        spans = np.array([[self._survey.scene.span(i, d) for i in drawn] for d in frame])
        *across, along = (spans[:, :, 1].max(axis=1) - spans[:, :, 0].min(axis=1)).tolist()
        return bool(along > _ROD * hypot(*across))

    def _is_wheel(self, members: Sequence[int], joint: Joint) -> bool:
        feet, rolling = self._feet.count_beside(members, joint.axis), self._decision.evidence.rolling
        if is_wheel(self._survey, rolling, members, joint.axis) and feet <= max(2, len(rolling)):
            return True  # the assembly stands on it
        if any(Role.WHEEL in self._survey.parts[i].roles or Role.WHEEL in self._structure.names(i) for i in members):
            return True
        if not self._structure.are_across(joint.evidence.a, joint.evidence.b):
            return False
        is_group = all(self._structure.are_together(i, members[0]) for i in members if i not in self._survey.small)
        is_heavy = len(members) > 1 and self._survey.total_volume(members) > _SCREW * self._survey.volume
        return feet < 2 and (self._survey.size_of(members) > _WHEEL * self._survey.extent or (is_group and is_heavy))

    def _is_flange(self, root: int, members: Sequence[int], joint: Joint) -> bool:
        """Whether a body at the end of a chain has a circle of holes that nothing is in or in line with, for a tool."""
        beside = joint.other(root)
        is_last = any(beside in (j.a, j.b) for j in self.joints if j is not joint)
        if not is_last or self._volume(root) < _TOOL * self._survey.volume:
            return False
        near = self._survey.parts_near(self._survey.box_of(members), _AROUND)
        return set(near) <= {*members, *self._clusters.members(beside)} and has_free_circle(
            self._survey.contacts.lines, members, joint.axis
        )

    def _are_equal(self, one: int, two: int) -> bool:
        volumes = [self._volume(root) for root in (one, two)]
        return abs(volumes[0] - volumes[1]) <= _EQUAL * max(volumes)

    def _has_wheel(self, root: int) -> bool:
        return any(Role.WHEEL in self._survey.parts[i].roles for i in self._clusters.members(root))


def _firmness(h: JointEvidence) -> int:
    """Order of two joints in a row about one line: a face on a face is none beside a pin, nor either beside a motor."""
    if h.drives or h.relation is None or h.by_role:
        return 3 if h.drives else 2
    return {Via.FACE: 0, Via.PIN: _PINNED}.get(h.relation.via, 2)


def _are_twins(joints_of: dict[int, list[Joint]], one: int, two: int) -> bool:
    """Whether two bodies have the same hinges, on the same others about two lines or more: they move as one."""
    mine, theirs = joints_of[one], joints_of[two]
    pairs = [k for j in mine for k in theirs if j.other(one) == k.other(two) and same_joint(j.evidence, k.evidence)]
    return len(mine) == len(theirs) == len(pairs) and any(not k.axis.same(pairs[0].axis) for k in pairs)


def by_cluster(joints: Sequence[Joint]) -> dict[int, list[Joint]]:
    """The joints of each cluster."""
    joints_of: dict[int, list[Joint]] = defaultdict(list)
    for j in joints:
        joints_of[j.a].append(j)
        joints_of[j.b].append(j)
    return joints_of
