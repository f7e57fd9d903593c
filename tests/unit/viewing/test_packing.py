"""Packed meshes."""

from base64 import b64decode

import numpy as np
import pytest

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array
from stepbot.viewing.scene import STEPS, packed
from tests.robots import ROBOTS


def unpacked(document: dict[str, object]) -> tuple[Array, Array]:
    """Vertices and faces of a packed mesh."""
    steps = np.frombuffer(b64decode(str(document["vertices"])), "<u2").reshape(-1, 3)
    faces = np.frombuffer(b64decode(str(document["faces"])), "<u4" if document["wide"] else "<u2").reshape(-1, 3)
    return np.array(document["low"]) + np.array(document["size"]) * steps / STEPS, faces


@pytest.mark.parametrize("name", ["pendulum", "stewart"])
def test_every_vertex_is_within_half_a_step(name: str) -> None:
    """Corners of triangles come back within half a step of the grid, in the same order."""
    for asset in ROBOTS[name]().meshes:
        vertices, faces = unpacked(packed(asset.mesh))
        step = np.ptp(asset.mesh.vertices, axis=0) / STEPS
        deviations = np.abs(vertices[faces] - asset.mesh.vertices[asset.mesh.faces])
        assert (deviations <= 0.5 * step + 1e-15).all()


def test_flat_and_empty_meshes() -> None:
    """A mesh without extent along an axis, and one without faces."""
    flat = TriMesh.of([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])
    vertices, faces = unpacked(packed(flat))
    assert vertices[faces[0]].tolist() == flat.vertices.tolist()
    _, faces = unpacked(packed(TriMesh.of([], [])))
    assert len(faces) == 0


def test_indices_of_many_vertices() -> None:
    """More vertices than two bytes can number."""
    count = 70_000
    points = np.column_stack([np.arange(count), np.arange(count) % 7, np.arange(count) % 5]) * 1e-3
    faces = np.column_stack([np.arange(count - 2), np.arange(1, count - 1), np.arange(2, count)])
    vertices, found = unpacked(packed(TriMesh.of(points, faces)))
    np.testing.assert_allclose(vertices[found], points[faces], rtol=0.0, atol=1e-3)


def test_repeated_vertices_become_one() -> None:
    """Two triangles with an edge in common, each with vertices of its own as in an STL file: four vertices are left."""
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    vertices, faces = unpacked(packed(TriMesh.of(corners, [[0, 1, 2], [3, 4, 5]])))
    assert len(vertices) == 4
    assert vertices[faces].reshape(-1, 3).tolist() == corners
