"""Hulls without triangles that have no area."""

import manifold3d
import numpy as np
import pytest
import trimesh

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.solids.slivers import without_slivers

PRISMS = [(7, 13), (12, 0), (21, 10), (25, 6), (30, 1)]
"""Numbers of sides and seeds of their directions."""


def prism(sides: int, seed: int) -> np.ndarray:
    """Vertices of a prism in any direction, on the grid, with two further vertices on each of its long edges."""
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    angles = np.arange(sides) * 2.0 * np.pi / sides
    ring = np.stack([0.01 * np.cos(angles), 0.01 * np.sin(angles)], axis=1)
    points = np.vstack([np.column_stack([ring, np.full(sides, z)]) for z in (-0.1, -0.03, 0.02, 0.1)])
    return np.asarray(np.rint(points @ turn.T * 1e9) / 1e9)


def raw_hull(points: np.ndarray) -> TriMesh:
    """The hull as manifold3d returns it."""
    mesh = manifold3d.Manifold.hull_points(np.ascontiguousarray(points)).to_mesh64()
    return TriMesh.of(np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts))


def least_height(mesh: TriMesh) -> float:
    """The smallest height [m] of a triangle, by trimesh."""
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    edges = np.linalg.norm(np.diff(other.triangles[:, [0, 1, 2, 0]], axis=1), axis=2)
    return float((2.0 * other.area_faces / edges.max(axis=1)).min())


@pytest.mark.parametrize(("sides", "seed"), PRISMS)
def test_hulls_have_no_triangle_without_area(sides: int, seed: int) -> None:
    """The surface stays closed, with the same vertices and the same volume."""
    points = prism(sides, seed)
    raw, hull = raw_hull(points), convex_hull(points)
    assert hull is not None
    assert least_height(hull) > 1e-5
    ours, theirs = (trimesh.Trimesh(mesh.vertices, mesh.faces, process=False) for mesh in (hull, raw))
    assert ours.is_watertight
    assert ours.is_winding_consistent
    assert ours.volume == pytest.approx(theirs.volume, rel=1e-8)
    np.testing.assert_array_equal(np.unique(hull.vertices, axis=0), np.unique(raw.vertices, axis=0))


def test_manifold3d_returns_such_triangles() -> None:
    """The hulls above have them as manifold3d returns them: otherwise nothing is tested."""
    assert all(least_height(raw_hull(prism(*one))) < 2e-9 for one in PRISMS)


def test_other_hulls_are_left_alone() -> None:
    """A hull without such triangles is returned as it is."""
    box = raw_hull(np.array(trimesh.creation.box((0.1, 0.2, 0.3)).vertices))
    assert without_slivers(box) is box
