"""Intersection over union and overshoot of collision shapes against closed forms."""

from math import pi, sin

import manifold3d
import numpy as np
import pytest

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import Box, Capsule, Cylinder, Sphere
from stepbot.geometry.solids.collision_scores import CollisionScore, UnscoredSolids, collision_scores
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.solids.unions import PlacedShape, PlacedSolid
from stepbot.geometry.spatial import IDENTITY, Pose
from tests.unit.assemble.workshop import BOX_FACES, CORNERS, rod_mesh

_AWAY = Pose.from_xyz_rpy((0.3, -0.2, 0.1), (0.4, 0.5, 0.6))


def _box(x: float, y: float, z: float, at: tuple[float, float, float] = (0, 0, 0)) -> PlacedSolid:
    return PlacedSolid(TriMesh.of(CORNERS * (x, y, z), BOX_FACES), Pose.of(position=at))


def _score(solids: tuple[PlacedSolid, ...], *shapes: PlacedShape, missing: float = 0.0) -> CollisionScore:
    (score,) = collision_scores([UnscoredSolids(solids, missing, shapes)])
    return score


def test_cylinder_on_a_cylinder() -> None:
    """A cylinder around a coarse mesh of itself is exact: the volume that the mesh lacks counts."""
    radius, length, sides = 0.02, 0.05, 24
    missing = (pi - 0.5 * sides * sin(2 * pi / sides)) * radius**2 * length
    solid = PlacedSolid(rod_mesh(radius, length, sides), _AWAY)
    score = _score((solid,), PlacedShape(Cylinder(radius, length), _AWAY), missing=missing)
    assert score.iou == pytest.approx(1.0, abs=1e-4)
    assert score.overshoot == pytest.approx(radius * (1 - np.cos(pi / sides)), abs=3e-4)


def test_hull_of_a_bracket() -> None:
    """The hull of an L fills the triangle between its legs; its farthest point is equally far from both."""
    solids = (_box(0.05, 0.04, 0.005, (0.025, 0, 0.0025)), _box(0.005, 0.04, 0.035, (0.0025, 0, 0.0175)))
    hull = convex_hull(
        np.array([[x, y, z] for x, z in ((0, 0), (50, 0), (50, 5), (5, 35), (0, 35)) for y in (-20, 20)]) / 1e3
    )
    assert hull is not None
    score = _score(solids, PlacedShape(hull, IDENTITY))
    area, triangle = 0.05 * 0.005 + 0.005 * 0.03, 0.5 * 0.045 * 0.03
    assert score.iou == pytest.approx(area / (area + triangle), abs=2e-6)
    # x - 5 = z - 5 on the line from (50, 5) to (5, 35) mm: 18 mm from both legs; accurate to 0.4 % of the diagonal.
    assert score.overshoot == pytest.approx(0.018, abs=0.004 * 0.073)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Box((0.04, 0.04, 0.06)), 0.04 * 0.04 * 0.06),
        (Sphere(0.05), 4 / 3 * pi * 0.05**3),
        (Capsule(0.03, 0.04), pi * 0.03**2 * (0.04 + 4 / 3 * 0.03)),
    ],
)
def test_shapes_around_a_box(shape: Box | Sphere | Capsule, volume: float) -> None:
    """Of a shape that encloses a box, the intersection over union is the ratio of their volumes."""
    small = PlacedSolid(TriMesh.of(CORNERS * (0.03, 0.03, 0.03), BOX_FACES), _AWAY)
    assert _score((small,), PlacedShape(shape, _AWAY)).iou == pytest.approx(0.03**3 / volume, rel=2e-3)


def test_shapes_apart() -> None:
    """A shape 10 mm away from the solid has no intersection; its far face is 20 mm away."""
    score = _score((_box(0.01, 0.01, 0.01),), PlacedShape(Box((0.01, 0.01, 0.01)), Pose.of(position=(0.02, 0, 0))))
    assert score == CollisionScore(0.0, 0.02)


def test_nothing_to_score() -> None:
    """Without shapes, or with open meshes only, there is no score."""
    assert _score((_box(1, 1, 1),)) == CollisionScore()
    open_box = PlacedSolid(TriMesh.of(CORNERS, BOX_FACES[:-1]), IDENTITY)
    assert _score((open_box,), PlacedShape(Box((1, 1, 1)), IDENTITY)) == CollisionScore()


def test_mesh_that_is_not_convex() -> None:
    """A collision mesh counts as it is, not as its hull: the solid itself has no overshoot."""
    pipe = (
        manifold3d.Manifold.cylinder(0.1, 0.03, 0.03, 60) - manifold3d.Manifold.cylinder(0.1, 0.02, 0.02, 60)
    ).to_mesh64()
    mesh = TriMesh.of(np.asarray(pipe.vert_properties)[:, :3], np.asarray(pipe.tri_verts))
    score = _score((PlacedSolid(mesh, IDENTITY),), PlacedShape(mesh, IDENTITY))
    assert score.iou == pytest.approx(1.0, abs=1e-6)
    assert score.overshoot == pytest.approx(0.0, abs=1e-6)


@pytest.mark.slow
def test_overshoot_in_the_middle_of_a_face() -> None:
    """The lid of a pocket is as far away as the pocket is deep, though the solid has thousands of corners elsewhere."""
    cube = manifold3d.Manifold.cube((0.1, 0.1, 0.1), True)
    pocket = manifold3d.Manifold.cube((0.04, 0.04, 0.02), True).translate((0, 0, 0.05))
    bore = manifold3d.Manifold.cylinder(0.2, 0.001, 0.001, 2500, True).rotate((90, 0, 0))
    carved = (cube - pocket - bore).to_mesh64()
    mesh = TriMesh.of(np.asarray(carved.vert_properties)[:, :3], np.asarray(carved.tri_verts))
    score = _score((PlacedSolid(mesh, _AWAY),), PlacedShape(Box((0.1, 0.1, 0.1)), _AWAY))
    assert score.overshoot == pytest.approx(0.01, abs=0.004 * 0.1 * 3**0.5)
    assert score.iou == pytest.approx(1 - (0.04**2 * 0.01 + pi * 0.001**2 * 0.1) / 1e-3, rel=1e-6)
