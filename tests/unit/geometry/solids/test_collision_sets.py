"""Collision shapes of solids against closed forms, and the same bytes in every process."""

import os
import subprocess
import sys
from math import pi

import manifold3d
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh, joined
from stepbot.geometry.primitives import Box, Capsule, Cylinder, Sphere
from stepbot.geometry.solids.collision_scores import UnscoredSolids, collision_scores
from stepbot.geometry.solids.collision_sets import CollisionRequest, CollisionSet, bounded_hull, collision_sets
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.solids.primitive_fits import RoundFace
from stepbot.geometry.solids.unions import PlacedSolid
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from tests.conftest import ROOT
from tests.unit.assemble.workshop import BOX_FACES, CORNERS, rod_mesh

_AWAY = Pose.from_xyz_rpy((0.3, -0.2, 0.1), (0.4, 0.5, 0.6))


def _box(x: float, y: float, z: float, at: tuple[float, float, float] = (0, 0, 0)) -> PlacedSolid:
    return PlacedSolid(TriMesh.of(CORNERS * (x, y, z), BOX_FACES), Pose.of(position=at))


def _of(
    *solids: PlacedSolid,
    missing: float = 0.0,
    shafts: tuple[RoundFace, ...] = (),
    primitives: bool = True,
    max_hulls: int = 16,
    max_vertices: int = 64,
) -> CollisionSet:
    (made,) = collision_sets([CollisionRequest(solids, missing, shafts, (), primitives, 0.95, max_hulls, max_vertices)])
    return made


def _mesh(manifold: manifold3d.Manifold) -> TriMesh:
    mesh = manifold.to_mesh64()
    return TriMesh.of(np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts))


def _manifold(mesh: TriMesh) -> manifold3d.Manifold:
    return manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices.copy(), mesh.faces.astype(np.uint64)))


def _union(made: CollisionSet) -> manifold3d.Manifold:
    """The union of shapes that are hulls or boxes."""
    solids = []
    for shape in made.shapes:
        if isinstance(shape.geometry, TriMesh):
            solid = _manifold(shape.geometry)
        else:
            assert isinstance(shape.geometry, Box)
            solid = manifold3d.Manifold.cube(shape.geometry.size, True)
        solids.append(solid.transform(shape.X_AG.matrix[:3]))
    return manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)


def _l_bracket() -> tuple[PlacedSolid, PlacedSolid]:
    """Two plates, 50 x 40 x 5 mm and 5 x 40 x 30 mm, at a right angle."""
    return _box(0.05, 0.04, 0.005, (0.025, 0, 0.0025)), _box(0.005, 0.04, 0.035, (0.0025, 0, 0.0175))


def test_box_is_exact() -> None:
    """A box that is turned and moved becomes a box of its size at its pose."""
    made = _of(PlacedSolid(TriMesh.of(CORNERS * (0.03, 0.05, 0.02), BOX_FACES), _AWAY))
    (shape,) = made.shapes
    assert isinstance(shape.geometry, Box)
    assert sorted(shape.geometry.size) == pytest.approx([0.02, 0.03, 0.05], abs=3e-9)
    np.testing.assert_allclose(shape.X_AG.p, _AWAY.p, atol=3e-9)
    assert _union(made).volume() == pytest.approx(3e-5, rel=1e-6)


def test_cylinder_is_exact() -> None:
    """A coarse mesh of a cylinder becomes the cylinder of its face: exact radius, and the exact volume."""
    radius, length, sides = 0.0123, 0.0456, 24
    mesh = rod_mesh(radius, length, sides)
    area = 0.5 * sides * radius**2 * np.sin(2 * pi / sides)
    shaft = RoundFace(_AWAY.p, _AWAY.turn((0, 0, 1)), radius)
    made = _of(PlacedSolid(mesh, _AWAY), missing=(pi * radius**2 - area) * length, shafts=(shaft,))
    (shape,) = made.shapes
    assert isinstance(shape.geometry, Cylinder)
    assert shape.geometry.radius == radius
    assert shape.geometry.length == pytest.approx(length, abs=3e-9)
    np.testing.assert_allclose(np.abs(shape.X_AG.R[:, 2] @ _AWAY.R[:, 2]), 1.0, atol=1e-12)
    np.testing.assert_allclose(shape.X_AG.p, _AWAY.p, atol=3e-9)


