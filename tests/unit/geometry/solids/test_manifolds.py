"""Intersections of closed meshes against closed forms, and noise at touching faces."""

import numpy as np
import pytest

from stepbot.geometry.mesh import TriMesh, joined
from stepbot.geometry.solids.manifolds import Solid, convex_hull, joined_solid, union_volume
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from tests.unit.assemble.workshop import BOX_FACES, CORNERS, rod_mesh


def box_mesh(x: float, y: float, z: float) -> TriMesh:
    """A box around the origin."""
    return TriMesh.of(CORNERS * (x, y, z), BOX_FACES)


def _box(x: float, y: float, z: float) -> Solid:
    return Solid(box_mesh(x, y, z))


def _shell(size: float, void: float) -> TriMesh:
    """A cube around a void."""
    return joined([box_mesh(size, size, size), TriMesh.of(CORNERS * void, np.array(BOX_FACES)[:, ::-1])])


def _tube(outer: float, inner: float, length: float, sides: int) -> Solid:
    """A tube along z, both circles with corners on the x axis."""
    return Solid(_tube_mesh(outer, inner, length, sides))


def _tube_mesh(outer: float, inner: float, length: float, sides: int) -> TriMesh:
    """The mesh of :func:`_tube`."""
    angles = 2 * np.pi * np.arange(sides) / sides
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = [
        np.column_stack([radius * circle, np.full(sides, z)])
        for radius, z in ((outer, -length / 2), (outer, length / 2), (inner, length / 2), (inner, -length / 2))
    ]
    faces = []
    for ring in range(4):
        a, b = ring * sides, (ring + 1) % 4 * sides
        for i in range(sides):
            j = (i + 1) % sides
            faces += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
    return TriMesh.of(np.vstack(rings), faces)


def test_boxes_have_a_box_in_common() -> None:
    """The intersection of two boxes, one rotated by a quarter turn and shifted, is a box."""
    common = _box(4, 2, 2).intersection(_box(2, 6, 2), Pose.from_xyz_rpy((1, 0, 0.5), (0, 0, np.pi / 2)))
    # The second box is 6 long along x there, 2 wide along y, and 0.5 higher.
    assert common.volume == pytest.approx(4 * 2 * 1.5, rel=1e-9)


def test_turned_boxes() -> None:
    """The intersection of a unit cube and its copy rotated by 45 degrees about z is a regular octagonal prism."""
    common = _box(1, 1, 1).intersection(_box(1, 1, 1), Pose.from_xyz_rpy((0, 0, 0), (0, 0, np.pi / 4)))
    assert common.volume == pytest.approx(2 * (np.sqrt(2) - 1), rel=1e-8)


def test_a_body_within_another() -> None:
    """The intersection of a rod with a box around it is the rod."""
    rod = Solid(rod_mesh(0.1, 0.5, 32))
    assert _box(2, 2, 2).may_meet(rod, IDENTITY)
    assert _box(2, 2, 2).intersection(rod, IDENTITY).volume == pytest.approx(
        0.5 * 32 * 0.01 * np.sin(2 * np.pi / 32) * 0.5, rel=1e-6
    )


@pytest.mark.parametrize(
    ("mesh", "X_AB", "meets"),
    [
        (rod_mesh(0.2, 1.0, 24), IDENTITY, False),  # in the bore
        (rod_mesh(0.2, 1.0, 24), Pose.of(position=(0.4, 0, 0)), True),  # through the wall
        (rod_mesh(0.02, 0.1, 24), Pose.of(position=(0.55, 0, 0)), True),  # all within the wall
        (box_mesh(2, 2, 2), IDENTITY, True),  # all around it
        (box_mesh(2, 2, 2), Pose.of(position=(0, 0, 1.5)), False),  # on it
        (box_mesh(2, 2, 2), Pose.of(position=(0, 0, 3)), False),  # above it
        (box_mesh(0.1, 0.1, 3), Pose.from_xyz_rpy((0.85, 0.85, 0), (0, 0, 0.5)), False),  # in the corner of its box
    ],
)
def test_separate_bodies_are_recognized_without_intersecting(mesh: TriMesh, X_AB: Pose, meets: bool) -> None:
    """A tube and bodies in, on, around and beside it: those classified as separate do not intersect."""
    tube, other = _tube(0.7, 0.4, 1.0, 24), Solid(mesh)
    assert tube.may_meet(other, X_AB) == meets
    assert other.may_meet(tube, X_AB.inverse()) == meets
    assert (tube.intersection(other, X_AB).volume > 1e-9) == meets


