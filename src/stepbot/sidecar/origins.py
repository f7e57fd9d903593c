"""Where a joint or frame is: the forms of ``origin``."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from stepbot.geometry.spatial import ZERO3

from .quantities import Length, LengthVector, RotationVector
from .section import ComponentPath, Section


class Offset(Section):
    """A pose to add, in the frame that the origin gives."""

    xyz: LengthVector = ZERO3
    """Position `[x, y, z]` [m]."""
    rpy: RotationVector = ZERO3
    """Roll, pitch and yaw [rad] about the fixed axes x, y, z, in this order."""


class ExplicitOrigin(Section):
    """A frame by numbers."""

    xyz: LengthVector = ZERO3
    """Position `[x, y, z]` [m] in the frame that `relative_to` names."""
    rpy: RotationVector = ZERO3
    """Roll, pitch and yaw [rad] about the fixed axes x, y, z, in this order."""
    relative_to: ComponentPath = "assembly"
    """`assembly` (the STEP's own frame), the name of a link, or a component path."""
    offset: Offset | None = None
    """A further pose, in the frame that the numbers above give."""


class ComponentOrigin(Section):
    """A component's own CAD frame."""

    component: ComponentPath
    """Path of the component."""
    offset: Offset | None = None
    """A further pose, in the component's frame."""


class CenterOrigin(Section):
    """The middle of a component's bounding box, along the axes of the assembly."""

    center: ComponentPath
    """Path of the component."""
    offset: Offset | None = None
    """A further pose, in the frame at the middle."""


class AxisOrigin(Section):
    """A line that carries cylindrical or conical faces of a component; z along it, the origin at its middle."""

    axis_of: ComponentPath
    """Path of the component."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; the nearest line is taken."""
    offset: Offset | None = None
    """A further pose, in the frame on the line."""


class MateOrigin(Section):
    """The line that carries cylinders of two components: a shaft in its bore."""

    mate: Annotated[tuple[ComponentPath, ComponentPath], Field(min_length=2, max_length=2)]
    """Paths of the two components."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; the nearest line is taken."""
    offset: Offset | None = None
    """A further pose, in the frame on the line."""


class AutoOrigin(Section):
    """`auto` with an offset, or narrowed down: the mate between the parts of both links."""

    auto: Literal[True] = True
    """May be written for clarity; `{radius: 4 mm}` alone means the same."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; the nearest line is taken."""
    offset: Offset | None = None
    """A further pose, in the frame on the line."""


FORMS = ("component", "center", "axis_of", "mate", "auto")
"""The keys that tell the form of an origin; where there is none of them, ``xyz`` and its like do."""
_EXPLICIT = ("xyz", "rpy", "relative_to")


# Tags are written so that they can be told from keys where pydantic puts both into the place of a fault.
def _origin_form(value: Any) -> str:
    """The form of an origin, told by its keys; `auto` where only an offset, a radius or a point is given."""
    if isinstance(value, dict):
        form = next((key for key in FORMS if key in value), None)
        return f"<{form or ('explicit' if any(key in value for key in _EXPLICIT) else 'auto')}>"
    if isinstance(value, Section):
        return next((f"<{key}>" for key in FORMS if hasattr(value, key)), "<explicit>")
    return "<word>"


Origin = Annotated[
    Annotated[Literal["auto"], Tag("<word>")]
    | Annotated[ExplicitOrigin, Tag("<explicit>")]
    | Annotated[ComponentOrigin, Tag("<component>")]
    | Annotated[CenterOrigin, Tag("<center>")]
    | Annotated[AxisOrigin, Tag("<axis_of>")]
    | Annotated[MateOrigin, Tag("<mate>")]
    | Annotated[AutoOrigin, Tag("<auto>")],
    Discriminator(_origin_form),
]
