"""Collision geometry: derived from the mesh in one of several ways, or given as primitive shapes."""

from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from .contact import Contact
from .origins import Offset
from .quantities import Length, SizeVector
from .section import MAPPING_OR_WORD, Section


class CollisionShape(StrEnum):
    """Type of collision geometry derived from components."""

    NONE = "none"
    MESH = "mesh"
    HULL = "hull"
    BOX = "box"
    CYLINDER = "cylinder"
    SPHERE = "sphere"
    CAPSULE = "capsule"
    WHEEL = "wheel"
    """A sphere with the radius of the cylinder: it touches the floor in one point, and does not scrub as it turns."""
    DECOMPOSE = "decompose"
    AUTO = "auto"


class BoxShape(Section):
    """A box around its origin."""

    type: Literal["box"]
    """Type of the shape."""
    size: SizeVector
    """Full edge lengths [m]."""
    origin: Offset = Offset()
    """Pose in the link's frame."""
    contact: Contact | None = None
    """Contact properties; override the link's."""


class CylinderShape(Section):
    """A cylinder along z around its origin."""

    type: Literal["cylinder"]
    """Type of the shape."""
    radius: Length
    """Radius [m]."""
    length: Length
    """Full length [m] along z."""
    origin: Offset = Offset()
    """Pose in the link's frame."""
    contact: Contact | None = None
    """Contact properties; override the link's."""


class SphereShape(Section):
    """A sphere around its origin."""

    type: Literal["sphere"]
    """Type of the shape."""
    radius: Length
    """Radius [m]."""
    origin: Offset = Offset()
    """Pose in the link's frame."""
    contact: Contact | None = None
    """Contact properties; override the link's."""


class CapsuleShape(Section):
    """A cylinder along z with half spheres on both ends, around its origin."""

    type: Literal["capsule"]
    """Type of the shape."""
    radius: Length
    """Radius [m]."""
    length: Length
    """Length [m] of the cylinder, without the half spheres."""
    origin: Offset = Offset()
    """Pose in the link's frame."""
    contact: Contact | None = None
    """Contact properties; override the link's."""


def _shape_type(value: Any) -> str | None:
    """The type of a primitive shape; None if it is missing."""
    kind = value.get("type") if isinstance(value, dict) else getattr(value, "type", None)
    return f"<{kind}>" if kind in ("box", "cylinder", "sphere", "capsule") else None


Shape = Annotated[
    Annotated[BoxShape, Tag("<box>")]
    | Annotated[CylinderShape, Tag("<cylinder>")]
    | Annotated[SphereShape, Tag("<sphere>")]
    | Annotated[CapsuleShape, Tag("<capsule>")],
    Discriminator(_shape_type),
]


class CollisionTarget(StrEnum):
    """A simulator that accepts fewer shapes than others."""

    MJX = "mjx"


class CollisionSettings(Section):
    """Type of collision geometry, and its budgets."""

    shape: CollisionShape = CollisionShape.AUTO
    """Type of collision geometry."""
    for_: Annotated[CollisionTarget | None, Field(alias="for")] = None
    """The simulator that must accept all shapes: `mjx` gets no cylinders, and hulls of at most 20 faces.

    In `defaults`, links also get one piece each, and pairs of links that overlap never or always are excluded.
    """
    max_hulls: Annotated[int, Field(ge=1, le=1000)] | None = None
    """Maximum number of convex pieces of a link, or of a component with its own rule; 16 by default, 1 for MJX."""
    max_vertices: Annotated[int, Field(ge=8, le=10000)] | None = None
    """Maximum number of vertices of each hull; 64 by default for `auto` and `decompose`, otherwise unlimited."""


class MergedCollision(Section):
    """One collision shape for the whole link."""

    merge: CollisionShape
    """Type of collision geometry derived from all of the link's components together."""


def _collision_form(value: Any) -> str:
    """A word, one of two mappings, or a list."""
    if isinstance(value, MergedCollision) or (isinstance(value, dict) and "merge" in value):
        return "<merge>"
    if isinstance(value, dict | CollisionSettings):
        return "<settings>"
    return "<list>" if isinstance(value, list | tuple) else "<word>"


Derived = Annotated[
    Annotated[CollisionShape, Tag("<word>")] | Annotated[CollisionSettings, Tag("<mapping>")], MAPPING_OR_WORD
]
"""Collision geometry derived from components."""


def is_for_mjx(collision: Derived | None) -> bool:
    """Whether a rule, such as that of ``defaults``, asks for shapes that MJX accepts."""
    return isinstance(collision, CollisionSettings) and collision.for_ is CollisionTarget.MJX


Collision = Annotated[
    Annotated[CollisionShape, Tag("<word>")]
    | Annotated[CollisionSettings, Tag("<settings>")]
    | Annotated[MergedCollision, Tag("<merge>")]
    | Annotated[tuple[Shape, ...], Tag("<list>")],
    Discriminator(_collision_form),
]