@pytest.mark.slow
def test_sphere_and_capsule() -> None:
    """A ball becomes a sphere, a rod with round ends a capsule of its radius and length."""
    (ball,) = _of(PlacedSolid(_mesh(manifold3d.Manifold.sphere(0.02, 96)), _AWAY)).shapes
    assert isinstance(ball.geometry, Sphere)
    assert ball.geometry.radius == pytest.approx(0.02, abs=1e-8)
    ends = [manifold3d.Manifold.sphere(0.02, 96).translate((0, 0, z)) for z in (-0.04, 0.04)]
    (rod,) = _of(PlacedSolid(_mesh(manifold3d.Manifold.batch_hull(ends)), IDENTITY)).shapes
    assert isinstance(rod.geometry, Capsule)
    assert (rod.geometry.radius, rod.geometry.length) == pytest.approx((0.02, 0.08), abs=1e-6)


def test_nearly_convex_solid_is_one_hull() -> None:
    """A wedge fills its hull, but neither a box nor a cylinder: one hull with its corners and volume."""
    corners = np.array([[x, y, z] for x, z in ((0, 0), (0.04, 0), (0, 0.03)) for y in (0, 0.02)])
    wedge = convex_hull(corners)
    assert wedge is not None
    made = _of(PlacedSolid(wedge, IDENTITY))
    assert [len(_hull(made, 0).vertices)] == [6]
    assert _union(made).volume() == pytest.approx(0.5 * 0.04 * 0.03 * 0.02, rel=1e-6)


@pytest.mark.parametrize("primitives", [True, False])
def test_bracket_is_two_pieces(primitives: bool) -> None:
    """An L-bracket is cut at the plane of a face: two convex pieces whose union is the solid, exactly."""
    made = _of(*_l_bracket(), primitives=primitives)
    assert len(made.shapes) == 2
    assert {type(shape.geometry) for shape in made.shapes} == {Box if primitives else TriMesh}
    assert made.filled == pytest.approx(1.0, abs=1e-6)
    assert _union(made).volume() == pytest.approx(0.05 * 0.04 * 0.005 + 0.005 * 0.04 * 0.03, rel=1e-6)


def test_parts_inside_others_get_no_shape() -> None:
    """A housing with a closed void, a part in the void and a screw in the wall are one box."""
    housing = manifold3d.Manifold.cube((0.1, 0.1, 0.1), True) - manifold3d.Manifold.cube((0.08, 0.08, 0.08), True)
    made = _of(
        PlacedSolid(_mesh(housing), IDENTITY),
        _box(0.02, 0.02, 0.02),
        PlacedSolid(rod_mesh(0.001, 0.008, 16), Pose.of(position=(0, 0, 0.045))),
    )
    (shape,) = made.shapes
    assert isinstance(shape.geometry, Box)
    assert shape.geometry.size == pytest.approx((0.1, 0.1, 0.1), abs=3e-9)


def test_pieces_enclose_a_ring() -> None:
    """A ring, whose halves have no smaller hulls, is cut in pieces that fill 0.9 of their volume and enclose it."""
    ring = manifold3d.Manifold.cylinder(0.01, 0.05, 0.05, 96) - manifold3d.Manifold.cylinder(0.01, 0.03, 0.03, 96)
    solid = PlacedSolid(_mesh(ring), _AWAY)
    made = _of(solid, primitives=False)
    union = _union(made)
    placed = ring.transform(_AWAY.matrix[:3])
    assert 4 <= len(made.shapes) <= 16
    assert made.filled > 0.9
    assert (placed - union).volume() < 1e-6 * placed.volume()


def test_max_hulls() -> None:
    """The budget of pieces is kept, and the solid is enclosed all the same."""
    comb = [_box(0.005, 0.02, 0.03, (0.02 * i, 0, 0.015)) for i in range(6)]
    solids = (_box(0.12, 0.02, 0.005, (0.05, 0, 0)), *comb)
    free, bounded = _of(*solids, primitives=False), _of(*solids, primitives=False, max_hulls=3)
    assert len(free.shapes) == 7
    assert len(bounded.shapes) == 3
    assert bounded.filled < free.filled
    assert (_union(free) - _union(bounded)).volume() < 1e-6 * _union(free).volume()


def test_open_meshes_are_left_out() -> None:
    """A mesh that bounds no volume is named, and the shapes of the others are made."""
    open_box = TriMesh.of(CORNERS, BOX_FACES[:-1])
    made = _of(PlacedSolid(open_box, IDENTITY), _box(0.1, 0.1, 0.1))
    assert made.left_out == (0,)
    assert len(made.shapes) == 1


