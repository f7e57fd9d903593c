"""Which pairs of links can overlap, with the evidence."""

from enum import StrEnum

from msgspec import Struct

DEFAULT_SAMPLES = 10_000
"""Poses in which overlaps are searched: what never occurs in them occurs, at 95 % confidence, in less than 0.03 %."""

MOST_SAMPLES = 1_000_000
"""Largest number of poses that may be requested: minutes, and a gigabyte for a robot of many joints."""


class PairClass(StrEnum):
    """How often two links overlap."""

    ADJACENT = "adjacent"
    """A joint or a closure connects them, or they are fixed to each other: not compared."""
    ALWAYS = "always"
    """In every pose."""
    NEVER = "never"
    """In no pose."""
    SOMETIMES = "sometimes"
    """In some poses: a contact that a simulator or planner has to find."""


class PairContact(Struct, frozen=True):
    """Two links with collision shapes, and the poses in which they overlap."""

    link_a: str
    link_b: str
    kind: PairClass
    contacts: int = 0
    """Number of poses in which they overlap; 0 for adjacent links, which are not compared."""
    depth: float | None = None
    """Penetration [m] in :attr:`pose`; None if there is no such pose, or between two surfaces, which have no depth."""
    first: int | None = None
    """Number of the first pose in which they overlap, 0 for the drawn pose; None if there is none."""
    pose: tuple[tuple[str, float], ...] = ()
    """That pose: positions [rad] or [m] of all moving joints, mimics included."""

    @property
    def links(self) -> frozenset[str]:
        """Both links."""
        return frozenset((self.link_a, self.link_b))


class SelfCollision(Struct, frozen=True):
    """All pairs of links with collision shapes."""

    samples: int
    """Number of poses, the drawn one included."""
    pairs: tuple[PairContact, ...]
    """In the order of the links."""
    exclude: tuple[PairClass, ...] = ()
    """Classes whose contacts the written files exclude, in addition to adjacent links."""

    @property
    def excluded(self) -> frozenset[frozenset[str]]:
        """Pairs of links that are not adjacent whose contacts the written files exclude."""
        return frozenset(pair.links for pair in self.pairs if pair.kind in self.exclude)

    def of_class(self, kind: PairClass) -> tuple[PairContact, ...]:
        """The pairs of one class."""
        return tuple(pair for pair in self.pairs if pair.kind is kind)
