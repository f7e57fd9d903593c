"""Predicates of meshes, against trimesh and known shapes."""

import numpy as np
import pytest
import trimesh

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.predicates import encloses, is_convex, is_flat, is_watertight
from stepbot.geometry.spatial import Pose
from tests.meshes import dented_box, trough

TETRAHEDRON = TriMesh.of([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
TURNED = Pose.from_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3))

CONVEX = {
    "ball": lambda: trimesh.creation.icosphere(subdivisions=3),
    "box": lambda: trimesh.creation.box((1, 2, 3)),
    "sheet": lambda: trimesh.creation.box((0.3, 0.001, 0.2)),
    "rod": lambda: trimesh.creation.cylinder(0.1, 2.0),
    "needle": lambda: trimesh.creation.cylinder(0.003, 0.4, sections=64),
    "hull of noise": lambda: trimesh.convex.convex_hull(np.random.default_rng(3).normal(size=(2000, 3))),
}
OTHERS = {
    "ring": lambda: trimesh.creation.annulus(0.5, 1.0, 0.3),
    "open box": lambda: trimesh.creation.box((1, 1, 1)).slice_plane((0, 0, 0), (0, 0, 1)),
    "two balls": lambda: trimesh.util.concatenate(
        [trimesh.creation.icosphere(), trimesh.creation.icosphere().apply_translation((3, 0, 0))]
    ),
    "hollow box": lambda: trimesh.util.concatenate(
        [trimesh.creation.box((1, 1, 1)), _inside_out(trimesh.creation.box((0.9, 0.9, 0.9)))]
    ),
    "dented ball": lambda: _dented(trimesh.creation.icosphere(subdivisions=2), 0.1),
}


def _inside_out(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    mesh.invert()
    return mesh


def _dented(mesh: trimesh.Trimesh, depth: float) -> trimesh.Trimesh:
    mesh.vertices[7] *= 1.0 - depth
    return mesh


def _mesh(name: str) -> TriMesh:
    made = (CONVEX | OTHERS)[name]()
    return TriMesh.of(made.vertices, made.faces)


def _diagonal(mesh: TriMesh) -> float:
    return float(np.linalg.norm(np.subtract(*mesh.bounds)))


@pytest.mark.parametrize("name", [*CONVEX, *OTHERS])
@pytest.mark.parametrize("dent", [1e-7, 1e-4])
def test_convex(name: str, dent: float) -> None:
    """Convexity of known shapes in any pose and size on the grid; an inverted mesh is not convex."""
    mesh = _mesh(name)
    for scale in (1e-1, 1.0, 30.0):
        moved = TriMesh.of(mesh.vertices * scale, mesh.faces).moved(TURNED)
        assert is_convex(moved, dent * _diagonal(moved)) == (name in CONVEX)
        assert not is_convex(TriMesh.of(moved.vertices, moved.faces[:, ::-1]), dent * _diagonal(moved))


def test_convex_but_for_a_dent() -> None:
    """A dent counts if it is deeper than the given depth."""
    for depth in (1e-6, 1e-4, 1e-2):
        mesh = dented_box(depth)
        assert is_watertight(mesh.faces)
        assert not is_convex(mesh, 0.5 * depth)
        assert is_convex(mesh, 2.0 * depth)


@pytest.mark.parametrize("facets", [10, 100, 2000])
def test_hollow_is_found_however_fine_the_mesh(facets: int) -> None:
    """A trough 13 mm deep is concave, although the edges of its facets are reflex by nanometres."""
    mesh = trough(facets)
    assert is_watertight(mesh.faces)
    assert not is_convex(mesh, 1e-4 * _diagonal(mesh))


@pytest.mark.parametrize("name", [*CONVEX, *OTHERS])
def test_watertight_as_trimesh_finds(name: str) -> None:
    """Watertightness agrees with trimesh, also with a face flipped, missing or repeated."""
    mesh = _mesh(name)
    faces = mesh.faces
    turned = np.concatenate([faces[:1, ::-1], faces[1:]])
    for changed in (faces, turned, faces[1:], np.concatenate([faces, faces[:1]])):
        seen = trimesh.Trimesh(mesh.vertices, changed, process=False)
        assert is_watertight(changed) == (seen.is_watertight and seen.is_winding_consistent)


def test_no_faces_are_not_watertight() -> None:
    """A mesh without faces is not watertight."""
    assert not is_watertight(np.empty((0, 3), np.int32))


def test_encloses() -> None:
    """Points inside a tetrahedron are distinguished from those outside, at any distance, also with inverted faces."""
    for mesh in (TETRAHEDRON, TriMesh.of(TETRAHEDRON.vertices, TETRAHEDRON.faces[:, ::-1])):
        assert encloses(mesh, (0.25, 0.25, 0.25))
        assert encloses(mesh, (0.3333, 0.3333, 0.3333))
        assert not encloses(mesh, (0.3334, 0.3334, 0.3334))
        assert not encloses(mesh, (-1e-6, 0.2, 0.2))
        assert not encloses(mesh, (5, 5, 5))


def test_flat() -> None:
    """Coplanar vertices are flat in any pose; a plate a millimetre thick is not."""
    square = TriMesh.of([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    assert is_flat(square)
    assert is_flat(square.moved(TURNED))
    assert is_flat(TriMesh.of(np.zeros((5, 3)), [(0, 1, 2)]))
    assert is_flat(TriMesh.of(square.vertices[:3], [(0, 1, 2)]))
    assert not is_flat(_mesh("sheet").moved(TURNED))
