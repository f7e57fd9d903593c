"""Triangles of mesh files, read by trimesh without their materials and without any file that they name."""

from io import BytesIO
from pathlib import Path

import numpy as np

from .mesh import TriMesh, joined

KINDS = (".stl", ".obj", ".ply", ".dae", ".glb", ".gltf")
"""Suffixes of the files that are read."""
_COLLADA = ".dae"


def read_mesh(path: Path) -> TriMesh | None:
    """All triangles of a mesh file, in its coordinates [m]; None where it cannot be read.

    A Collada file states its unit, and its lengths become metres. Its ``up_axis`` is ignored, as in RViz: the
    description places the coordinates of the file.
    """
    import trimesh

    try:
        # From bytes: what else the file names is not opened.
        loaded = trimesh.load_scene(BytesIO(path.read_bytes()), file_type=path.suffix[1:].lower(), process=False)
        meshes = [mesh for mesh in loaded.dump() if isinstance(mesh, trimesh.Trimesh)]
        unit = trimesh.units.unit_conversion(loaded.units, "meters") if path.suffix.lower() == _COLLADA else 1.0
        found = joined([TriMesh.of(mesh.vertices * unit, mesh.faces) for mesh in meshes]) if meshes else None
    except Exception:  # noqa: BLE001 - whatever a loader raises over foreign bytes, there are no triangles
        return None
    return found if found is not None and len(found.vertices) and bool(np.isfinite(found.vertices).all()) else None
