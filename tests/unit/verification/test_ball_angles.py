"""Angles of ball joints, against scipy and differences of neighbouring rotations; screws of two joints."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stepbot.engines.observation import ObservedJoint
from stepbot.geometry.spatial import Array, Pose, cross_matrix, rotation_about, unit
from stepbot.robot.model import JointDynamics, Limit
from stepbot.verification.chains import _both, common_point, direction, foot, pitch_of, twist_of
from stepbot.verification.pairing import BallAngles

X, Y, Z = np.eye(3)
STEP = 1e-6


def _slanted(random: np.random.Generator) -> BallAngles:
    """Three axes, the second perpendicular to the others, at any angle between these."""
    second = unit(random.normal(size=3))
    first, third = (unit(np.cross(second, random.normal(size=3))) for _ in range(2))
    return BallAngles(np.array([first, second, third]))


@pytest.mark.parametrize("axes", ["ZYX", "XYZ", "YXZ", "ZXZ", "XYX"])
def test_rotation_is_scipys(axes: str) -> None:
    """Cardan and Euler angles are scipy's intrinsic rotations."""
    angles = [0.7, -1.1, 2.3]
    own = BallAngles(np.array([{"X": X, "Y": Y, "Z": Z}[axis] for axis in axes])).rotation(angles)
    assert np.abs(own - Rotation.from_euler(axes, angles).as_matrix()).max() < 1e-15


def test_angles_lead_back_to_the_rotation() -> None:
    """The angles of any rotation about any such axes give the rotation, also in gimbal lock."""
    random = np.random.default_rng(1)
    for _ in range(100):
        ball = _slanted(random)
        R = Rotation.random(rng=random).as_matrix()
        assert np.abs(ball.rotation(ball.angles(R)) - R).max() < 1e-14
    euler = BallAngles(np.array([Z, X, Z]))
    assert np.abs(euler.rotation(euler.angles(rotation_about(Z, 0.4))) - rotation_about(Z, 0.4)).max() < 1e-15


def test_rates_and_bias_are_derivatives() -> None:
    """Rates and bias are central differences of the rotation and of the rates, for any speed."""
    random = np.random.default_rng(2)
    for _ in range(20):
        ball, q, v = _slanted(random), random.uniform(-3.0, 3.0, 3), random.normal(size=3)

        def at(share: float, q: Array = q, v: Array = v) -> list[float]:
            return [float(x) for x in q + share * v]

        turning = (ball.rotation(at(STEP)) - ball.rotation(at(-STEP))) / (2 * STEP) @ ball.rotation(at(0.0)).T
        assert np.abs(turning - cross_matrix(ball.rates(at(0.0)) @ v)).max() < 1e-8
        change = (ball.rates(at(STEP)) @ v - ball.rates(at(-STEP)) @ v) / (2 * STEP)
        assert np.abs(change - ball.bias(at(0.0), v.tolist())).max() < 1e-8


def test_clearance_is_none_at_gimbal_lock() -> None:
    """The clearance is 0 in gimbal lock: roll, pitch and yaw at a pitch of 90 deg, Euler angles at a nutation of 0."""
    assert BallAngles(np.array([Z, Y, X])).clearance([0.3, np.pi / 2, 1.0]) < 1e-15
    assert BallAngles(np.array([Z, Y, X])).clearance([0.3, 0.0, 1.0]) == pytest.approx(1.0)
    assert BallAngles(np.array([Z, X, Z])).clearance([0.3, 0.0, 1.0]) < 1e-15


def test_slant_is_how_far_axes_are_from_normal() -> None:
    """The slant is the deviation from perpendicular of the first and second, and of the second and third axis."""
    leaning = unit(Y + 0.01 * Z)
    first, second = BallAngles(np.array([Z, leaning, X])).slant
    assert (first, second) == (pytest.approx(np.arctan(0.01)), 0.0)


