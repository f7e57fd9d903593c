"""What is drawn: placed meshes with an owner each, and the axes of joints."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, Pose, Vector3

from .camera import View
from .raytrace import Scene, linear

NEVER = -np.inf


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh at its place."""

    mesh: TriMesh
    X_WG: Pose
    colors: Array
    """sRGB of each face, shape (m, 3), or of all, shape (3,); every shape is drawn opaque."""
    owner: int
    """Index of its name in :attr:`Subject.names`."""


@dataclass(frozen=True)
class Axis:
    """The axis of a joint."""

    name: str
    point: Vector3
    """The origin of the joint [m] in the world."""
    direction: Vector3
    """Unit vector in the world."""
    turns: bool
    """Whether the joint turns about the axis."""
    slides: bool
    """Whether the joint slides along it."""


@dataclass(frozen=True, eq=False)
class Subject:
    """What a picture shows."""

    shapes: tuple[Shape, ...]
    names: tuple[str, ...]
    """Names of the owners of the shapes: links, or components."""
    axes: tuple[Axis, ...] = ()


@dataclass(frozen=True, eq=False)
class OwnedScene:
    """The triangles of a subject."""

    scene: Scene
    owners: NDArray[np.int32]
    """Index in :attr:`Subject.names` for each triangle."""


def scene_of(subject: Subject, view: View) -> OwnedScene | None:
    """The triangles of a subject in the world; None if there are none."""
    shapes = [shape for shape in subject.shapes if len(shape.mesh.faces)]
    if not shapes:
        return None
    points = np.concatenate([shape.X_WG.apply(shape.mesh.vertices) for shape in shapes])
    floor = float(points[:, 2].min()) if view.floor and view.elevation >= 0.0 else NEVER
    return OwnedScene(
        Scene(points, _triangles(shapes), np.concatenate([_face_colors(shape) for shape in shapes]), floor),
        np.concatenate([np.full(len(shape.mesh.faces), shape.owner, dtype=np.int32) for shape in shapes]),
    )


def _triangles(shapes: Sequence[Shape]) -> NDArray[np.int32]:
    offsets = np.cumsum([0] + [len(shape.mesh.vertices) for shape in shapes[:-1]])
    placed = [shape.mesh.faces + offset for shape, offset in zip(shapes, offsets, strict=True)]
    return np.concatenate(placed).astype(np.int32)


def _face_colors(shape: Shape) -> Array:
    return np.broadcast_to(linear(shape.colors), (len(shape.mesh.faces), 3))


def exploded(boxes: Array, parents: Sequence[int], units: Collection[int], apart: float) -> Array:
    """A displacement [m] for each component of a tree.

    Args:
        boxes: Lowest and highest corner [m] of each component and everything below it, shape (n, 2, 3); NaN for empty
            ones.
        parents: Index of the component above each; -1 for the root, which is the first; parents precede their children.
        units: Components whose parts stay together.
        apart: Displacement relative to the distance between the centres of a component and its parent.

    Returns:
        Shape (n, 3).
    """
    centres: Array = boxes.mean(axis=1)
    moves: Array = np.zeros(centres.shape)
    inside = np.zeros(len(parents), dtype=bool)
    for index, parent in enumerate(parents):
        if parent < 0:
            continue
        moves[index] = moves[parent]
        inside[index] = inside[parent] or parent in units
        if not inside[index] and np.isfinite(boxes[index]).all():
            moves[index] += apart * (centres[index] - centres[parent])
    return moves
