"""Contacts of two parts: coaxial cylinders, coplanar faces, balls in sockets. In the assembly's frame [m]."""

from collections import defaultdict
from enum import StrEnum

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.draft.parts.axis import Axis
from stepbot.geometry.spatial import Array

Pair = tuple[int, int]
"""Two parts, the smaller index first."""


class FitKind(StrEnum):
    """How two coaxial cylinders meet."""

    SHAFT = "shaft"
    """One is in the other."""
    HOLES = "holes"
    """Both are bores, end to end."""
    FLUSH = "flush"
    """Both are shafts of one radius, end to end."""


class Fit(Struct, frozen=True, eq=False):
    """Coaxial cylinders of two parts."""

    a: int
    b: int
    kind: FitKind
    axis: Axis
    """Its point is the middle of the overlap."""
    radius_a: float
    radius_b: float
    length: float
    """Overlap along the axis; for holes and flush faces the gap, negative if they overlap."""
    shaft: int = -1
    """The inner part."""
    full: bool = True
    """Whether both cover more than half of the circumference."""
    guided: float = 0.0
    """Length [m] from the first to the last place where the shaft is in the other part, as from piston to gland."""
    travel: float = 0.0
    """By how much [m] a bore is longer than the face of a shaft that is all in it, and else 0."""

    @property
    def radius(self) -> float:
        """The smaller radius."""
        return min(self.radius_a, self.radius_b)

    @property
    def clearance(self) -> float:
        """Difference of the radii."""
        return abs(self.radius_a - self.radius_b)


class Patch(Struct, frozen=True, eq=False):
    """Two planes that face each other, and their shared area."""

    a: int
    b: int
    point: Array
    """Shape (3,): centroid of the shared area."""
    normal: Array
    """Shape (3,): outward normal of a."""
    area: float
    """[m^2]."""
    hull: Array
    """Shape (n, 3): its convex outline."""
    rings: tuple[Array, ...]
    """Its outlines, each closed (n, 3), the last point equal to the first."""
    other: Array
    """Shape (3,): outward normal of b."""
    gap: float
    """Distance [m] of b's plane from ``point`` along ``normal``."""

    def of_others(self, a: int, b: int, shift: Array) -> "Patch":
        """That of two other parts, which are placed likewise but for a shift [m]."""
        rings = tuple(ring + shift for ring in self.rings)
        return replace(self, a=a, b=b, point=self.point + shift, hull=self.hull + shift, rings=rings)


class Socket(Struct, frozen=True, eq=False):
    """A ball in a socket."""

    a: int
    b: int
    point: Array
    radius: float


class LineFace(Struct, frozen=True):
    """A face of revolution on a line, by its position along it."""

    radius: float
    low: float
    high: float
    bore: bool
    span: float
    cone: bool


class CoaxialLine(Struct, frozen=True, eq=False):
    """A line with faces of revolution."""

    axis: Axis
    faces: dict[int, tuple[LineFace, ...]]
    """For each part, its faces on the line."""


class Contacts(Struct, frozen=True, eq=False):
    """All contacts of an assembly."""

    lines: list[CoaxialLine] = field(default_factory=list)
    fits: dict[Pair, list[Fit]] = field(default_factory=lambda: defaultdict(list))
    patches: dict[Pair, list[Patch]] = field(default_factory=lambda: defaultdict(list))
    sockets: dict[Pair, list[Socket]] = field(default_factory=lambda: defaultdict(list))

    def pairs(self) -> list[Pair]:
        """All pairs of parts that touch or share a line."""
        return sorted({*self.fits, *self.patches, *self.sockets})
