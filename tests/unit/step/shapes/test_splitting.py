"""Meshes whose blocks touch along edges are split there, and become closed without changing shape."""

from collections.abc import Sequence

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from stepbot.step.shapes.splitting import split
from stepbot.step.shapes.stitching import Stitched

Cell = tuple[int, int, int]

QUADS = {  # the side of a unit cube that faces a direction, counter-clockwise from outside
    (-1, 0, 0): ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    (1, 0, 0): ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    (0, -1, 0): ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    (0, 1, 0): ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    (0, 0, -1): ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
    (0, 0, 1): ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
}


def cells(filled: Sequence[Cell]) -> Stitched:
    """The surface of unit cubes, with equal corners merged."""
    numbers: dict[Cell, int] = {}
    faces = []
    for cell in filled:
        for direction, quad in QUADS.items():
            if tuple(np.add(cell, direction)) not in filled:
                points = [tuple(np.add(cell, corner).tolist()) for corner in quad]
                a, b, c, d = (numbers.setdefault(point, len(numbers)) for point in points)
                faces += [(a, b, c), (a, c, d)]
    mesh = np.array(faces, dtype=np.int32)
    return Stitched(np.array(list(numbers), dtype=float), mesh, np.arange(len(mesh), dtype=np.int32), 0)


def seen_by_trimesh(mesh: Stitched) -> trimesh.Trimesh:
    """The mesh in trimesh, without merging."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


SLIT = [(0, 0, 0), (1, 1, 0), *((x, y, z) for z in (-1, 1) for x, y in ((0, 0), (0, 1), (1, 1)))]
TOUCHING = {
    "two blocks at an edge": [(0, 0, 0), (1, 1, 0)],
    "one block that touches itself": SLIT,
    "edges that follow each other": [(0, 0, 0), (1, 1, 0), (0, 0, 1), (1, 1, 1)],
    "edges of all directions": [(0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)],
}


@pytest.mark.parametrize("name", TOUCHING)
def test_touching_blocks_close(name: str) -> None:
    """The split mesh is closed in trimesh; volume, area and colours are unchanged."""
    before = cells(TOUCHING[name])
    assert not seen_by_trimesh(before).is_watertight
    after = split(before)
    seen = seen_by_trimesh(after)
    assert seen.is_watertight
    assert seen.is_winding_consistent
    assert seen.volume == pytest.approx(len(TOUCHING[name]), rel=1e-12)
    assert after.area == pytest.approx(before.area, rel=1e-12)
    areas = [np.bincount(m.places, seen_by_trimesh(m).area_faces, len(before.faces)) for m in (before, after)]
    np.testing.assert_allclose(areas[1], areas[0], rtol=1e-12)


@given(st.sets(st.tuples(*[st.integers(0, 3)] * 3), min_size=1), st.integers(0, 2**32 - 1))
def test_any_blocks_anyhow_turned_close(filled: set[Cell], seed: int) -> None:
    """For any arrangement of touching cubes the surface is closed and encloses all of them."""
    flat = cells(sorted(filled))
    R = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))[:3, :3]
    mesh = split(Stitched(flat.vertices @ R.T, flat.faces, flat.places, 0))
    assert seen_by_trimesh(mesh).is_watertight
    assert mesh.signed_volume == pytest.approx(len(filled), rel=1e-9)


def test_sound_meshes_stay_as_they_are() -> None:
    """A mesh with two faces at every edge, or an open one, is unchanged."""
    cube = cells([(0, 0, 0)])
    assert split(cube) is cube
    opened = Stitched(cube.vertices, cube.faces[2:], cube.places[2:], 0)
    assert split(opened) is opened
    nothing = Stitched(np.empty((0, 3)), np.empty((0, 3), np.int32), np.empty(0, np.int32), 0)
    assert split(nothing) is nothing


def test_folded_faces_stay_as_they_are() -> None:
    """Coincident faces, or three at an edge, are reported as not closed."""
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -1, 0)], dtype=float)
    for triangles in ([(0, 1, 2), (1, 0, 3), (0, 1, 4)], [(0, 1, 2), (1, 0, 2), (0, 1, 3), (1, 0, 3)]):
        mesh = Stitched(points, np.array(triangles, np.int32), np.arange(len(triangles), dtype=np.int32), 0)
        assert split(mesh) is mesh
