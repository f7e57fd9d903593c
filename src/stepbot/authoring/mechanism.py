"""Joints between clusters: one per pair of clusters, and none for parts that only spin about their own axis."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepbot.robot.model import JointKind

from .axis import Axis, are_parallel
from .decision import Decision
from .evidence import Fate, Hinge, Rank
from .names import Role
from .part import box_gap
from .structure import Structure

_SAME_AXIS = 5e-5
_SAME_CENTRE = 1e-4
_SPINNER = 0.05
"""Share of the assembly's volume up to which a body that spins about its own axis is a pin or a ring, not a link."""
_TRIFLE = 0.02
"""Share of a cluster's volume below which a part is ignored."""
_AROUND = 1e-3
"""Distance [m] between the boxes of two bodies, up to which they may reach around a third."""
_IDLER = 0.02
"""Share of a body's volume up to which another one on it is its horn or idler."""
_EQUAL = 0.01
"""Relative difference of volume up to which two bodies are equal."""
_SCREW = 2e-3
"""Share of the assembly's volume up to which a subassembly that spins is a screw drawn as several bodies."""
_WHEEL = 0.08
"""Share of the assembly's size from which a spinning body in its own subassembly is a wheel."""


@dataclass(eq=False)
class Link:
    """A joint between two clusters, each given by its representative."""

    hinge: Hinge
    a: int
    b: int

    def other(self, root: int) -> int:
        """The cluster on the other side."""
        return self.b if root == self.a else self.a

    @property
    def axis(self) -> Axis:
        """The axis of its joint."""
        return self.hinge.axis


