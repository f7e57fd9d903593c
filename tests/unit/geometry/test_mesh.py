"""Triangle meshes and their bytes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.geometry.mesh import GRID_PER_METRE, TriMesh, joined, obj_bytes
from stepbot.geometry.spatial import Pose

TETRAHEDRON = TriMesh.of([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def read_obj(content: bytes) -> tuple[str, np.ndarray, np.ndarray]:
    """Object name, vertices and faces of an OBJ, by a simple parser."""
    words = [line.split(" ", 1) for line in content.decode().splitlines()]
    (name,) = [rest for key, rest in words if key == "o"]
    vertices = np.array([list(map(float, rest.split())) for key, rest in words if key == "v"])
    faces = np.array([list(map(int, rest.split())) for key, rest in words if key == "f"]) - 1
    return name, vertices, faces


@given(st.lists(st.tuples(*[st.floats(-1000, 1000)] * 3), min_size=4, max_size=20))
def test_obj_reads_back_to_the_same_doubles(points: list[tuple[float, float, float]]) -> None:
    """Every coordinate is on the grid of nanometres, and its text is read back as the same double."""
    mesh = TriMesh.of(points, [(0, 1, 2), (1, 2, 3)])
    name, vertices, faces = read_obj(obj_bytes(mesh, "part"))
    assert name == "part"
    np.testing.assert_array_equal(vertices, mesh.vertices)
    np.testing.assert_array_equal(faces, mesh.faces)
    np.testing.assert_array_equal(np.rint(vertices * GRID_PER_METRE) / GRID_PER_METRE, vertices)
    np.testing.assert_allclose(vertices, points, atol=0.51 / GRID_PER_METRE)


def test_last_bits_of_a_kernel_do_not_show() -> None:
    """Coordinates that differ by less than the grid have the same bytes, and zero has no sign."""
    moved = TriMesh.of(TETRAHEDRON.vertices + 1e-13, TETRAHEDRON.faces)
    signed = TriMesh.of(TETRAHEDRON.vertices * [-1, 1, 1], TETRAHEDRON.faces)
    assert obj_bytes(moved, "a") == obj_bytes(TETRAHEDRON, "a")
    assert b"-0" not in obj_bytes(signed, "a")


def test_triangle_gets_a_fourth_vertex() -> None:
    """A mesh of three vertices, which MuJoCo rejects, is written with the same surface and one more vertex."""
    triangle = TriMesh.of([(0, 0, 0), (3, 0, 0), (0, 3, 0)], [(0, 1, 2)])
    _, vertices, faces = read_obj(obj_bytes(triangle, "a"))
    np.testing.assert_array_equal(vertices, [(0, 0, 0), (3, 0, 0), (0, 3, 0), (1, 1, 0)])
    corners = vertices[faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    np.testing.assert_allclose(areas, [1.5, 1.5, 1.5])


def test_names_may_have_any_letters() -> None:
    """The name of the object is in UTF-8."""
    assert obj_bytes(TETRAHEDRON, "звено groß").decode().startswith("o звено groß\n")


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [([(0, 0, np.nan)], []), ([(0, 0, np.inf)], []), ([(0, 0, 0)], [(0, 0, 1)]), ([(0, 0, 0)], [(0, 0, -1)])],
)
def test_broken_meshes_are_refused(vertices: list[tuple[float, ...]], faces: list[tuple[int, ...]]) -> None:
    """Vertices must be finite, and faces must refer to vertices."""
    with pytest.raises(ValueError, match="vertex"):
        TriMesh.of(vertices, faces)


def test_meshes_cannot_be_changed() -> None:
    """Vertices and faces are read-only."""
    with pytest.raises(ValueError, match="read-only"):
        TETRAHEDRON.vertices[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        TETRAHEDRON.faces[0, 0] = 1


def test_moved_subset_and_joined() -> None:
    """Moving rotates and shifts, a subset keeps the vertices in use, joining concatenates."""
    turned = TETRAHEDRON.moved(Pose.from_xyz_rpy((1, 2, 3), (0, 0, np.pi / 2)))
    np.testing.assert_allclose(turned.vertices, [(1, 2, 3), (1, 3, 3), (0, 2, 3), (1, 2, 4)], atol=1e-15)
    half = TETRAHEDRON.subset(np.array([True, False, False, False]))
    np.testing.assert_array_equal(half.vertices[half.faces], TETRAHEDRON.vertices[TETRAHEDRON.faces[:1]])
    assert len(half.vertices) == 3
    both = joined([TETRAHEDRON, turned])
    np.testing.assert_array_equal(both.vertices[both.faces[4:]], turned.vertices[turned.faces])
    assert both.bounds == ((0.0, 0.0, 0.0), (1.0, 3.0, 4.0))
