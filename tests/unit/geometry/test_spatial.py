"""Poses, rotations and inertia tensors, against scipy and closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from stepbot.geometry.spatial import (
    IDENTITY,
    Pose,
    bounds,
    cross_matrix,
    join_bounds,
    perpendicular_frame,
    quaternion_from_rotation,
    rotation_about,
    rotation_angle,
    rotation_from_quaternion,
    rotation_from_rpy,
    rpy_from_rotation,
    shift_inertia,
    tidy,
    turn_inertia,
    unit,
)

angles = st.floats(-2 * math.pi, 2 * math.pi)
vectors = arrays(np.float64, 3, elements=st.floats(-10, 10))
directions = vectors.filter(lambda v: np.linalg.norm(v) > 1e-3).map(unit)
poses = st.builds(lambda axis, angle, p: Pose.of(rotation_about(axis, angle), p), directions, angles, vectors)


@given(angles, angles, angles)
def test_rpy_turns_about_fixed_axes(roll: float, pitch: float, yaw: float) -> None:
    """Roll, pitch and yaw are scipy's extrinsic xyz angles."""
    expected = Rotation.from_euler("xyz", [roll, pitch, yaw]).as_matrix()
    np.testing.assert_allclose(rotation_from_rpy((roll, pitch, yaw)), expected, atol=1e-14)


@given(directions, angles)
def test_rpy_comes_back(axis: np.ndarray, angle: float) -> None:
    """The angles of a rotation give the same rotation."""
    R = rotation_about(axis, angle)
    np.testing.assert_allclose(rotation_from_rpy(rpy_from_rotation(R)), R, atol=1e-14)


@pytest.mark.parametrize("off", [0.0, 1e-16, 1e-13, 1e-12, 1e-11, 1e-9, 1e-6])
@pytest.mark.parametrize("sign", [1, -1])
def test_rpy_comes_back_at_the_gimbal_pole(off: float, sign: int) -> None:
    """At and near a pitch of 90 degrees the angles give the rotation to 1e-12 rad."""
    R = rotation_from_rpy((0.3, sign * (math.pi / 2 - off), -1.1))
    np.testing.assert_allclose(rotation_from_rpy(rpy_from_rotation(R)), R, rtol=0, atol=1e-12)


@given(directions, angles)
def test_rotation_about_is_that_of_scipy(axis: np.ndarray, angle: float) -> None:
    """Rodrigues' formula agrees with scipy's rotation vectors."""
    expected = Rotation.from_rotvec(np.array(axis) * angle).as_matrix()
    np.testing.assert_allclose(rotation_about(axis, angle), expected, atol=1e-14)


@given(directions, angles)
def test_quaternion_comes_back(axis: np.ndarray, angle: float) -> None:
    """The quaternion has w first and non-negative, and gives the same rotation."""
    R = rotation_about(axis, angle)
    quaternion = quaternion_from_rotation(R)
    assert quaternion[0] >= 0.0
    assert math.isclose(sum(q * q for q in quaternion), 1.0, rel_tol=1e-14)
    np.testing.assert_allclose(rotation_from_quaternion(quaternion), R, atol=1e-14)


def test_quaternion_is_normalised_first() -> None:
    """A quaternion of any length gives a rotation."""
    R = rotation_from_quaternion((2.0, 0.0, 0.0, 2.0))
    np.testing.assert_allclose(R, rotation_about((0, 0, 1), math.pi / 2), atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 0.5, math.pi - 1e-8, math.pi])
def test_rotation_angle_is_accurate_at_both_ends(angle: float) -> None:
    """Angles near 0 and pi have full precision, where the arc cosine of the trace has half."""
    assert rotation_angle(rotation_about(unit((1, -2, 0.5)), angle)) == pytest.approx(angle, abs=2e-15)


@given(poses, poses, poses)
def test_poses_compose(X_WA: Pose, X_AB: Pose, X_BC: Pose) -> None:
    """The product of poses is that of their matrices, in any order of evaluation."""
    expected = X_WA.matrix @ X_AB.matrix @ X_BC.matrix
    np.testing.assert_allclose(((X_WA @ X_AB) @ X_BC).matrix, expected, atol=1e-12)
    np.testing.assert_allclose((X_WA @ (X_AB @ X_BC)).matrix, expected, atol=1e-12)


@given(poses, vectors)
def test_inverse_undoes(X_AB: Pose, p_B: np.ndarray) -> None:
    """A pose times its inverse is the identity; a point is moved, a direction rotated only."""
    np.testing.assert_allclose((X_AB.inverse() @ X_AB).matrix, np.eye(4), atol=1e-13)
    np.testing.assert_allclose(X_AB.inverse().apply(X_AB.apply(p_B)), p_B, atol=1e-12)
    np.testing.assert_allclose(X_AB.turn(p_B) + X_AB.p, X_AB.apply(p_B), atol=1e-12)


def test_pose_takes_many_points_at_once() -> None:
    """Points are rows."""
    X = Pose.from_xyz_rpy((1, 2, 3), (0, 0, math.pi / 2))
    np.testing.assert_allclose(X.apply([(1, 0, 0), (0, 1, 0)]), [(1, 3, 3), (0, 2, 3)], atol=1e-15)


