"""What speaks for two parts being one, or for a joint between them: facts with scores, before anything is decided.

Scores are ranks, not probabilities. From 0.8 a joint stands, from 0.5 it is drafted for review, below it is offered.
"""

from dataclasses import dataclass, field
from enum import StrEnum

from stepbot.robot.model import JointKind

from .axis import Axis
from .draft import CHOSEN
from .relations import Relation


class Fate(StrEnum):
    """What became of a piece of evidence."""

    OPEN = "open"
    TAKEN = "taken"
    REFUSED = "refused"
    """Something stronger says the opposite."""
    OFFERED = "offered"
    """Too weak to be decided by."""
    REPEATED = "repeated"
    """Says the same as another."""


@dataclass(eq=False)
class Weld:
    """Two parts that move as one."""

    score: float
    a: int
    b: int
    why: str
    holds_motor: bool = False
    fate: Fate = Fate.OPEN


@dataclass(eq=False)
class Hinge:
    """Two parts between which there is a joint of some type."""

    score: float
    a: int
    b: int
    type: JointKind
    axis: Axis
    why: str
    relation: Relation | None = None
    axis2: Axis | None = None
    drives: bool = False
    """Whether it is the output of a motor."""
    by_role: bool = False
    """Whether a part that is there for it, such as a bearing, tells of it."""
    review: str = ""
    """What to look at, whatever the score is."""
    fate: Fate = Fate.OPEN


@dataclass(eq=False)
class Evidence:
    """All that was found, in the order in which it was."""

    welds: list[Weld] = field(default_factory=list)
    hinges: list[Hinge] = field(default_factory=list)

    def weld(self, score: float, a: int, b: int, why: str, *, holds_motor: bool = False) -> None:
        """Say that two parts are one."""
        self.welds.append(Weld(score, min(a, b), max(a, b), why, holds_motor))

    def hinge(self, hinge: Hinge) -> None:
        """Say that there is a joint between two parts."""
        self.hinges.append(hinge)

    def ranked(self) -> list[Weld | Hinge]:
        """Everything, the surest first; of equal scores welds first."""
        both: list[Weld | Hinge] = [*self.welds, *self.hinges]
        return sorted(both, key=lambda e: (-round(e.score, 6), isinstance(e, Hinge), e.a, e.b))

    def weaker_hinges(self, least: float) -> list[Hinge]:
        """Joints that are too weak to be drafted for themselves, the surest first."""
        found = [h for h in self.hinges if h.fate == Fate.OFFERED and h.score >= least]
        return sorted(found, key=lambda h: (-round(h.score, 6), h.a, h.b))

    @property
    def mechanisms(self) -> set[tuple[int, int]]:
        """Pairs of parts with a joint that is strong enough to be drafted."""
        return {(h.a, h.b) for h in self.hinges if h.score >= CHOSEN}
