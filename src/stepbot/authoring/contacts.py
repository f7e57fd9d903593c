"""How two parts touch, as data: coaxial cylinders, coplanar faces, balls in sockets. In the assembly's frame [m]."""

from collections import defaultdict
from dataclasses import dataclass, field
from enum import StrEnum

from stepbot.geometry.spatial import Array

from .axis import Axis

Pair = tuple[int, int]
"""Two parts, the smaller index first."""


class FitKind(StrEnum):
    """How two cylinders on one line meet."""

    SHAFT = "shaft"
    """One is in the other."""
    HOLES = "holes"
    """Both are bores, end to end."""
    FLUSH = "flush"
    """Both are shafts of one radius, end to end."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Cylinders of two parts on one line."""

    a: int
    b: int
    kind: FitKind
    axis: Axis
    """Its point lies in the middle of the overlap."""
    radius_a: float
    radius_b: float
    length: float
    """Overlap along the axis; of holes and flush shells the gap, negative where they overlap."""
    shaft: int = -1
    """The part that is inside."""
    full: bool = True
    """Whether both go round more than half of the circle."""

    @property
    def radius(self) -> float:
        """The smaller one."""
        return min(self.radius_a, self.radius_b)

    @property
    def clearance(self) -> float:
        """Difference of the radii."""
        return abs(self.radius_a - self.radius_b)


@dataclass(frozen=True, eq=False)
class Patch:
    """Two planes that face each other, and what they share."""

    a: int
    b: int
    point: Array
    """Shape (3,): centroid of the shared area."""
    normal: Array
    """Shape (3,): out of a."""
    area: float
    """[m^2]."""
    hull: Array
    """Shape (n, 3): its convex outline."""
    rings: tuple[Array, ...]
    """Its outlines, each closed (n, 3), the last point equal to the first."""


@dataclass(frozen=True, eq=False)
class Socket:
    """A ball in a socket."""

    a: int
    b: int
    point: Array
    radius: float


@dataclass(frozen=True)
class LineFace:
    """A face of revolution on a line, by its place along it."""

    radius: float
    low: float
    high: float
    bore: bool
    span: float
    cone: bool


@dataclass(frozen=True, eq=False)
class CoaxialLine:
    """A line of faces of revolution."""

    axis: Axis
    faces: dict[int, tuple[LineFace, ...]]
    """For each part those of its faces that lie on the line."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """All contacts of an assembly."""

    lines: list[CoaxialLine] = field(default_factory=list)
    fits: dict[Pair, list[Fit]] = field(default_factory=lambda: defaultdict(list))
    patches: dict[Pair, list[Patch]] = field(default_factory=lambda: defaultdict(list))
    sockets: dict[Pair, list[Socket]] = field(default_factory=lambda: defaultdict(list))

    def pairs(self) -> list[Pair]:
        """All pairs of parts that touch or share a line."""
        return sorted({*self.fits, *self.patches, *self.sockets})