def test_distance_between_poses() -> None:
    """The distance of poses is the position's in metres and the angle of the relative rotation."""
    distance, angle = IDENTITY.distance_to(Pose.of(rotation_about((0, 1, 0), 0.25), (3, 4, 0)))
    assert distance == 5.0
    assert angle == pytest.approx(0.25, abs=1e-15)


def test_arrays_of_a_pose_are_read_only() -> None:
    """The arrays of a pose are read-only."""
    with pytest.raises(ValueError, match="read-only"):
        IDENTITY.R[0, 0] = 2.0


def test_only_the_identity_is_the_identity() -> None:
    """Only the exact identity counts as identity."""
    assert Pose().is_identity
    assert not Pose.of(position=(1e-300, 0, 0)).is_identity


@given(vectors, vectors)
def test_cross_matrix_is_the_cross_product(v: np.ndarray, u: np.ndarray) -> None:
    """The cross matrix times a vector is the cross product."""
    np.testing.assert_allclose(cross_matrix(v) @ u, np.cross(v, u), atol=1e-12)


def test_no_direction_without_length() -> None:
    """A zero or non-finite vector has no direction."""
    for vector in ((0, 0, 0), (math.nan, 0, 0), (math.inf, 0, 0)):
        with pytest.raises(ValueError, match="no direction"):
            unit(vector)


def _inertia_of_points(points: np.ndarray, masses: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Inertia as the sum over mass points."""
    arms = points - about
    return sum(m * ((a @ a) * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True))


def test_shifting_an_inertia_is_the_sum_over_points() -> None:
    """Steiner's theorem holds in both directions."""
    random = np.random.default_rng(3)
    points, masses = random.normal(size=(20, 3)), random.uniform(0.1, 2.0, 20)
    com = masses @ points / masses.sum()
    at_com = _inertia_of_points(points, masses, com)
    elsewhere = com + np.array([0.3, -2.0, 1.0])
    shifted = shift_inertia(at_com, masses.sum(), elsewhere - com)
    np.testing.assert_allclose(shifted, _inertia_of_points(points, masses, elsewhere), rtol=1e-13)
    np.testing.assert_allclose(shift_inertia(shifted, -masses.sum(), elsewhere - com), at_com, rtol=1e-12)


def test_turning_an_inertia_is_turning_the_points() -> None:
    """The inertia of rotated points is the rotated tensor, exactly symmetric."""
    random = np.random.default_rng(4)
    points, masses = random.normal(size=(20, 3)), random.uniform(0.1, 2.0, 20)
    R = rotation_about(unit((1, 2, 3)), 0.7)
    turned = turn_inertia(R, _inertia_of_points(points, masses, np.zeros(3)))
    np.testing.assert_allclose(turned, _inertia_of_points(points @ R.T, masses, np.zeros(3)), rtol=1e-12)
    assert (turned == turned.T).all()


@given(directions)
def test_perpendicular_frame_is_a_rotation_with_that_z(z: np.ndarray) -> None:
    """The frame is right-handed with z as given, x on the side of the parent's x, or of its y where z is near x."""
    R = perpendicular_frame(z)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(R[:, 2], z, atol=1e-15)
    assert R[1 if abs(z[0]) > 0.9 else 0, 0] > 0.0


def test_bounds_of_points_and_boxes() -> None:
    """Bounds are the lowest and highest corner; no boxes are an error."""
    assert bounds([(1, 5, 3), (2, 4, 3)]) == ((1.0, 4.0, 3.0), (2.0, 5.0, 3.0))
    assert join_bounds([((0, 0, 0), (1, 1, 1)), ((-1, 0.5, 0), (0, 2, 0))]) == ((-1, 0, 0), (1, 2, 1))
    with pytest.raises(ValueError, match="no box"):
        join_bounds([])


def test_tidy_leaves_no_noise() -> None:
    """Numbers that differ from simple ones in the last bits are rounded; others are kept."""
    pose = tidy(Pose.of(rotation_about((0, 0, 1), math.pi / 2), (0.1 + 2e-17, -0.0, 1 / 3)))
    assert pose.rotation == ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert pose.position == (0.1, 0.0, 0.333333333333)
    R = rotation_about((0, 0, 1), 1e-6)
    np.testing.assert_allclose(tidy(Pose.of(R)).R, R, atol=1e-15)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.8, 0)])
@pytest.mark.parametrize("angle", [math.pi, math.pi / 2, 5e-13, 1e-11])
def test_angles_and_quaternions_have_no_residue(axis: tuple[float, float, float], angle: float) -> None:
    """Components below 1e-12 are 0, larger ones are kept, and the rotation is the same to 1e-12."""
    R = rotation_about(axis, angle)
    rpy, quaternion = Pose.of(R).rpy, Pose.of(R).quaternion
    assert [value for value in (*rpy, *quaternion) if 0.0 < abs(value) < 1e-12] == []
    np.testing.assert_allclose(rotation_from_rpy(rpy), R, atol=1e-12)
    np.testing.assert_allclose(rotation_from_quaternion(quaternion), R, atol=1e-12)
