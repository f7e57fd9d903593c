"""Faces are joined along shared edges, never by distance."""

import networkx as nx
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from stepbot.geometry.fixed_point import merged_labels
from stepbot.geometry.predicates import is_watertight
from stepbot.step.shapes.stitching import EdgeUse, FacetedFace, Stitched, merged_by_position, stitched

SQUARE = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def quad(place: int, *corners: tuple[float, float, float]) -> FacetedFace:
    """A face of two triangles with its own nodes."""
    return FacetedFace(place, np.array(corners), SQUARE)


CUBE = [
    [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)],
    [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
    [(1, 1, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1)],
    [(0, 1, 0), (0, 0, 0), (0, 0, 1), (0, 1, 1)],
    [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
]


def cube_uses(shift: dict[int, float]) -> tuple[list[FacetedFace], list[EdgeUse]]:
    """The faces of a cube, some shifted apart, and their shared edges."""
    edges: dict[frozenset[tuple[float, ...]], int] = {}
    vertices: dict[tuple[float, ...], int] = {}
    faces, uses = [], []
    for place, corners in enumerate(CUBE):
        moved = [(x + shift.get(place, 0.0), y, z) for x, y, z in corners]
        faces.append(quad(place, *moved))
        for k in range(4):
            a, b = corners[k], corners[(k + 1) % 4]
            edge = edges.setdefault(frozenset((a, b)), len(edges) + 1)
            ends = sorted([(a, k + 1), (b, (k + 1) % 4 + 1)])
            numbers = [vertices.setdefault(corner, len(vertices) + 1) for corner, _ in ends]
            uses.append(EdgeUse(place, edge, [node for _, node in ends], (numbers[0], numbers[1]), False))
    return faces, uses


def test_a_cube_closes() -> None:
    """Six faces with their own nodes become a closed cube of eight vertices and volume 1."""
    mesh = stitched(*cube_uses({}))
    assert len(mesh.vertices) == 8
    assert is_watertight(mesh.faces)
    assert mesh.open_edges == 0
    assert abs(mesh.signed_volume - 1.0) < 1e-12
    assert abs(mesh.turned().signed_volume + 1.0) < 1e-12


def test_it_closes_where_positions_differ() -> None:
    """Shared edges join by identity, so a slightly displaced face still closes the mesh."""
    mesh = stitched(*cube_uses({1: 1e-3}))
    assert len(mesh.vertices) == 8
    assert is_watertight(mesh.faces)


def test_faces_that_only_touch_stay_apart() -> None:
    """Coincident nodes without a shared edge are not joined."""
    faces = [quad(0, *CUBE[0]), quad(1, *CUBE[0])]
    mesh = stitched(faces, [])
    assert len(mesh.vertices) == 8


def test_an_open_box_is_open() -> None:
    """Without its lid the mesh is not watertight, and four edges have one face only."""
    faces, uses = cube_uses({})
    mesh = stitched(faces[1:], [use for use in uses if use.place != 0])
    assert not is_watertight(mesh.faces)
    assert mesh.open_edges == 4


def test_a_turned_face_is_not_watertight() -> None:
    """A mesh with a flipped face is not watertight, although all edges join two faces."""
    faces, uses = cube_uses({})
    faces[0] = FacetedFace(0, faces[0].nodes, faces[0].triangles[:, ::-1])
    assert not is_watertight(stitched(faces, uses).faces)


def test_points_collapse() -> None:
    """A degenerate edge merges its nodes, and degenerate triangles are dropped."""
    nodes = np.array([(0, 0, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)], dtype=np.float64)
    face = FacetedFace(0, nodes, np.array([[0, 2, 3], [0, 1, 2]], dtype=np.int32))
    mesh = stitched([face], [EdgeUse(0, 1, [1, 2], (1, 1), True)])
    assert mesh.faces.tolist() == [[0, 1, 2]]


def test_triangles_without_edges_join_by_position() -> None:
    """Tessellated faces are joined at equal coordinates, 0.0 and -0.0 included."""
    faces = [quad(place, *corners) for place, corners in enumerate(CUBE)]
    faces[0] = FacetedFace(0, -1.0 * (-faces[0].nodes), faces[0].triangles)
    mesh = merged_by_position(faces)
    assert len(mesh.vertices) == 8
    assert is_watertight(mesh.faces)
    assert mesh.places.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]


def test_no_faces() -> None:
    """A shape without triangles gives an empty mesh, which is not watertight."""
    mesh = stitched([], [])
    assert mesh.faces.shape == (0, 3)
    assert not is_watertight(mesh.faces)
    assert mesh.signed_volume == 0.0


PAIRS = st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), max_size=30)


@given(PAIRS)
def test_merged_labels_are_connected_components(pairs: list[tuple[int, int]]) -> None:
    """Labels equal those of a graph library, and each is the lowest of its component."""
    graph = nx.Graph()
    graph.add_nodes_from(range(20))
    graph.add_edges_from(pairs)
    expected = [min(nx.node_connected_component(graph, node)) for node in range(20)]
    left, right = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    assert merged_labels(20, left, right).tolist() == expected


@given(st.sets(st.integers(0, 79)))
def test_reversed_triangles_of_a_closed_surface_face_one_side_again(reversed_ones: set[int]) -> None:
    """Whichever of its triangles are reversed, a sphere has one side out; the first triangle stays as it is."""
    sphere = trimesh.creation.icosphere(subdivisions=1)
    faces = sphere.faces.astype(np.int32)
    wound = np.array([face[::-1] if i in reversed_ones else face for i, face in enumerate(faces)])
    found = Stitched(sphere.vertices, wound, np.zeros(80, dtype=np.int32), 0).consistent()
    assert found is not None
    assert is_watertight(found.faces)
    assert found.signed_volume * (-1.0 if 0 in reversed_ones else 1.0) > 0.0
    assert abs(abs(found.signed_volume) - sphere.volume) < 1e-12


@pytest.mark.parametrize("case", ["open", "two pieces", "three at an edge", "one side", "nothing"])
def test_surfaces_that_cannot_face_one_side(case: str) -> None:
    """They stay as they are: what is inside of them is not known."""
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], dtype=np.int32)
    faces = {
        "open": tetrahedron[:3],
        "two pieces": np.concatenate([tetrahedron, tetrahedron + 4]),
        "three at an edge": np.concatenate([tetrahedron, [[0, 1, 4], [1, 0, 4]]]),
        # a projective plane: ten triangles, each edge twice, and no two sides
        "one side": np.array(
            [
                [0, 1, 2],
                [0, 2, 3],
                [0, 3, 4],
                [0, 4, 5],
                [0, 5, 1],
                [1, 2, 4],
                [2, 3, 5],
                [3, 4, 1],
                [4, 5, 2],
                [5, 1, 3],
            ]
        ),
        "nothing": tetrahedron[:0],
    }[case].astype(np.int32)
    vertices = np.random.default_rng(1).normal(size=(8, 3))
    assert Stitched(vertices, faces, np.zeros(len(faces), dtype=np.int32), 0).consistent() is None