def test_hulls_beside_a_set_are_scored_with_it() -> None:
    """A cube, and 2 m apart the hull of an open one: half of the shapes is solid. With further shapes, no score."""
    cube, beside = _box(1, 1, 1), _box(1, 1, 1, (3, 0, 0))
    open_cube = PlacedSolid(TriMesh.of(beside.mesh.vertices, beside.mesh.faces[:-1]), beside.X_AC)
    wanted = CollisionRequest((cube,), 0.0, (), (), True, 0.95, 16, 64, (open_cube,))
    made, alone, unknown = collision_sets([wanted, replace(wanted, beside=()), replace(wanted, is_whole=False)])
    assert (made.score.iou, made.scored) == (pytest.approx(0.5, abs=1e-6), 2)
    assert made.score.overshoot == pytest.approx(3.0, abs=4e-3 * 3.0**0.5)
    assert (alone.score.iou, alone.scored) == (pytest.approx(1.0, abs=1e-6), 1)
    assert (unknown.score.iou, unknown.scored) == (None, 0)
    assert len(made.shapes) == len(alone.shapes) == len(unknown.shapes) == 1


def test_enclosed_meshes_get_no_hull() -> None:
    """An open cube inside a cube gets no hull, whether the link has further shapes or not; one beside it does."""
    open_cube = TriMesh.of(CORNERS, BOX_FACES[:-1])
    beside = (PlacedSolid(open_cube, Pose.of(position=(3, 0, 0))), PlacedSolid(open_cube, IDENTITY))
    wanted = CollisionRequest((_box(2, 2, 2),), 0.0, (), (), True, 0.95, 16, 64, beside)
    made, further = collision_sets([wanted, replace(wanted, is_whole=False)])
    assert made.enclosed == further.enclosed == (1,)
    assert (made.score.iou, made.scored) == (pytest.approx(8 / 9, abs=1e-6), 2)
    assert (further.score.iou, further.scored) == (None, 0)


def test_sets_are_scored() -> None:
    """A set has the score that its shapes have on their own, and sets made together are those made alone."""
    solids = (_l_bracket(), (_box(0.1, 0.1, 0.1),))
    wanted = [CollisionRequest(of, 0.0, (), (), True, 0.95, 16, 64) for of in solids]
    made = collision_sets(wanted)
    assert [one.score for one in made] == [one.score for alone in wanted for one in collision_sets([alone])]
    assert tuple(one.score for one in made) == collision_scores(
        [UnscoredSolids(of, 0.0, one.shapes) for of, one in zip(solids, made, strict=True)]
    )
    assert made[0].score.iou == pytest.approx(1.0, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("primitives", [True, False])
def test_score_of_shapes_that_enclose(primitives: bool) -> None:
    """The quotient of the volumes is the intersection over union that Booleans measure."""
    ring = manifold3d.Manifold.cylinder(0.01, 0.05, 0.05, 96) - manifold3d.Manifold.cylinder(0.01, 0.03, 0.03, 96)
    cap = manifold3d.Manifold.sphere(0.02, 64).translate((0.05, 0.0, 0.0))
    solids = (PlacedSolid(_mesh(ring + cap), _AWAY),)
    made = _of(*solids, primitives=primitives, max_vertices=16)
    (measured,) = collision_scores([UnscoredSolids(solids, 0.0, made.shapes)])
    assert measured.iou is not None
    assert 0.5 < measured.iou < 0.95
    # Primitives are prisms there, which do not enclose all of the solid.
    assert made.score.iou == pytest.approx(measured.iou, abs=1e-4 if primitives else 1e-6)
    assert made.score.overshoot == measured.overshoot


@pytest.mark.parametrize("seed", range(4))
def test_first_cut_is_the_best(seed: int) -> None:
    """Of all planes of faces and across a union of boxes, the first cut has the least volume of hulls."""
    random = np.random.default_rng(seed)
    lows = random.integers(0, 20, (4, 3)) / 100
    highs = lows + random.integers(4, 20, (4, 3)) / 100
    boxes = [
        manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low)) for low, high in zip(lows, highs, strict=True)
    ]
    solid = manifold3d.Manifold.batch_boolean(boxes, manifold3d.OpType.Add)
    mesh = _mesh(solid)
    corners = mesh.vertices[mesh.faces]
    volumes = []
    for axis in range(3):
        flat = np.ptp(corners[:, :, axis], axis=1) < 1e-6
        across = np.linspace(mesh.vertices[:, axis].min(), mesh.vertices[:, axis].max(), 6)[1:-1]
        for offset in {*corners[flat, 0, axis].round(6).tolist(), *across.tolist()}:
            above, below = lows.copy(), highs.copy()
            above[:, axis], below[:, axis] = above[:, axis].clip(min=offset), below[:, axis].clip(max=offset)
            volumes.append(_hull_of_boxes(above, highs) + _hull_of_boxes(lows, below))
    made = _of(PlacedSolid(mesh, IDENTITY), primitives=False, max_hulls=2)
    assert len(made.shapes) == 2
    assert made.filled == pytest.approx(solid.volume() / min(volumes), abs=2e-6)


