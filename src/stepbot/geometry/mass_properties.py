"""Mass properties of a mesh, by trimesh: the only module that measures with it."""

import numpy as np

from stepbot.runtime.import_path import import_lightly

from .mesh import TriMesh
from .predicates import is_watertight
from .volume import VolumeProperties

EXTRAS = ("embreex", "fcl", "jsonschema", "manifold3d", "networkx", "rtree", "scipy", "shapely")
"""Modules that trimesh imports if they are installed, and that nothing here needs of it; Pillow reads textures."""


def prepare() -> None:
    """Import trimesh, in a process that only measures."""
    import_lightly("trimesh.triangles", (*EXTRAS, "PIL", "lxml"))


def measured(mesh: TriMesh) -> VolumeProperties | None:
    """Volume, com and inertia at 1 kg/m^3; None if the mesh is not watertight or encloses no volume.

    The integrals are taken about the centre of the mesh: about a distant origin they would lose digits.
    """
    from trimesh.triangles import mass_properties

    if not is_watertight(mesh.faces):
        return None
    low, high = (np.array(corner) for corner in mesh.bounds)
    middle = 0.5 * (low + high)
    with np.errstate(divide="ignore", invalid="ignore"):  # a flat mesh has no com; handled below
        properties = mass_properties((mesh.vertices - middle)[mesh.faces], density=1.0)
    volume, com, inertia = properties.volume, np.asarray(properties.center_mass), np.asarray(properties.inertia)
    if not (volume > 0.0 and np.isfinite(com).all() and np.isfinite(inertia).all()):
        return None
    return VolumeProperties.rounded(volume, com + middle, inertia)
