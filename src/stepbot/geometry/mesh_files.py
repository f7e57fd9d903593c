"""Vertices of mesh files, read by trimesh without their materials and without any file that they name."""

from io import BytesIO
from pathlib import Path

import numpy as np

from .spatial import Array

KINDS = (".stl", ".obj", ".ply")
"""Suffixes of the files that are read."""


def mesh_vertices(path: Path) -> Array | None:
    """Vertices (n, 3) of a mesh file; None where it cannot be read."""
    import trimesh

    try:
        # From bytes: what else the file names is not opened.
        loaded = trimesh.load_scene(BytesIO(path.read_bytes()), file_type=path.suffix[1:].lower(), process=False)
        meshes = [mesh for mesh in loaded.dump() if isinstance(mesh, trimesh.Trimesh)]
    except Exception:  # noqa: BLE001 - whatever a loader raises over foreign bytes, there are no vertices
        return None
    vertices = np.concatenate([np.asarray(mesh.vertices, dtype=np.float64) for mesh in meshes] or [np.zeros((0, 3))])
    return vertices if len(vertices) and bool(np.isfinite(vertices).all()) else None
