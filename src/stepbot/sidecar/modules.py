"""Modules: other robots that a robot is composed of."""

from typing import Annotated, Any, Literal

from pydantic import Field

from .origins import Offset
from .quantities import JointPosition
from .section import Name, Reference, Section

Prefix = Annotated[str, Field(max_length=100, pattern="^[^/<>&\"'\\x00-\\x1f\\x7f]*$")]
"""Text in front of names; empty for the names as they are."""


class ModuleSection(Section):
    """A robot that is a part of this one."""

    file: Annotated[str, Field(min_length=1, max_length=4000)] | None = None
    """A sidecar, URDF, SDFormat, MJCF or STEP file, relative to this file, or `library:NAME`; of a STEP, all parts are
    one link."""
    at: Reference | None = None
    """The link or frame that it is fixed to, here or in another module; by default it is the root or has a joint."""
    by: Reference | None = None
    """Its own link or frame that coincides with `at`; by default its root link."""
    offset: Offset | None = None
    """An additional pose, relative to `at`."""
    prefix: Prefix | None = None
    """Text in front of all its names; by default its name here and `_`."""
    mirror_of: Name | None = None
    """Another module here: the same robot, mirrored, at the mirrored place."""
    mirror: Literal["x", "y", "z"] | None = None
    """Mirrors it through this plane of its root link's frame; of `mirror_of`, the plane's normal, by default y."""
    flip: tuple[Annotated[str, Field(min_length=1, max_length=200)], ...] = ()
    """Patterns of joints of a mirrored module whose positive direction is reversed."""
    home: dict[Reference, JointPosition] = Field(default_factory=dict)
    """Initial positions [rad or m] of its joints, by their names or paths in its own file; others keep theirs."""
    without: tuple[Reference, ...] = ()
    """Links and modules of its own file to leave out with everything below them, and joints, frames and devices."""
    variant: Name | None = None
    """One of the variants of its own file."""
    rename: dict[Literal["links", "joints", "closures", "frames", "actuators", "sensors"], dict[Name, Name]] = Field(
        default_factory=dict
    )
    """New names for elements of a URDF, SDFormat or MJCF, by section; everything else here uses them."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Values to change in its own file, under the keys that they have there."""
