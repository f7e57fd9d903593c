"""Meshes that collision shapes enclose, against closed forms."""

from math import cos, pi, sin

import numpy as np
import pytest

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import Box, Capsule, Cylinder, Primitive, Sphere
from stepbot.geometry.solids.collision_sets import enclosed_meshes
from stepbot.geometry.solids.unions import PlacedShape, PlacedSolid
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from tests.unit.assemble.workshop import BOX_FACES, CORNERS

_AWAY = Pose.from_xyz_rpy((0.3, -0.2, 0.1), (0.4, 0.5, 0.6))
_FLUSH = Pose.from_xyz_rpy((0.3, -0.2, 0.1), (pi / 2, 0, 0))


def _open_box(*size: float) -> TriMesh:
    """A box without two of its triangles."""
    return TriMesh.of(CORNERS * size, BOX_FACES[:-2])


def _is_enclosed(mesh: TriMesh, *shapes: PlacedShape, X_AC: Pose = IDENTITY) -> bool:
    return enclosed_meshes([PlacedSolid(mesh, X_AC)], shapes) == (0,)


@pytest.mark.parametrize("pose", [_AWAY, _FLUSH])
@pytest.mark.parametrize(("extra", "is_enclosed"), [(-1e-3, True), (0.0, True), (1e-6, False), (1e-3, False)])
def test_box_in_a_box(pose: Pose, extra: float, is_enclosed: bool) -> None:
    """An open box inside a box counts, one with the same faces too; a micrometre outside does not."""
    box = PlacedShape(Box((0.1, 0.1, 0.1)), pose)
    assert _is_enclosed(_open_box(0.1, 0.1, 0.1 + 2 * extra), box, X_AC=pose) == is_enclosed


def test_mesh_across_two_shapes() -> None:
    """Two boxes that share a face enclose what reaches from one into the other, and neither does alone."""
    halves = [PlacedShape(Box((0.1, 0.1, 0.1)), _AWAY @ Pose.of(position=(x, 0, 0))) for x in (-0.05, 0.05)]
    across = _open_box(0.12, 0.02, 0.02)
    assert _is_enclosed(across, *halves, X_AC=_AWAY)
    assert not any(_is_enclosed(across, half, X_AC=_AWAY) for half in halves)


def _rods(angle: float) -> Array:
    """The corners of a box whose edges touch a cylinder of radius 0.05 m at an angle, and are 0.02 m long."""
    x, y = 0.05 * cos(angle), 0.05 * sin(angle)
    return np.array([(sx * x, sy * y, z) for sx in (-1, 1) for sy in (-1, 1) for z in (-0.01, 0.01)])


@pytest.mark.parametrize(
    ("shape", "reach"),
    [(Cylinder(0.05, 0.02), 0.05), (Sphere(0.05), (0.05**2 - 0.01**2) ** 0.5), (Capsule(0.05, 0.02), 0.05)],
)
@pytest.mark.parametrize("angle", [0.3, 0.7, 1.1])
def test_round_shapes(shape: Primitive, reach: float, angle: float) -> None:
    """Edges that reach 1 % of the radius less far are inside, those that reach 1 µm farther are outside."""
    points = _rods(angle)
    for factor, is_enclosed in ((0.99 * reach / 0.05, True), ((reach + 1e-6) / 0.05, False)):
        mesh = TriMesh.of(points * (factor, factor, 1.0 - 1e-6), BOX_FACES)
        assert _is_enclosed(mesh, PlacedShape(shape, IDENTITY)) == is_enclosed


def test_flat_mesh_is_not_enclosed() -> None:
    """A flat sheet has no hull, and is reported elsewhere."""
    sheet = TriMesh.of(np.array([(0, 0, 0), (0.01, 0, 0), (0, 0.01, 0)]), np.array([(0, 1, 2)]))
    assert not _is_enclosed(sheet, PlacedShape(Box((0.1, 0.1, 0.1)), IDENTITY))


def test_each_mesh_counts_for_itself() -> None:
    """The indices are those of the meshes inside; without shapes there are none."""
    box, small = PlacedShape(Box((0.1, 0.1, 0.1)), IDENTITY), _open_box(0.01, 0.01, 0.01)
    meshes = [PlacedSolid(small, Pose.of(position=(x, 0, 0))) for x in (0.2, 0.0, 0.048, 0.04)]
    assert enclosed_meshes(meshes, [box]) == (1, 3)
    assert enclosed_meshes(meshes, []) == ()
