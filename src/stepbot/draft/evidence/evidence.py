"""Evidence that two parts are welded or joined: facts with scores, collected before anything is decided.

Scores are ranks, not probabilities. From 0.8 a joint is accepted, from 0.5 it is drafted for review, below it is only
offered as a comment.
"""

from collections.abc import Collection
from enum import IntEnum, StrEnum

import numpy as np
from msgspec import Struct, field

from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.draft import CHOSEN, SURE
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.robot.model import JointKind

SAME_AXIS, SAME_CENTRE = 5e-5, 1e-4
"""Distances [m] up to which two axes are one: of joints of one pair, and of two bodies that turn on the same one."""
BY_SHAPE = "guessed from its shape; no contact shows this joint"
BY_NAME = "guessed from its name; no contact shows this joint"
"""What to review of a joint that nothing in the drawing shows."""
ONLY_CONNECTION = "weak evidence, used because nothing else connects these links"


class Verdict(StrEnum):
    """The result of a piece of evidence."""

    OPEN = "open"
    TAKEN = "taken"
    REFUSED = "refused"
    """Stronger evidence contradicts it."""
    OFFERED = "offered"
    """Too weak to be used."""
    REPEATED = "repeated"
    """Duplicates other evidence."""


class Priority(IntEnum):
    """What comes first, whatever the scores."""

    FOUND = 0
    NEEDED = 1
    """Without it a loop of joints could not move."""
    STATED = 2
    """By the user; nothing overrides it."""


class Weld(Struct, eq=False):
    """Evidence that two parts move as one."""

    score: float
    a: int
    b: int
    why: str
    holds_motor: bool = False
    priority: Priority = Priority.FOUND
    verdict: Verdict = Verdict.OPEN


class Apart(Struct, eq=False):
    """Evidence that two parts move relative to each other, without a joint between them."""

    score: float
    a: int
    b: int
    priority: Priority = Priority.FOUND
    verdict: Verdict = Verdict.OPEN


class JointEvidence(Struct, eq=False):
    """Evidence for a joint of some type between two parts."""

    score: float
    a: int
    b: int
    type: JointKind
    axis: Axis
    why: str
    relation: Relation | None = None
    axis2: Axis | None = None
    drives: bool = False
    motor: str = ""
    """Path of that motor; empty if it is not named as one."""
    by_role: bool = False
    """Whether it is confirmed by a part with that purpose, such as a bearing."""
    of_roller: bool = False
    """Whether one side is a roller of an omnidirectional wheel."""
    of_linkage: bool = False
    """Whether a linkage needs it: its sides share no other line."""
    is_geared: bool = False
    """Whether it is that of a gear that meshes: what another joint leads is no closure."""
    through: int = -1
    """A part that has the axis by itself, such as a bearing; -1 for none."""
    review: str = ""
    """What to review, whatever the score."""
    priority: Priority = Priority.FOUND
    verdict: Verdict = Verdict.OPEN

    @property
    def is_bolted(self) -> bool:
        """Whether each side is a ring or a disc that carries another part, so that neither only spins."""
        return self.by_role and self.through < 0

    @property
    def is_plain(self) -> bool:
        """Whether it is a shaft in a bore, without a motor, linkage or bearing, which indicate that it turns."""
        is_pin = self.relation is not None and self.relation.via == Via.PIN
        is_stronger = self.drives or self.by_role or self.of_linkage or self.priority != Priority.FOUND
        return is_pin and self.type == JointKind.REVOLUTE and self.score < SURE and not is_stronger


class Evidence(Struct, eq=False):
    """All evidence, in the order in which it was found."""

    welds: list[Weld] = field(default_factory=list)
    joints: list[JointEvidence] = field(default_factory=list)
    apart: list[Apart] = field(default_factory=list)
    pins: set[int] = field(default_factory=set)
    """Pins of linkages, which are no links."""
    wheels: dict[int, Axis] = field(default_factory=dict)
    """Axes of the hubs of omnidirectional wheels, by part."""
    rolling: dict[int, Axis] = field(default_factory=dict)
    """Axes of all wheels, by part."""

    def weld(self, score: float, a: int, b: int, why: str, *, holds_motor: bool = False) -> None:
        """Add evidence that two parts are welded."""
        self.welds.append(Weld(score, min(a, b), max(a, b), why, holds_motor))

    def joint(self, joint: JointEvidence) -> None:
        """Add evidence for a joint between two parts."""
        self.joints.append(joint)

    def links_on(self, axis: Axis, parts: Collection[int]) -> bool:
        """Whether some linkage turns one of some parts about an axis."""
        hinges = (h for h in self.joints if h.of_linkage and h.score >= CHOSEN and h.type is JointKind.REVOLUTE)
        return any((h.a in parts or h.b in parts) and h.axis.same(axis) for h in hinges)

    def ranked(self) -> list[Weld | JointEvidence | Apart]:
        """Everything, by rank, the strongest first; at equal scores welds first."""
        every: list[Weld | JointEvidence | Apart] = [*self.welds, *self.joints, *self.apart]
        return sorted(every, key=lambda e: (-e.priority, -round(e.score, 6), not isinstance(e, Weld), e.a, e.b))

    def weaker_joints(self, least: float) -> list[JointEvidence]:
        """Joints that are too weak to be drafted, the strongest first."""
        weaker = [h for h in self.joints if h.verdict == Verdict.OFFERED and h.score >= least]
        return sorted(weaker, key=lambda h: (-round(h.score, 6), h.a, h.b))

    @property
    def mechanisms(self) -> set[tuple[int, int]]:
        """Pairs of parts with a joint that is strong enough to be drafted."""
        return {(h.a, h.b) for h in self.joints if h.score >= CHOSEN}


def same_joint(one: JointEvidence, two: JointEvidence) -> bool:
    """Whether two joints between the same bodies are one."""
    if one.type == two.type == JointKind.PRISMATIC:
        return are_parallel(one.axis.d, two.axis.d)
    if {one.type, two.type} & {JointKind.UNIVERSAL, JointKind.BALL}:
        return one.type != two.type or float(np.linalg.norm(one.axis.point - two.axis.point)) < SAME_CENTRE
    return one.axis.same(two.axis, SAME_AXIS)
