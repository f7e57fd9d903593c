"""The content of a STEP file before it is expanded to components: each product once, with the kernel's shapes."""

from typing import Any

from msgspec import Struct, field

from stepbot.geometry.spatial import Array
from stepbot.robot.model import Rgba

NONE = -1
"""Index that means none."""


class BodySource(Struct, frozen=True, eq=False):
    """A body as in the file: not healed, not meshed."""

    shape: Any
    """``TopoDS_Shape`` [mm]."""
    precision: float
    """Its uncertainty [mm]."""
    color: Rgba | None
    """Of the body as a whole."""
    face_colors: dict[int, Rgba]
    """By the index of the face in the shape, from 0."""
    is_wire: bool = False
    """Whether it is curves and points only."""


class Child(Struct, frozen=True, eq=False):
    """A component in an assembly's definition."""

    definition: int
    occurrence: str
    matrix: Array
    """Shape (4, 4): the child in the assembly [m]; it may mirror or scale."""
    color: Rgba | None = None
    number: int = NONE
    """Index of the occurrence; -1 for components created by the kernel."""


class Definition(Struct, eq=False):
    """The content of a product."""

    product: int
    """Index of the product; -1 for a definition created by the kernel, for bodies beside components."""
    name: str
    color: Rgba | None = None
    children: list[Child] = field(default_factory=list)
    bodies: list[BodySource] = field(default_factory=list)
    has_spare_curves: bool = False
    """Whether curves or points beside its faces were left out."""
    missing: str = ""
    """Name of the file with its shape, which could not be read; empty otherwise."""


class StepMaterial(Struct, frozen=True):
    """The material of a part, as far as the file states it."""

    name: str = ""
    density: float | None = None
    """[kg/m^3]; None if the file has none."""
