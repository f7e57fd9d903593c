"""The content of a description."""

from collections.abc import Mapping
from dataclasses import dataclass

from stepbot.geometry.spatial import Array, Pose

from ..observation import Observation


@dataclass(frozen=True, eq=False)
class DescribedShape:
    """A visual of a link, or a collision of a link without visuals."""

    link: str
    name: str
    """Name of the shape, else of its mesh file; may be empty."""
    points: Array
    """Vertices (n, 3) [m] in the frame of the link; for a primitive the corners of its bounding box."""


@dataclass(frozen=True, eq=False)
class Description:
    """A description, independent of the engine that read it."""

    observation: Observation
    X_PC: Mapping[str, Pose]
    """For each child link its pose in its parent with all joints at 0."""
    shapes: tuple[DescribedShape, ...]
    unread: tuple[str, ...] = ()
    """Mesh files that are missing or of an unsupported type, as named in the description."""
