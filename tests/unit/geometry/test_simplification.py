"""Simplified meshes: budgets, borders, and deviations, against closed forms and trimesh's nearest points."""

import numpy as np
import pytest
import trimesh

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_distance import squared_distances
from stepbot.geometry.simplification import Simplification, TriangleBudget, Unit, simplified


def ours(mesh: trimesh.Trimesh) -> TriMesh:
    """A mesh of trimesh."""
    return TriMesh.of(mesh.vertices, mesh.faces)


def theirs(mesh: TriMesh) -> trimesh.Trimesh:
    """A mesh for trimesh."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def test_planes_are_reduced_to_their_corners() -> None:
    """A finely divided box becomes the twelve triangles of a box, without error."""
    fine = ours(trimesh.creation.box((0.1, 0.2, 0.3)).subdivide().subdivide().subdivide())
    made = simplified(TriangleBudget((Unit((fine,), 1),), 12))
    ((box,),) = made.units
    assert (made.triangles, len(box.faces), made.deviation) == (12, 12, pytest.approx(0.0, abs=1e-8))
    assert theirs(box).is_watertight
    assert theirs(box).volume == pytest.approx(0.006, rel=1e-12)
    np.testing.assert_array_equal(np.unique(np.abs(box.vertices), axis=0), [(0.05, 0.1, 0.15)])


@pytest.mark.parametrize("most", [800, 100])
def test_a_sphere_stays_closed_within_the_deviation(most: int) -> None:
    """The budget is met, the surface stays closed, vertices are kept, and trimesh finds the same deviation."""
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    made = simplified(TriangleBudget((Unit((ours(sphere),), 1),), most))
    ((mesh,),) = made.units
    coarse = theirs(mesh)
    assert 0.8 * most <= len(mesh.faces) == made.triangles <= most
    assert coarse.is_watertight
    assert coarse.is_winding_consistent
    assert coarse.euler_number == 2
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 0.1, atol=1e-9)
    fine = np.vstack([sphere.vertices, sphere.triangles_center])
    middles = np.vstack([coarse.triangles_center, coarse.vertices[coarse.edges_unique].mean(axis=1)])
    there = trimesh.proximity.closest_point(coarse, fine)[1].max()
    back = trimesh.proximity.closest_point(sphere, middles)[1].max()
    assert made.deviation == pytest.approx(max(there, back), abs=1e-7)
    assert made.deviation < 0.5 * np.sqrt(4 * np.pi * 0.01 / most)  # half the length of an edge


def test_budgets_share_one_error() -> None:
    """A large part keeps more triangles than a small one of the same shape, and a part drawn twice counts twice."""
    large, small = (ours(trimesh.creation.icosphere(subdivisions=3, radius=radius)) for radius in (0.1, 0.01))
    made = simplified(TriangleBudget((Unit((large,), 1), Unit((small,), 2)), 1000))
    counts = [len(mesh.faces) for (mesh,) in made.units]
    assert counts[0] > 3 * counts[1]
    assert counts[0] + 2 * counts[1] == made.triangles <= 1000


def test_colours_keep_their_common_border() -> None:
    """Two halves of a cylinder in two colours meet without a gap: together they are closed."""
    cylinder = trimesh.creation.cylinder(0.02, 0.1, sections=96)
    cylinder = cylinder.subdivide()
    low = cylinder.triangles_center[:, 2] < 0.0
    halves = tuple(ours(cylinder).subset(mask) for mask in (low, ~low))
    made = simplified(TriangleBudget((Unit(halves, 1),), 300))
    ((first, second),) = made.units
    both = trimesh.util.concatenate([theirs(first), theirs(second)])
    both.merge_vertices(digits_vertex=9)
    assert len(both.faces) == made.triangles <= 300
    assert both.is_watertight
    assert first.bounds[1][2] == pytest.approx(0.0, abs=made.deviation)
    assert second.bounds[0][2] == pytest.approx(0.0, abs=made.deviation)


def test_open_surfaces_keep_their_border() -> None:
    """A flat sheet becomes its rectangle, and a slit at its border stays."""
    grid = np.array([(x, y, 0.0) for y in range(9) for x in range(9)]) / 10.0
    cells = [
        (x + 9 * y, x + 9 * y + 1, x + 9 * y + 10, x + 9 * y + 9)
        for y in range(8)
        for x in range(8)
        if (x, y) != (3, 0)
    ]
    sheet = TriMesh.of(grid, [face for a, b, c, d in cells for face in ((a, b, c), (a, c, d))])
    state = Simplification.of(sheet)
    state.reduce(1e-6)
    mesh = theirs(state.piece(0))
    assert len(mesh.faces) == 6  # a polygon of eight corners
    assert mesh.area == pytest.approx(0.63, rel=1e-9)
    assert state.deviation() < 1e-9


def test_a_budget_that_cannot_be_met_is_reported() -> None:
    """The simplest closed form remains, with more triangles than allowed."""
    box = ours(trimesh.creation.box((0.1, 0.1, 0.1)))
    made = simplified(TriangleBudget((Unit((box,), 3),), 5))
    assert made.triangles > 5
    ((mesh,),) = made.units
    assert theirs(mesh).is_watertight


def test_distances_from_triangles() -> None:
    """Nearest points inside, at an edge and at a corner, and of a triangle without area."""
    triangle = np.array([[(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]])
    points = np.array([(0.2, 0.2, 3.0), (0.5, -2.0, 0.0), (-3.0, -4.0, 0.0), (1.0, 1.0, 0.0)])
    found = squared_distances(points, np.repeat(triangle, 4, axis=0))
    np.testing.assert_allclose(found, [9.0, 4.0, 25.0, 0.5])
    flat = np.array([[(0.0, 0, 0), (1, 0, 0), (2, 0, 0)]])
    np.testing.assert_allclose(squared_distances(np.array([(1.5, 1.0, 0.0)]), flat), [1.0])
