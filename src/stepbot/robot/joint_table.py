"""What a person must check: where every joint and closure is, and what its place was found by.

Engines confirm that the files say what the sidecar says. Whether the sidecar names the right axis, only its author can
tell; the joint table shows what to look at. The records hold plain values, so that a cached table is shown without
loading numpy.
"""

from dataclasses import dataclass
from enum import StrEnum

Vector3 = tuple[float, float, float]


class Basis(StrEnum):
    """What gave the frame of a joint; for the line that two sides share, how their faces meet on it."""

    GIVEN = "given"
    """Numbers, or the frame or the middle of a component."""
    AXIS = "axis"
    """The line of faces of one component that the sidecar names."""
    FIT = "fit"
    """A shaft of one side in a bore of the other whose radius fits."""
    FLANGE = "flange"
    """Bores of equal radius, face to face."""
    TOUCH = "touch"
    """Coaxial faces that overlap or touch along the line, whose radii do not fit."""
    APART = "apart"
    """Coaxial faces with a gap between them."""
    FILE = "file"
    """A robot file says so."""


@dataclass(frozen=True)
class Side:
    """A face that lies on a joint's axis."""

    component: str
    """Path in the assembly."""
    radius: float
    """[m]."""
    bore: bool
    """Whether material lies outside (a hole) or inside (a shaft)."""


@dataclass(frozen=True)
class Rival:
    """Another line that the origin could have meant."""

    basis: Basis
    point: Vector3
    """[m] in the assembly's frame."""
    direction: Vector3
    radii: tuple[float, ...]
    """Radii [m] of the faces on it, the widest first."""
    share: float
    """Its width over that of the line that was taken: 0.5 is half as wide."""


@dataclass(frozen=True)
class Evidence:
    """What gave the frame of a joint, closure, named frame or sensor."""

    basis: Basis
    text: str = ""
    """For people, in one phrase: the form of the origin, and the components that it found."""
    sides: tuple[Side, ...] = ()
    """The faces it was found by: one of each side that meets on the line, or those of the component that is named."""
    overlap: float | None = None
    """Length [m] along the axis on which the two faces overlap; negative for the gap between them."""
    selected: bool = False
    """Whether the sidecar chose among several lines, by `radius` or `near`."""
    rivals: tuple[Rival, ...] = ()
    """The other lines, the strongest first."""
    doubt: str = ""
    """Why the evidence is weak; empty where it is not."""

    @property
    def clearance(self) -> float | None:
        """Radius [m] of the bore less that of the shaft in it, for a fit; None for anything else."""
        if self.basis is not Basis.FIT or len(self.sides) != 2:
            return None
        a, b = self.sides
        return a.radius - b.radius if a.bore else b.radius - a.radius


@dataclass(frozen=True)
class JointRow:
    """One joint or closure, in the drawn pose."""

    name: str
    kind: str
    """A :class:`stepbot.robot.model.JointKind` value, or an engine's own word."""
    parent: str
    """The link that carries; of a closure, its first link."""
    child: str
    """The link that is moved; of a closure, its second link."""
    origin: Vector3 | None
    """[m] in the assembly's frame; of a file, in the base's frame at q = 0; None where no engine tells."""
    axis: Vector3 | None
    """Unit direction in the same frame; None for a joint without one."""
    axis2: Vector3 | None = None
    """Second axis of a universal joint."""
    is_closure: bool = False
    evidence: Evidence = Evidence(Basis.FILE)
