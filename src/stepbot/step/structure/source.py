"""What a STEP file says before it is expanded into components: each product once, its shapes as the kernel has them."""

from dataclasses import dataclass, field
from typing import Any

from stepbot.geometry.spatial import Array
from stepbot.robot.model import Rgba

NONE = -1
"""Index of nothing."""


@dataclass(frozen=True, eq=False)
class BodySource:
    """A body as the file has it: not healed, not meshed."""

    shape: Any
    """``TopoDS_Shape`` [mm]."""
    precision: float
    """Uncertainty [mm] that it is drawn with."""
    color: Rgba | None
    """Of the body as a whole."""
    face_colors: dict[int, Rgba]
    """By the place of the face in the shape, from 0."""
    is_wire: bool = False
    """Whether it is curves and points only."""


@dataclass(frozen=True, eq=False)
class Child:
    """A component in an assembly's definition."""

    definition: int
    occurrence: str
    matrix: Array
    """Shape (4, 4): the child in the assembly [m]; it may mirror or scale."""
    color: Rgba | None = None
    number: int = NONE
    """Index of the occurrence; -1 for what the kernel made up."""


@dataclass(eq=False)
class Definition:
    """What a product holds."""

    product: int
    """Index of the product; -1 where the kernel made a definition up, for bodies beside components."""
    name: str
    color: Rgba | None = None
    children: list[Child] = field(default_factory=list)
    bodies: list[BodySource] = field(default_factory=list)
    has_spare_curves: bool = False
    """Whether curves or points beside its faces were left out."""


@dataclass(frozen=True)
class StepMaterial:
    """What a part is made of, as far as the file says."""

    name: str = ""
    density: float = 0.0
    """[kg/m^3]; 0 where there is none."""
