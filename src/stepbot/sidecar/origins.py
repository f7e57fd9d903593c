"""Poses of joints and frames: the forms of ``origin``."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from stepbot.geometry.spatial import ZERO3

from .quantities import Length, LengthVector, RotationVector
from .section import ComponentPath, Section


class Offset(Section):
    """A pose relative to the frame of the origin."""

    xyz: LengthVector = ZERO3
    """Position `[x, y, z]` [m]."""
    rpy: RotationVector = ZERO3
    """Roll, pitch and yaw [rad] about the fixed axes x, y, z, in this order."""


class ExplicitOrigin(Section):
    """A pose given by numbers."""

    xyz: LengthVector = ZERO3
    """Position `[x, y, z]` [m] in the frame given by `relative_to`."""
    rpy: RotationVector = ZERO3
    """Roll, pitch and yaw [rad] about the fixed axes x, y, z, in this order."""
    relative_to: ComponentPath = "assembly"
    """`assembly` (the STEP's own frame), the name of a link, or a component path."""
    offset: Offset | None = None
    """An additional pose, relative to the frame given above."""


class ComponentOrigin(Section):
    """A component's own CAD frame."""

    component: ComponentPath
    """Path of the component."""
    offset: Offset | None = None
    """An additional pose, relative to the component's frame."""


class CenterOrigin(Section):
    """The centre of a component's bounding box, along the axes of the assembly."""

    center: ComponentPath
    """Path of the component."""
    offset: Offset | None = None
    """An additional pose, relative to the frame at the centre."""


class AxisOrigin(Section):
    """A line with cylindrical or conical faces of a component; z along it, the origin at its middle."""

    axis_of: ComponentPath
    """Path of the component."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; selects the nearest line."""
    offset: Offset | None = None
    """An additional pose, relative to the frame on the line."""


class MateOrigin(Section):
    """A line with cylindrical faces of two components: a shaft in its bore."""

    mate: Annotated[tuple[ComponentPath, ComponentPath], Field(min_length=2, max_length=2)]
    """Paths of the two components."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; selects the nearest line."""
    offset: Offset | None = None
    """An additional pose, relative to the frame on the line."""


class AutoOrigin(Section):
    """`auto` with an offset or a selector: the mate between the parts of both links."""

    auto: Literal[True] = True
    """Optional; `{radius: 4 mm}` alone has the same meaning."""
    radius: Length | None = None
    """Only faces of this radius [m], within 0.01 mm."""
    near: LengthVector | None = None
    """A point [m] in the assembly's frame; selects the nearest line."""
    offset: Offset | None = None
    """An additional pose, relative to the frame on the line."""


FORMS = ("component", "center", "axis_of", "mate", "auto")
"""The keys that determine the form of an origin; without any of them it is ``xyz``."""
_EXPLICIT = ("xyz", "rpy", "relative_to")


def _origin_form(value: Any) -> str:
    """The form of an origin, determined by its keys; `auto` if only an offset, a radius or a point is given."""
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
