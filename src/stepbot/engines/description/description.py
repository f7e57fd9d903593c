"""What is read of a description."""

from collections.abc import Mapping
from dataclasses import dataclass

from stepbot.geometry.spatial import Array, Pose

from ..observation import Observation


@dataclass(frozen=True, eq=False)
class DescribedShape:
    """One thing that is seen of a link; of a link that shows nothing, one that is touched."""

    link: str
    name: str
    """That of the shape, else of its mesh file; empty where there is neither."""
    points: Array
    """Vertices (n, 3) [m] in the frame of the link; of a primitive the corners of the box around it."""


@dataclass(frozen=True, eq=False)
class Description:
    """A description without its engine."""

    observation: Observation
    X_PC: Mapping[str, Pose]
    """For each link with a joint above it its pose in its parent where all joints are at 0."""
    shapes: tuple[DescribedShape, ...]
    unread: tuple[str, ...] = ()
    """Mesh files, as the description names them, that are missing or of a kind that is not read."""
