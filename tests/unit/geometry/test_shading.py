"""Normals of corners, against those of the exact surfaces."""

import numpy as np
import pytest
import trimesh

from stepbot.geometry.shading import corner_normals


def normals_of(shape: trimesh.Trimesh) -> np.ndarray:
    """Shape (m, 3, 3)."""
    return corner_normals(shape.vertices, shape.faces.astype(np.int32))


@pytest.mark.parametrize("sections", [16, 24, 48])
def test_cylinder_has_the_normals_of_the_exact_cylinder(sections: int) -> None:
    """Radial on the side, however its facets are divided; axial on the caps, up to the sharp edge."""
    shape = trimesh.creation.cylinder(0.03, 0.2, sections=sections)
    normals, side = normals_of(shape), np.abs(shape.face_normals[:, 2]) < 0.5
    radial = shape.triangles * (1.0, 1.0, 0.0) / 0.03
    np.testing.assert_allclose(normals[side], radial[side], atol=1e-12)
    np.testing.assert_allclose(normals[~side], np.repeat(shape.face_normals[~side][:, None], 3, axis=1), atol=1e-12)


def test_sphere_has_the_normals_of_the_exact_sphere() -> None:
    """At irregular vertices, too: the weights are exact for points on a sphere."""
    points = np.random.default_rng(4).normal(size=(400, 3))
    shape = trimesh.convex.convex_hull(points / np.linalg.norm(points, axis=1)[:, None])
    normals = normals_of(shape)
    edges = np.abs(shape.face_adjacency_angles).max()
    assert edges < np.radians(32.0), "the mesh is too coarse for this test"
    np.testing.assert_allclose(normals, shape.triangles, atol=1e-12)


@pytest.mark.parametrize(("turn", "smooth"), [(31.0, True), (33.0, False)])
def test_edges_are_sharp_beyond_32_degrees(turn: float, smooth: bool) -> None:
    """Two faces share their normals at an edge of 31 degrees, and keep their own at one of 33."""
    angle = np.radians(turn)
    vertices = np.array([(0, 0, 0), (0, 1, 0), (-1, 0, 0), (np.cos(angle), 0, -np.sin(angle))], float)
    normals = corner_normals(vertices, np.array([(0, 1, 2), (0, 3, 1)], np.int32))
    own = np.array([(0, 0, 1), (np.sin(angle), 0, np.cos(angle))])
    between = (own[0] + own[1]) / np.linalg.norm(own[0] + own[1])
    np.testing.assert_allclose(normals[0, 0], between if smooth else own[0], atol=1e-12)
    np.testing.assert_allclose(normals[1, 1], own[1], atol=1e-12)


def test_corners_without_area_have_a_unit_normal() -> None:
    """Collinear vertices of a face, a vertex of no face, a mesh without faces."""
    vertices = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (5, 5, 5)], float)
    np.testing.assert_array_equal(corner_normals(vertices, np.array([(0, 1, 2)], np.int32)), [[(0, 0, 1)] * 3])
    assert corner_normals(vertices, np.empty((0, 3), np.int32)).shape == (0, 3, 3)
