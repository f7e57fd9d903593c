"""Equal meshes are merged without any other change of the robot."""

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.model import Box, Collision, Link, MeshAsset, MeshRef, Robot, Visual
from tests.conftest import ReadDiagnostics
from tests.robots import ROBOTS


def _mesh(size: float) -> TriMesh:
    return TriMesh.of(size * np.eye(4, 3), [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])


def test_equal_meshes_become_the_first(diagnostics: ReadDiagnostics) -> None:
    """References to the second of two equal meshes refer to the first, and the second is removed."""
    link = Link(
        "a",
        visuals=(Visual("u", MeshRef("bolt")), Visual("v", MeshRef("bolt_2")), Visual("w", MeshRef("nut"))),
        collisions=(Collision("c", MeshRef("bolt_2")), Collision("d", Box((1, 1, 1)))),
    )
    meshes = tuple(MeshAsset(name, _mesh(size)) for name, size in (("bolt", 1.0), ("bolt_2", 1.0), ("nut", 2.0)))
    robot = share_meshes(Robot("r", (link,), meshes=meshes))
    assert [visual.geometry for visual in robot.root.visuals] == [MeshRef("bolt"), MeshRef("bolt"), MeshRef("nut")]
    assert [shape.geometry for shape in robot.root.collisions] == [MeshRef("bolt"), Box((1, 1, 1))]
    assert [asset.name for asset in robot.meshes] == ["bolt", "nut"]


def test_unused_meshes_are_removed(diagnostics: ReadDiagnostics) -> None:
    """An unused mesh is removed."""
    assert share_meshes(Robot("r", (Link("a"),), meshes=(MeshAsset("m", _mesh(1.0)),))).meshes == ()


def _seen(robot: Robot) -> list[tuple[str, bytes]]:
    """Every shape with the bytes of its mesh."""
    return [
        (shape.name, robot.mesh_by_name[shape.geometry.name].mesh.vertices.tobytes())
        for link in robot.links
        for shape in (*link.visuals, *link.collisions)
        if isinstance(shape.geometry, MeshRef)
    ]


@pytest.mark.parametrize("name", list(ROBOTS))
def test_sharing_changes_nothing_that_is_seen(name: str) -> None:
    """With shared meshes every robot has the same links, joints and shapes, and its input is unchanged."""
    robot, untouched = ROBOTS[name](), ROBOTS[name]()
    after = share_meshes(robot)
    assert _seen(after) == _seen(robot) == _seen(untouched)
    assert robot.links == untouched.links
    assert after.joints == robot.joints
    assert [replace(link, visuals=(), collisions=()) for link in after.links] == [
        replace(link, visuals=(), collisions=()) for link in robot.links
    ]
    assert share_meshes(after).links == after.links
