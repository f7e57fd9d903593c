"""The joint table, for review by a person: the position of every joint and closure, and how it was found.

Engines confirm that the files match the sidecar. Only its author can confirm that the sidecar selects the right axes;
the joint table shows what to review. The records hold plain values, so that a cached table can be displayed without
loading numpy.
"""

from enum import StrEnum

from msgspec import Struct

Vector3 = tuple[float, float, float]


class Basis(StrEnum):
    """How the frame of a joint was found; for a line shared by two sides, how their faces meet on it."""

    GIVEN = "given"
    """Numbers, or the frame or the centre of a component."""
    AXIS = "axis"
    """The axis line of a single component."""
    FIT = "fit"
    """A shaft of one side in a bore of the other with a matching radius."""
    FLANGE = "flange"
    """Bores of equal radius, face to face."""
    TOUCH = "touch"
    """Coaxial faces that overlap or touch along the line, with different radii."""
    APART = "apart"
    """Coaxial faces with a gap between them."""
    FILE = "file"
    """Stated in a robot file."""


class Side(Struct, frozen=True):
    """A face about a joint's axis."""

    component: str
    """Path in the assembly."""
    radius: float
    """[m]."""
    bore: bool
    """Whether material is outside (a hole) or inside (a shaft)."""


class Rival(Struct, frozen=True):
    """Another line that matches the origin."""

    basis: Basis
    point: Vector3
    """[m] in the assembly's frame."""
    direction: Vector3
    radii: tuple[float, ...]
    """Radii [m] of the faces on it, the widest first."""
    share: float
    """Its width relative to the chosen line's: 0.5 is half as wide."""


class Evidence(Struct, frozen=True):
    """How the frame of a joint, closure, named frame or sensor was found."""

    basis: Basis
    text: str = ""
    """For messages, in one phrase: the form of the origin, and its components."""
    sides: tuple[Side, ...] = ()
    """The faces it was found by: one of each side that meets on the line, or those of the single component."""
    overlap: float | None = None
    """Length [m] along the axis on which the two faces overlap; negative for a gap between them."""
    selected: bool = False
    """Whether the sidecar selected among several lines, by `radius` or `near`."""
    selected_by: tuple[Side, ...] = ()
    """The faces of the `radius` in the sidecar, if it selected by one."""
    rivals: tuple[Rival, ...] = ()
    """The other lines, the strongest first."""
    doubt: str = ""
    """Why the evidence is weak; empty if it is strong."""

    @property
    def clearance(self) -> float | None:
        """Radius [m] of the bore minus that of the shaft, for a fit; otherwise None."""
        if self.basis is not Basis.FIT or len(self.sides) != 2:
            return None
        a, b = self.sides
        return a.radius - b.radius if a.bore else b.radius - a.radius


class JointRow(Struct, frozen=True):
    """One joint or closure, in the drawn pose."""

    name: str
    kind: str
    """A :class:`stepbot.robot.model.JointKind` value, or an engine's own word."""
    parent: str
    """The parent link; of a closure, its first link."""
    child: str
    """The child link; of a closure, its second link."""
    origin: Vector3 | None
    """[m] in the assembly's frame; for a file, in the base's frame at q = 0; None if no engine reports it."""
    axis: Vector3 | None
    """Unit direction in the same frame; None for a joint without an axis."""
    axis2: Vector3 | None = None
    """Second axis of a universal joint."""
    is_closure: bool = False
    evidence: Evidence = Evidence(Basis.FILE)
