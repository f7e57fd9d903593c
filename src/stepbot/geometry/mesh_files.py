"""Triangles of mesh files, read by trimesh without their materials and without any file that they name."""

from io import BytesIO
from pathlib import Path

import numpy as np

from .mesh import TriMesh, joined

KINDS = (".stl", ".obj", ".ply")
"""Suffixes of the files that are read."""


def read_mesh(path: Path) -> TriMesh | None:
    """All triangles of a mesh file; None where it cannot be read."""
    import trimesh

    try:
        # From bytes: what else the file names is not opened.
        loaded = trimesh.load_scene(BytesIO(path.read_bytes()), file_type=path.suffix[1:].lower(), process=False)
        meshes = [mesh for mesh in loaded.dump() if isinstance(mesh, trimesh.Trimesh)]
        found = joined([TriMesh.of(mesh.vertices, mesh.faces) for mesh in meshes]) if meshes else None
    except Exception:  # noqa: BLE001 - whatever a loader raises over foreign bytes, there are no triangles
        return None
    return found if found is not None and len(found.vertices) and bool(np.isfinite(found.vertices).all()) else None
