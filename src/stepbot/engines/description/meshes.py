"""Vertices of mesh files: STL, OBJ and PLY, without materials and without opening referenced files."""

from pathlib import Path

import numpy as np

from stepbot.geometry.mesh_files import KINDS, mesh_vertices
from stepbot.geometry.spatial import Array, Pose, Vector3

from ..resources import resolve


class MeshFiles:
    """Reads each mesh file of a description once."""

    def __init__(self, description: Path) -> None:
        self._description = description
        self._vertices: dict[str, Array | None] = {}

    def vertices(self, uri: str) -> Array | None:
        """Vertices (n, 3) in the file; None if it is missing or unreadable."""
        if uri not in self._vertices:
            self._vertices[uri] = self._read(uri)
        return self._vertices[uri]

    @property
    def unread(self) -> tuple[str, ...]:
        """The unreadable files, as named in the description, sorted."""
        return tuple(sorted(uri for uri, vertices in self._vertices.items() if vertices is None))

    def _read(self, uri: str) -> Array | None:
        path = resolve(uri, self._description)
        if path is None or path.suffix.lower() not in KINDS:
            return None
        return mesh_vertices(path)


def corners(half: Vector3, X_LG: Pose) -> Array:
    """The corners (8, 3) of a box, from its half edge lengths, in the link's frame."""
    signs = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    return X_LG.apply(signs * np.array(half))