def _hull_of_boxes(lows: Array, highs: Array) -> float:
    """Volume of the hull of those boxes that have one."""
    some = (highs - lows > 1e-9).all(axis=1)
    points = [low + (CORNERS + 0.5) * (high - low) for low, high in zip(lows[some], highs[some], strict=True)]
    return float(manifold3d.Manifold.hull_points(np.concatenate(points)).volume()) if points else 0.0


def _hull(made: CollisionSet, index: int) -> TriMesh:
    geometry = made.shapes[index].geometry
    assert isinstance(geometry, TriMesh)
    return geometry


def _ellipsoid() -> Array:
    points = np.random.default_rng(7).normal(size=(600, 3))
    return np.asarray(points / np.linalg.norm(points, axis=1)[:, None] * (0.05, 0.02, 0.03))


@pytest.mark.parametrize(("max_vertices", "excess"), [(8, 1.2), (32, 0.4), (64, 0.2)])
def test_bounded_hull_encloses(max_vertices: int, excess: float) -> None:
    """A hull with fewer vertices encloses the hull, and more vertices are closer; by manifold3d's difference."""
    hull = convex_hull(_ellipsoid())
    assert hull is not None
    bounded = bounded_hull(hull, max_vertices)
    assert len(bounded.vertices) <= max_vertices
    inner, outer = _manifold(hull), _manifold(bounded)
    assert (inner - outer).volume() < 1e-7 * inner.volume()
    assert outer.volume() < (1.0 + excess) * inner.volume()


def test_bounded_prism() -> None:
    """A prism of 96 sides becomes one of at most 32 sides around it, with the same ends."""
    bounded = bounded_hull(rod_mesh(0.05, 0.1, 96), 64)
    assert len(bounded.vertices) <= 64
    assert np.ptp(bounded.vertices[:, 2]) == pytest.approx(0.1, abs=3e-9)
    # A regular n-gon around a circle has n / pi tan(pi / n) times its area.
    assert _manifold(bounded).volume() < 1.01 * 32 * np.tan(pi / 32) * 0.05**2 * 0.1


def test_small_hulls_are_kept() -> None:
    """A hull within the budget is returned as it is."""
    hull = convex_hull(CORNERS)
    assert hull is not None
    assert bounded_hull(hull, 8) is hull


_PRINT = """
import hashlib, numpy as np
from tests.unit.geometry.solids.test_collision_sets import several
digest = hashlib.sha256()
for made in several():
    for shape in made.shapes:
        digest.update(repr((type(shape.geometry).__name__, shape.X_AG)).encode())
        geometry = shape.geometry
        if hasattr(geometry, "vertices"):
            digest.update(geometry.vertices.tobytes() + geometry.faces.tobytes())
        else:
            digest.update(repr(geometry).encode())
print(digest.hexdigest())
"""


def several() -> tuple[CollisionSet, ...]:
    """Sets of solids with many faces, so that manifold3d uses several threads."""
    ball = _mesh(manifold3d.Manifold.sphere(0.05, 200))
    pipe = manifold3d.Manifold.cylinder(0.1, 0.03, 0.03, 300) - manifold3d.Manifold.cylinder(0.1, 0.02, 0.02, 300)
    bent = joined([_mesh(pipe), _mesh(pipe.rotate((90, 0, 0)).translate((0, 0, 0.2)))])
    return (
        _of(PlacedSolid(ball, IDENTITY), _box(0.02, 0.02, 0.2), _box(0.2, 0.02, 0.02)),
        _of(PlacedSolid(bent, _AWAY), primitives=False),
        _of(PlacedSolid(_mesh(pipe), _AWAY)),
    )


@pytest.mark.long  # tests/cli/test_determinism.py compares a whole robot
def test_same_bytes_in_every_process() -> None:
    """Shapes are the same with one thread and with many, and with other hash seeds."""
    digests = set()
    for threads, seed in ((1, "1"), (os.cpu_count() or 2, "2")):
        code = f"import os\nif hasattr(os, 'sched_setaffinity'): os.sched_setaffinity(0, set(range({threads})))\n"
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, "-c", code + _PRINT], env=environment, capture_output=True, text=True, check=True
        )
        digests.add(done.stdout)
    assert len(digests) == 1
