"""Primitives enclose their points, and are the smallest ones where those are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from stepbot.geometry.enclosing_shapes import box_around, capsule_around, cylinder_around, smallest_ball, sphere_around
from stepbot.geometry.spatial import rotation_from_rpy
from tests.unit.assemble.workshop import CORNERS, rod_mesh

AXES = np.eye(3)


def test_smallest_ball_of_known_shapes() -> None:
    """The radius of the smallest ball is half the diagonal of a cube, or half the longest side of a triangle."""
    center, radius = smallest_ball(CORNERS + np.array([1, 2, 3]))
    np.testing.assert_allclose(center, (1, 2, 3), atol=1e-12)
    assert radius == pytest.approx(np.sqrt(3) / 2, rel=1e-12)
    center, radius = smallest_ball(np.array([[0.0, 0], [10, 0], [5, 1]]))
    np.testing.assert_allclose(center, (5, 0), atol=1e-12)
    assert radius == pytest.approx(5)
    assert smallest_ball(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))[1] == pytest.approx(np.sqrt(0.5))
    assert smallest_ball(np.zeros((5, 3)))[1] == 0.0


@given(arrays(np.float64, st.tuples(st.integers(1, 30), st.integers(2, 3)), elements=st.floats(-1, 1, width=32)))
def test_smallest_ball_encloses_and_is_held(points: np.ndarray) -> None:
    """The smallest ball encloses all points, and no ball with a slightly moved centre is smaller."""
    center, radius = smallest_ball(points)
    assert np.linalg.norm(points - center, axis=1).max() <= radius + 1e-9
    for direction in np.vstack([np.eye(points.shape[1]), -np.eye(points.shape[1])]):
        beside = center + 1e-3 * direction
        assert np.linalg.norm(points - beside, axis=1).max() >= radius - 1e-9


def test_box() -> None:
    """The box is aligned with the axes and centred on the points."""
    fit = box_around(CORNERS * (0.1, 0.2, 0.3) + (1, 2, 3))
    assert fit is not None
    np.testing.assert_allclose(fit[0].size, (0.1, 0.2, 0.3))
    np.testing.assert_allclose(fit[1].p, (1, 2, 3))


def test_sphere() -> None:
    """The sphere around a box has half its diagonal as radius."""
    fit = sphere_around(CORNERS * (0.3, 0.4, 1.2))
    assert fit is not None
    assert fit[0].radius == pytest.approx(0.65)


@pytest.mark.parametrize("rpy", [(0, 0, 0), (np.pi / 2, 0, 0), (0, np.pi / 2, 0)])
def test_cylinder_finds_its_axis(rpy: tuple[float, float, float]) -> None:
    """The smallest of three axis-aligned cylinders around a rod has its radius and length."""
    R = rotation_from_rpy(rpy)
    fit = cylinder_around(rod_mesh(0.01, 0.05, 64).vertices @ R.T + (1, 0, 0), AXES)
    assert fit is not None
    assert fit[0].radius == pytest.approx(0.01, rel=1e-6)
    assert fit[0].length == pytest.approx(0.05, rel=1e-6)
    np.testing.assert_allclose(np.abs(fit[1].R[:, 2]), np.abs(R[:, 2]), atol=1e-12)
    np.testing.assert_allclose(fit[1].p, (1, 0, 0), atol=1e-8)


def test_cylinder_along_an_axis_line() -> None:
    """The cylinder of a slanting rod needs the rod's axis among the candidates."""
    R = rotation_from_rpy((0.4, 0.5, 0.6))
    points = rod_mesh(0.01, 0.05, 64).vertices @ R.T
    fit = cylinder_around(points, [*AXES, R[:, 2]])
    assert fit is not None
    assert fit[0].radius == pytest.approx(0.01, rel=1e-6)
    assert fit[0].length == pytest.approx(0.05, rel=1e-6)


def test_capsule() -> None:
    """The capsule of a stadium is the stadium; that of a short cylinder extends beyond its ends."""
    angles = np.linspace(0, np.pi / 2, 9)
    profile = [(0.01 * np.cos(t), 0.03 + 0.01 * np.sin(t)) for t in angles]
    turns = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    points = np.array([[r * np.cos(u), r * np.sin(u), s * z] for r, z in profile for u in turns for s in (1, -1)])
    fit = capsule_around(points, AXES)
    assert fit is not None
    assert fit[0].radius == pytest.approx(0.01)
    assert fit[0].length == pytest.approx(0.06)
    fit = capsule_around(rod_mesh(0.01, 0.05, 64).vertices, [AXES[2]])
    assert fit is not None
    assert fit[0].length == pytest.approx(0.05, rel=1e-6)


@given(arrays(np.float64, st.tuples(st.integers(4, 30), st.just(3)), elements=st.floats(-1, 1, width=32)))
def test_shapes_enclose(points: np.ndarray) -> None:
    """Every point is inside every primitive."""
    points = points.astype(np.float64)
    if (fit := cylinder_around(points, AXES)) is not None:
        local = fit[1].inverse().apply(points)
        assert np.hypot(local[:, 0], local[:, 1]).max() <= fit[0].radius + 1e-9
        assert np.abs(local[:, 2]).max() <= 0.5 * fit[0].length + 1e-9
    if (capsule := capsule_around(points, AXES)) is not None:
        local = capsule[1].inverse().apply(points)
        beyond = np.maximum(np.abs(local[:, 2]) - 0.5 * capsule[0].length, 0.0)
        assert np.linalg.norm(np.column_stack([local[:, :2], beyond]), axis=1).max() <= capsule[0].radius + 1e-6


def test_flat_points_leave_no_room() -> None:
    """Flat points have a sphere, but no box and no cylinder."""
    flat = CORNERS * (0.1, 0.1, 0.0)
    assert box_around(flat) is None
    assert cylinder_around(flat, [AXES[2]]) is None
    assert sphere_around(flat) is not None


def test_smallest_ball_is_the_same_to_the_last_bit() -> None:
    """The smallest ball does not depend on the version of numpy or LAPACK, to the last bit."""
    points = np.array([[0.013, 0.001, 0.0], [-0.011, 0.007, 0.003], [0.001, -0.012, 0.005], [0.002, 0.003, 0.014]])
    center, radius = smallest_ball(points)
    assert center.tolist() == [0.0002720800135616215, 0.0006573147991184949, 0.002362010510255976]
    assert radius == 0.01294976733299253
    center, radius = smallest_ball(points[:, :2])
    assert center.tolist() == [0.00019531249999999757, 0.0007812499999999999]
    assert radius == 0.012806555881077328
