"""Meshes for a page: below their budget, and as close to the exact ones as stated."""

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.report.robot import Check, Report, Status
from stepbot.robot.model import Link, MeshAsset, MeshRef, Robot, Visual
from stepbot.viewing.report.page import clustered, reduced
from stepbot.viewing.report.result_tables import deviations_plot


def robot_of(*meshes: trimesh.Trimesh) -> Robot:
    """A robot of one link."""
    assets = tuple(MeshAsset(f"mesh_{i}", TriMesh.of(m.vertices, m.faces)) for i, m in enumerate(meshes))
    visuals = tuple(Visual(f"visual_{i}", MeshRef(asset.name)) for i, asset in enumerate(assets))
    return Robot("robot", (Link("base", visuals=visuals),), meshes=assets)


def test_small_meshes_are_displayed_as_they_are() -> None:
    """Only rounded to a 65535th of their box."""
    robot = robot_of(trimesh.creation.box(extents=(0.3, 0.4, 1.2)))
    shown = reduced(robot)
    np.testing.assert_array_equal(shown.robot.meshes[0].mesh.vertices, robot.meshes[0].mesh.vertices)
    assert shown.displayed == shown.faces == 12
    assert shown.deviation == pytest.approx(1.3 / 65535 / 2)


@pytest.mark.slow
def test_large_meshes_fit_the_budget_and_keep_their_bound() -> None:
    """Every point of the exact meshes is within the stated distance of a displayed one, as trimesh measures it."""
    ball = trimesh.creation.icosphere(5, radius=0.2)
    ring = trimesh.creation.torus(0.3, 0.05, 128, 64)
    shown = reduced(robot_of(ball, ring), budget=100_000)
    size = sum(8 * len(asset.mesh.vertices) + 8 * len(asset.mesh.faces) for asset in shown.robot.meshes)
    assert 30_000 < size <= 100_000
    assert shown.displayed < shown.faces == len(ball.faces) + len(ring.faces)
    assert 0.0 < shown.deviation < 0.03
    for exact, asset in zip((ball, ring), shown.robot.meshes, strict=True):
        displayed = trimesh.Trimesh(asset.mesh.vertices, asset.mesh.faces, process=False)
        points = np.vstack([exact.vertices, exact.triangles_center])[::7]
        _, distances, _ = trimesh.proximity.closest_point(displayed, points)
        assert distances.max() <= shown.deviation


def test_a_part_smaller_than_a_cell_does_not_disappear() -> None:
    """A triangle remains, and the deviation says that the rest may be missing."""
    box = trimesh.creation.box(extents=(1e-3, 1e-3, 1e-3))
    mesh, moved = clustered(TriMesh.of(box.vertices + 0.43, box.faces), 0.1)
    assert len(mesh.faces) == 1
    assert moved == pytest.approx(3**0.5 * 1e-3)


def test_an_empty_mesh_stays_empty() -> None:
    """A wire has no faces."""
    mesh, moved = clustered(TriMesh.of(np.zeros((0, 3)), np.zeros((0, 3))), 0.1)
    assert (len(mesh.faces), moved) == (0, 0.0)


def check(deviation: float, status: Status = Status.PASSED) -> Check:
    """A check with a tolerance of 1e-6."""
    return Check("arm.urdf", "urdf", "mujoco", "mass", status, deviation, 1e-6, "kg", "arm")


def places(report: Report) -> tuple[list[float], float]:
    """x of every dot, and of the line at the tolerance."""
    from lxml import html

    drawing = html.fromstring(str(deviations_plot(report)))
    return [float(dot.get("cx")) for dot in drawing.xpath("//circle")], float(
        drawing.xpath("//line[@class='limit']/@x1")[0]
    )


def test_dots_are_at_their_deviation() -> None:
    """On a logarithmic scale: equal factors are equal distances, the tolerance is the line."""
    dots, limit = places(Report((check(1e-6), check(1e-8), check(1e-10), check(2e-6, Status.FAILED))))
    assert dots[0] == limit
    assert dots[0] - dots[1] == pytest.approx(dots[1] - dots[2], abs=0.11)
    assert dots[3] > limit


def test_a_check_without_deviation_is_at_the_left() -> None:
    """Exactly equal values have no logarithm."""
    dots, limit = places(Report((check(0.0), check(1e-30), check(1e-9))))
    assert dots[0] == dots[1] < dots[2] < limit
    unmeasured = replace(check(0.0), deviation=None)
    assert deviations_plot(Report((unmeasured,))) is None