@pytest.mark.parametrize("angle", [1e-3, 0.4, 1.0, 2.5])
def test_the_twist_of_a_screw_motion(angle: float) -> None:
    """Axis, pitch and a point of the axis follow from a screw motion; a translation has no axis."""
    axis, point, pitch = unit([1.0, -2.0, 2.0]), np.array([0.3, 0.1, -0.7]), 0.05
    R = rotation_about(axis, angle)
    twist = twist_of(Pose.of(R, point - R @ point + pitch * angle * axis))
    assert np.abs(twist[:3] - angle * axis).max() < 1e-15
    assert np.abs(twist[3:] - angle * (np.cross(point, axis) + pitch * axis)).max() < 1e-12
    assert pitch_of(twist) == pytest.approx(pitch, abs=1e-11)
    assert np.abs(foot(twist) - (point - axis * (axis @ point))).max() < 1e-11
    slide = twist_of(Pose.of(np.eye(3), (0.0, 2.0, 0.0)))
    assert slide.tolist() == [0.0, 0.0, 0.0, 0.0, 2.0, 0.0]
    assert direction(slide) == (0.0, 1.0, 0.0)


def test_axes_through_one_point_and_past_it() -> None:
    """The common point of three axes, and their distance from it."""
    point = np.array([0.2, -0.4, 1.0])
    through = [np.concatenate([axis, np.cross(point, axis)]) for axis in (X, Y, Z)]
    found, astray = common_point(np.array(through))
    assert np.abs(found - point).max() < 1e-15
    assert astray < 1e-15
    through[0] = np.concatenate([X, np.cross(point + 0.01 * Z, X)])
    assert common_point(np.array(through))[1] == pytest.approx(0.005)


@pytest.mark.parametrize("m", [0.5, -2.0])
@pytest.mark.parametrize("springs", [(3.0, 5.0), (3.0, 0.0), (0.0, 5.0)])
def test_a_screw_of_two_joints_has_the_forces_and_limits_of_both(m: float, springs: tuple[float, float]) -> None:
    """Its torque and power at equal motion are those of both, and it reaches what both allow."""
    limits, forces = (Limit(-1.0, 2.0, 3.0, 4.0), Limit(-0.4, 0.6, 5.0, 7.0)), []
    for n, stiffness in enumerate(springs):
        forces.append(JointDynamics(0.1 + n, 0.2 + n, stiffness, 0.3 - n, 0.4 + n))
    turn, slide = (
        ObservedJoint(name, name, "a", "b", limit=limit, dynamics=of)
        for name, limit, of in zip(("turn", "slide"), limits, forces, strict=True)
    )
    screw = _both(turn, slide, m)
    a, b, both = *forces, screw.dynamics
    assert both is not None
    assert screw.limit is not None
    for q in (-0.7, 0.0, 1.3):
        torque = a.stiffness * (q - a.spring_reference) + m * b.stiffness * (m * q - b.spring_reference)
        assert both.stiffness * (q - both.spring_reference) == pytest.approx(torque)
    for name, power in (("damping", 2), ("friction", 1), ("armature", 2)):
        assert getattr(both, name) == pytest.approx(getattr(a, name) + abs(m) ** power * getattr(b, name))
    for q in np.linspace(-2.0, 2.0, 41) + 1e-3:
        allowed = all(limit.lower <= at <= limit.upper for limit, at in zip(limits, (q, m * q), strict=True))
        assert (screw.limit.lower <= q <= screw.limit.upper) == allowed
    assert screw.limit.velocity == pytest.approx(min(3.0, 5.0 / abs(m)))


@pytest.mark.parametrize("without", ["turn", "slide"])
def test_a_screw_of_two_joints_has_no_limit_that_one_does_not_report(without: str) -> None:
    """Where an engine reports the limit of one of both joints alone, nothing is made up of it."""
    limits = {name: None if name == without else Limit(-1.0, 2.0) for name in ("turn", "slide")}
    turn, slide = (ObservedJoint(name, name, "a", "b", limit=limit) for name, limit in limits.items())
    assert _both(turn, slide, 2.0).limit == limits["turn"]