@pytest.mark.parametrize("sides", [8, 16, 24, 60])
@pytest.mark.parametrize("turn", [0.0, 0.3, 0.5])
def test_a_pin_that_fills_its_bore_is_noise(sides: int, turn: float) -> None:
    """A pin meshed as a prism, rotated against the prism of its bore, overlaps the wall by less than its noise."""
    step = 2 * np.pi / sides
    X_AB = Pose.from_xyz_rpy((0, 0, 0), (0, 0, turn * step))
    common = _tube(0.02, 0.01, 0.05, sides).intersection(Solid(rod_mesh(0.01, 0.05, sides)), X_AB)
    sagitta = 0.01 * (1 - np.cos(step / 2))
    if turn == 0.5:  # each corner of the pin is in the wall by the sagitta
        assert common.volume == pytest.approx(sides * sagitta**2 / np.tan(step / 2) * 0.05, rel=1e-3)
    assert common.volume < common.noise


def test_noise_is_small_against_an_overlap() -> None:
    """A pin half a millimetre too thick for its bore overlaps by more than noise, at any rotation."""
    sides, turn = 24, np.pi / 24
    tube, pin = _tube(0.02, 0.0095, 0.05, sides), Solid(rod_mesh(0.01, 0.05, sides))
    common = tube.intersection(pin, Pose.from_xyz_rpy((0, 0, 0), (0, 0, turn)))
    assert common.volume == pytest.approx(np.pi * (0.01**2 - 0.0095**2) * 0.05, rel=0.02)
    assert common.noise < common.volume


def test_flat_faces_make_no_noise() -> None:
    """The noise of two boxes that overlap by a tenth of a millimetre is far below the overlap."""
    common = _box(0.1, 0.1, 0.1).intersection(_box(0.1, 0.1, 0.1), Pose.of(position=(0, 0, 0.0999)))
    assert common.volume == pytest.approx(1e-6, rel=1e-5)
    assert common.noise == pytest.approx(1e-8, rel=0.01)


def test_sagittas_of_a_cylinder() -> None:
    """The strips of a prism are r (1 - cos(t / 2)) off its cylinder, its flat ends 0."""
    sides, radius = 24, 0.3
    solid = Solid(rod_mesh(radius, 0.2, sides))
    expected = radius * (1 - np.cos(np.pi / sides))
    assert np.unique(solid.sagittas.round(8)).tolist() == pytest.approx([0.0, expected], abs=2e-8)
    assert (solid.sagittas > 0).sum() == 2 * sides


def test_union_counts_once() -> None:
    """The union of two intersections that overlap by half has the volume of three halves."""
    cube = _box(1, 1, 1)
    common = cube.intersection(cube, IDENTITY)
    assert union_volume([(common.mesh, IDENTITY), (common.mesh, Pose.of(position=(0.5, 0, 0)))]) == pytest.approx(1.5)