class Mechanism:
    """The accepted joints, and those that are only offered."""

    def __init__(self, made: Decision, structure: Structure) -> None:
        self._made, self._survey, self._structure = made, made.survey, structure
        self._clusters = made.clusters
        self.joints: list[Link] = []
        self.offered: list[Hinge] = []
        self._gather()
        while self._drop_spinner():
            pass
        while self._unite_two_sides():
            pass

    def _gather(self) -> None:
        """One joint per pair of clusters: the strongest."""
        taken: dict[tuple[int, int], Link] = {}
        for h in sorted(self._made.evidence.hinges, key=lambda h: (-round(h.score, 6), h.a, h.b)):
            if h.a not in self._clusters or h.b not in self._clusters:
                continue
            a, b = sorted((self._clusters.find(h.a), self._clusters.find(h.b)))
            if h.fate != Fate.TAKEN or a == b:
                self.offered.append(h)
            elif (a, b) not in taken:
                taken[a, b] = Link(h, a, b)
            elif _same_joint(h, taken[a, b].hinge):
                h.fate = Fate.REPEATED
                first = taken[a, b].hinge
                first.drives = first.drives or h.drives
                first.motor = first.motor or h.motor
            else:
                h.review = "a second axis between two links"
                self.offered.append(h)
        self.joints = list(taken.values())

    def _of(self) -> dict[int, list[Link]]:
        found: dict[int, list[Link]] = defaultdict(list)
        for joint in self.joints:
            found[joint.a].append(joint)
            found[joint.b].append(joint)
        return found

    def _drop_spinner(self) -> bool:
        """Unite one body that only spins about its own axis with its support; False if there is none."""
        of = self._of()
        members = {root: self._clusters.members(root) for root in of}
        for root in sorted(of, key=lambda r: (self._survey.total_volume(members[r]), r)):
            joints = of[root]
            if any(j.hinge.drives or j.hinge.rank for j in joints) or not self._spins(members[root], joints[0].axis):
                continue
            if len(joints) >= 2 and len(of) > 2 and all(j.axis.same(joints[0].axis) for j in joints):
                victim = min(joints, key=self._hold)
            elif len(joints) == 1 and len(self.joints) > 1 and not self._is_wheel(members[root], joints[0]):
                if joints[0].hinge.type not in (JointKind.REVOLUTE, JointKind.UNIVERSAL):
                    continue
                victim = joints[0]
            else:
                continue
            if self._unite(victim, root, victim.other(root)):
                return True
        return False

    def _unite(self, gone: Link, one: int, two: int) -> bool:
        """Unite two clusters instead of joining them."""
        self._clusters.allow(one, two)
        self.joints = [j for j in self.joints if j is not gone]
        if not self._clusters.join(one, two):
            return False
        for j in self.joints:
            j.a, j.b = self._clusters.find(j.a), self._clusters.find(j.b)
        self.joints = [j for j in self.joints if j.a != j.b]
        return True

    def _unite_two_sides(self) -> bool:
        """Unite two bodies that turn on a third about one axis, if one of them is connected to nothing else."""
        of = self._of()
        for hub in sorted(of):
            turning = [j for j in of[hub] if j.hinge.type == JointKind.REVOLUTE and j.hinge.rank < Rank.STATED]
            for m, j in enumerate(turning):
                for k in turning[m + 1 :]:
                    one, two = j.other(hub), k.other(hub)
                    if (
                        one == two
                        or not j.axis.same(k.axis, _SAME_CENTRE)
                        or self._has_wheel(one)
                        or self._has_wheel(two)
                    ):
                        continue
                    if len(of[one]) > 1 and len(of[two]) > 1:
                        continue
                    # Two equal bodies that are connected to nothing else are wheels, not two sides of one.
                    if len(of[one]) == len(of[two]) == 1 and self._are_equal(one, two):
                        continue
                    if self._are_serial(hub, one, two):
                        continue
                    first_goes = len(of[one]) == 1 and (len(of[two]) > 1 or j.hinge.score < k.hinge.score)
                    gone, kept, leaf = (j, k, one) if first_goes else (k, j, two)
                    members = self._clusters.members(leaf)
                    if not self._unite(gone, one, two):
                        continue
                    self._made.guess(members, "turns about the same axis as the parts it was merged with")
                    if gone.hinge.drives and not kept.hinge.drives:
                        kept.hinge.drives, kept.hinge.motor = True, gone.hinge.motor
                        kept.hinge.why = gone.hinge.why
                        kept.hinge.score = max(kept.hinge.score, gone.hinge.score)
                    kept.hinge.review = kept.hinge.review or "two bodies that turn about it were merged"
                    return True
        return False

    def _are_serial(self, hub: int, one: int, two: int) -> bool:
        """Whether two bodies on one axis are links before and after a third, as stand and neck of a torso.

        The two sides of a fork reach around the third body, and a horn or an idler is much smaller than its motor.
        """
        members = [self._clusters.members(root) for root in (one, two)]
        if box_gap(*map(self._survey.box_of, members)) < _AROUND:
            return False
        least = _IDLER * self._survey.total_volume(self._clusters.members(hub))
        return all(self._survey.total_volume(parts) > least for parts in members)

    def _hold(self, joint: Link) -> tuple[float, ...]:
        """Looseness of a spinning body on one side: the tightest side is not a joint."""
        h, r = joint.hinge, joint.hinge.relation
        clearance = min((f.clearance for f in r.shafts), default=1.0) if r is not None else 1.0
        length = r.length if r is not None else 0.0
        return not self._structure.are_together(h.a, h.b), round(clearance, 7), h.score, -length

    def _spins(self, members: Sequence[int], axis: Axis) -> bool:
        """Whether a body is small and symmetric about an axis."""
        volume = self._survey.total_volume(members)
        if axis.direction is None or not 0.0 < volume <= _SPINNER * self._survey.volume:
            return False
        parts = [self._survey.parts[i] for i in members]
        return all(part.is_balanced(axis) for part in parts if part.volume > _TRIFLE * volume)

    def _is_wheel(self, members: Sequence[int], joint: Link) -> bool:
        if any(Role.WHEEL in self._survey.parts[i].roles or Role.WHEEL in self._structure.names(i) for i in members):
            return True
        if not self._structure.are_across(joint.hinge.a, joint.hinge.b):
            return False
        is_group = all(self._structure.are_together(i, members[0]) for i in members if i not in self._survey.small)
        is_large = self._survey.size_of(members) > _WHEEL * self._survey.extent
        is_heavy = self._survey.total_volume(members) > _SCREW * self._survey.volume
        return is_large or (is_group and is_heavy and len(members) > 1)

    def _are_equal(self, one: int, two: int) -> bool:
        volumes = [self._survey.total_volume(self._clusters.members(root)) for root in (one, two)]
        return abs(volumes[0] - volumes[1]) <= _EQUAL * max(volumes)

    def _has_wheel(self, root: int) -> bool:
        return any(Role.WHEEL in self._survey.parts[i].roles for i in self._clusters.members(root))


def _same_joint(one: Hinge, two: Hinge) -> bool:
    if one.type == two.type == JointKind.PRISMATIC:
        return are_parallel(one.axis.d, two.axis.d)
    if {one.type, two.type} & {JointKind.UNIVERSAL, JointKind.BALL}:
        return one.type != two.type or float(np.linalg.norm(one.axis.point - two.axis.point)) < _SAME_CENTRE
    return one.axis.same(two.axis, _SAME_AXIS)
