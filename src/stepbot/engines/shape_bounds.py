"""Bounding boxes of shapes that stepbot's own parsers read, which no engine measures."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from stepbot.geometry.mesh_files import read_mesh
from stepbot.geometry.spatial import Array, Pose, join_bounds
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds
from stepbot.runtime.file import read_regular

from .observation import ObservedShape
from .resources import resolve


def box_around(shapes: Sequence[ObservedShape]) -> Bounds | None:
    """Bounding box [m] of all shapes; None without shapes, or if the box of one is unknown."""
    known = [shape.bounds for shape in shapes if shape.bounds is not None]
    return join_bounds(known) if known and len(known) == len(shapes) else None


def mesh_file_bounds(
    uri: str, file: Path, X_LG: Pose, scale: Sequence[float] = (1.0, 1.0, 1.0)
) -> tuple[Bounds | None, list[str]]:
    """The bounding box [m] of a mesh file in its link, if it can be read, and the file if it is missing.

    Args:
        uri: The mesh file, as in the description.
        X_LG: Pose of the mesh in its link.
        scale: Factors of the coordinates.
    """
    path = resolve(uri, file)
    if path is None:
        return None, [uri]
    vertices = vertices_of(path)
    return (None if vertices is None else mesh_bounds(vertices * np.array(scale), X_LG)), []


def vertices_of(path: Path) -> Array | None:
    """Vertices (n, 3) of a mesh file; None if it cannot be read."""
    content = read_regular(path)
    return _of_obj(content) if path.suffix.lower() == ".obj" else _of_other(path, content)


@lru_cache(maxsize=1024)
def _of_other(path: Path, content: bytes) -> Array | None:  # noqa: ARG001 - a part of the cache key
    mesh = read_mesh(path)
    return None if mesh is None else mesh.vertices


@lru_cache(maxsize=1024)
def _of_obj(obj: bytes) -> Array | None:
    """Vertices (n, 3) of a Wavefront OBJ; parsed once, since visuals and collisions share meshes."""
    words = [line.split()[1:4] for line in obj.splitlines() if line.startswith(b"v ")]
    try:
        vertices = np.array(words, dtype="S").astype(np.float64).reshape(-1, 3)
    except ValueError:
        return None
    if not len(vertices) or not bool(np.isfinite(vertices).all()):
        return None
    vertices.setflags(write=False)
    return vertices
