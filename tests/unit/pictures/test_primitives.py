"""Meshes of primitives, against closed forms."""

from math import pi

import pytest
import trimesh

from stepbot.geometry.mesh import TriMesh
from stepbot.pictures.scene import box_mesh, capsule_mesh, cylinder_mesh

R, L = 0.2, 0.5


@pytest.mark.parametrize(
    ("mesh", "volume", "height"),
    [
        (box_mesh((0.1, 0.2, 0.4)), 0.008, 0.4),
        (cylinder_mesh(R, L), pi * R**2 * L, L),
        (capsule_mesh(R, L), pi * R**2 * L + 4 / 3 * pi * R**3, L + 2 * R),
        (capsule_mesh(R, 0.0), 4 / 3 * pi * R**3, 2 * R),
    ],
    ids=["box", "cylinder", "capsule", "sphere"],
)
def test_a_primitive_is_closed_and_has_its_volume(mesh: TriMesh, volume: float, height: float) -> None:
    """Closed, outward, around the origin, and as large as its closed form but for the facets."""
    read = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert read.is_watertight
    assert read.is_winding_consistent
    assert read.volume == pytest.approx(volume, rel=5e-3)
    assert read.bounds[:, 2] == pytest.approx((-height / 2, height / 2))