def test_voids_are_filled() -> None:
    """A union has neither voids nor what is in them; a rod in an open bore is part of it."""
    parts = (
        (_shell(1.0, 0.8), IDENTITY),
        (_shell(0.4, 0.3), Pose.of(position=(0.1, 0.0, 0.0))),
        (box_mesh(0.1, 0.1, 0.1), Pose.of(position=(0.1, 0.0, 0.0))),
        (box_mesh(0.3, 0.1, 0.1), Pose.of(position=(0.5, 0.0, 0.0))),
        (_tube_mesh(0.5, 0.3, 1.0, 24), Pose.of(position=(5.0, 0.0, 0.0))),
        (rod_mesh(0.1, 0.5, 24), Pose.of(position=(5.0, 0.0, 0.0))),
    )
    made, left_out = joined_solid(parts)
    circle = 0.5 * 24 * np.sin(2 * np.pi / 24)
    outside = 0.15 * 0.1 * 0.1 + circle * (0.5**2 - 0.3**2) * 1.0 + circle * 0.1**2 * 0.5
    assert made is not None
    assert made.volume() == pytest.approx(1.0 + outside, rel=1e-6)
    assert len(made.decompose()) == 3
    assert left_out == ()


def test_a_mesh_that_does_not_close_is_not_sound() -> None:
    """A box without a face is not sound; a whole one is."""
    assert _box(1, 1, 1).is_sound
    assert not Solid(TriMesh.of(CORNERS, BOX_FACES[1:])).is_sound


def _points_on_a_sphere(radius: float, count: int) -> Array:
    """Points (count, 3) on a sphere, on the grid of nanometres."""
    points = np.random.default_rng(5).normal(size=(count, 3))
    return np.round(radius * points / np.linalg.norm(points, axis=1)[:, None], 9)


def test_hull_is_the_same_in_every_run() -> None:
    """The order of faces of a large hull is deterministic, although manifold3d's depends on threads."""
    points = _points_on_a_sphere(0.1, 5000)
    hulls = [convex_hull(points) for _ in range(10)]
    assert len({hull.vertices.tobytes() + hull.faces.tobytes() for hull in hulls if hull}) == 1


def test_hull_has_one_order() -> None:
    """Vertices are sorted by x, y and z; faces start with their lowest vertex and are sorted by their vertices."""
    hull = convex_hull(_points_on_a_sphere(0.1, 300))
    assert hull is not None
    assert hull.vertices.tolist() == sorted(hull.vertices.tolist())
    assert hull.faces.tolist() == sorted(hull.faces.tolist())
    assert all(face[0] == min(face) for face in hull.faces.tolist())


@pytest.mark.slow
@pytest.mark.parametrize("inside", [0, 2000])
def test_hull_is_closed_and_convex_and_encloses_its_points(inside: int) -> None:
    """Every edge joins two faces that run along it in opposite directions; no point is in front of a face."""
    outer = _points_on_a_sphere(0.1, 3000)
    points = np.vstack([_points_on_a_sphere(0.05, inside), outer]) if inside else outer
    hull = convex_hull(points)
    assert hull is not None
    # All points of a sphere are corners of their hull: by Euler's formula it has 2 n - 4 faces.
    assert sorted(hull.vertices.tolist()) == sorted(outer.tolist())
    assert len(hull.faces) == 2 * len(outer) - 4
    sides = [(a, b) for face in hull.faces.tolist() for a, b in zip(face, face[1:] + face[:1], strict=True)]
    assert len(set(sides)) == len(sides)
    assert {(b, a) for a, b in sides} == set(sides)
    a, b, c = (hull.vertices[hull.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heights = points @ normals.T - np.einsum("ij,ij->i", a, normals)
    assert heights.max() < 1e-9


def test_hull_of_a_box_is_the_box() -> None:
    """Points within, on edges and on faces of a box do not change its hull."""
    steps = np.linspace(-0.5, 0.5, 9)
    points = np.array(np.meshgrid(2 * steps, 3 * steps, 4 * steps)).reshape(3, -1).T
    hull = convex_hull(np.random.default_rng(2).permutation(points))
    assert hull is not None
    corners = {(x, y, z) for x in (-1.0, 1.0) for y in (-1.5, 1.5) for z in (-2.0, 2.0)}
    assert corners <= set(map(tuple, hull.vertices.tolist()))
    a, b, c = (hull.vertices[hull.faces[:, i]] for i in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(24.0, rel=1e-12)
