"""Mass matrix, gravity forces and inverse dynamics, against textbook formulas and conservation of energy."""

from fractions import Fraction
from math import cos, pi, sin

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.dynamics import GRAVITY, equations_at, equations_of_motion, free_mass_matrix, mobilities
from stepbot.robot.kinematics import Tree, complete, configurations, link_poses, link_poses_at, rates
from stepbot.robot.model import Base, Joint, JointDynamics, JointKind, Link, Robot
from tests.robots import ROBOTS

m1, m2, a1, c1, c2, I1, I2 = 1.5, 0.7, 0.4, 0.15, 0.22, 0.011, 0.007
"""Masses [kg], length of the first link, distances of both centres [m], inertias about them [kg m^2]."""


def _vertical_arm() -> Robot:
    """Two links in a vertical plane, both axes along -y, so that positive q lifts, as in the textbook."""
    across = (0.0, -1.0, 0.0)
    return Robot(
        "arm",
        (
            Link("base"),
            Link("upper", MassProperties.of(m1, (c1, 0, 0), np.diag([0.0, I1, I1]))),
            Link("fore", MassProperties.of(m2, (c2, 0, 0), np.diag([0.0, I2, I2]))),
        ),
        (
            Joint("one", JointKind.REVOLUTE, "base", "upper", axis=across),
            Joint("two", JointKind.REVOLUTE, "upper", "fore", Pose.of(position=(a1, 0, 0)), axis=across),
        ),
    )


@pytest.mark.parametrize(("q1", "q2"), [(0.0, 0.0), (0.3, -1.1), (2.0, 0.7), (-1.5, pi / 2)])
def test_two_link_arm_of_the_textbook(q1: float, q2: float) -> None:
    """M(q) and g(q) equal those of the planar elbow arm (Spong, Hutchinson, Vidyasagar 2006, section 7.3)."""
    h = m2 * (a1 * a1 + c2 * c2 + 2 * a1 * c2 * cos(q2)) + m1 * c1 * c1 + I1 + I2
    off = m2 * (c2 * c2 + a1 * c2 * cos(q2)) + I2
    expected = [[h, off], [off, m2 * c2 * c2 + I2]]
    q = {"one": q1, "two": q2}
    np.testing.assert_allclose(equations_of_motion(_vertical_arm(), q).mass_matrix, expected, rtol=1e-14)
    second = m2 * c2 * 9.81 * cos(q1 + q2)
    first = (m1 * c1 + m2 * a1) * 9.81 * cos(q1) + second
    np.testing.assert_allclose(equations_of_motion(_vertical_arm(), q).gravity, [first, second], rtol=1e-13, atol=1e-14)


def _inverse_in_fractions(M: list[list[float]]) -> list[float]:
    """The diagonal of an inverse, in exact arithmetic."""
    n = len(M)
    rows = [[Fraction(x) for x in row] + [Fraction(i == k) for k in range(n)] for i, row in enumerate(M)]
    for k in range(n):
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(n):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [float(rows[k][n + k]) for k in range(n)]


@pytest.mark.parametrize("share", [1.0, 1e-6, 1e-12])
def test_mobilities_are_the_exact_inverse(share: float) -> None:
    """Of the mass matrix as computed, to 1e-12, also where the last link weighs a millionth of a millionth."""
    arm = _vertical_arm()
    light = Link("fore", MassProperties.of(share * m2, (c2, 0, 0), share * np.diag([0.0, I2, I2])))
    arm = replace(arm, links=(*arm.links[:2], light))
    M = equations_of_motion(arm, {"one": 0.0, "two": 0.0}).mass_matrix.tolist()
    assert list(mobilities(arm).values()) == pytest.approx(_inverse_in_fractions(M), rel=1e-12)


def test_a_joint_without_mass_has_no_mobility() -> None:
    """Below it nothing has mass."""
    arm = _vertical_arm()
    with pytest.raises(np.linalg.LinAlgError):
        mobilities(replace(arm, links=(*arm.links[:2], Link("fore"))))


@pytest.mark.parametrize(("q1", "q2"), [(0.3, -1.1), (2.0, 0.7), (-1.5, pi / 2)])
def test_coriolis_forces_are_the_textbooks(q1: float, q2: float) -> None:
    """C(q, v) v equals h (2 v1 v2 + v2^2) and -h v1^2 with h = -m2 a1 c2 sin q2, in addition to M a + g."""
    q, v, a = {"one": q1, "two": q2}, {"one": 0.7, "two": -1.3}, {"one": -0.4, "two": 2.0}
    h = -m2 * a1 * c2 * sin(q2)
    coriolis = [h * (2 * v["one"] * v["two"] + v["two"] ** 2), -h * v["one"] ** 2]
    seen = equations_of_motion(_vertical_arm(), q, (v, a))
    expected = seen.mass_matrix @ list(a.values()) + coriolis + seen.gravity
    np.testing.assert_allclose(seen.inverse, expected, rtol=1e-13)


@pytest.mark.parametrize("name", ROBOTS)
def test_power_is_what_the_energy_grows_by(name: str) -> None:
    """Efforts times speeds are the rate of kinetic and potential energy, along any motion."""
    robot = ROBOTS[name]()
    layout = Tree(robot)

    def energy(q: np.ndarray, v: np.ndarray) -> float:
        X = layout.frames(q)
        kinetic = potential = 0.0
        for link in robot.links:
            i, body = layout.link_index[link.name], link.mass_properties
            com = X[i, :3, :3] @ np.array(body.com) + X[i, :3, 3]
            twist = layout.jacobian(X, i, com) @ v
            I_W = X[i, :3, :3] @ np.array(body.inertia) @ X[i, :3, :3].T
            kinetic += 0.5 * (twist[:3] @ I_W @ twist[:3] + body.mass * twist[3:] @ twist[3:])
            potential -= body.mass * float(np.array(GRAVITY) @ com)
        return float(kinetic + potential)

    for at, (speeds, accelerations) in zip(configurations(free(robot), n=3), rates(robot, n=3), strict=True):
        q, v, a = (np.array([given[joint] for joint in layout.joints]) for given in (at, speeds, accelerations))
        dt = 1e-5
        ahead, behind = (energy(q + s * v * dt + 0.5 * a * dt * dt, v + s * a * dt) for s in (1.0, -1.0))
        tau = equations_of_motion(free(robot), at, (speeds, accelerations)).inverse
        scale = float(np.abs(tau).sum()) + 1e-3
        assert float(tau @ v) == pytest.approx((ahead - behind) / (2 * dt), abs=1e-6 * scale)


def free(robot: Robot) -> Robot:
    """The robot without mimics, in which every joint is a coordinate."""
    return replace(robot, joints=tuple(replace(joint, mimic=None) for joint in robot.joints))


@pytest.mark.parametrize("name", ROBOTS)
def test_many_configurations_at_once_are_each_alone(name: str) -> None:
    """The equations of many configurations are, bit for bit, those of each; so are the poses."""
    robot = ROBOTS[name]()
    moments = list(zip(configurations(robot, n=5), (({}, {}), *rates(robot, n=4)), strict=True))
    for one, (q, given) in zip(equations_at(robot, moments), moments, strict=True):
        alone = equations_of_motion(robot, q, given)
        for field in ("mass_matrix", "gravity", "inverse"):
            np.testing.assert_array_equal(getattr(one, field), getattr(alone, field))
    assert link_poses_at(robot, [q for q, _ in moments]) == [link_poses(robot, q) for q, _ in moments]


def test_a_slider_carries_its_weight() -> None:
    """Along an axis tilted by t a mass m needs m g sin(t), and its inertia is m."""
    tilt = 0.4
    robot = Robot(
        "lift",
        (Link("base"), Link("cage", MassProperties.of(3.0, (0.1, 0.2, 0.3), np.eye(3)))),
        (Joint("lift", JointKind.PRISMATIC, "base", "cage", axis=(cos(tilt), 0.0, sin(tilt))),),
    )
    np.testing.assert_allclose(equations_of_motion(robot, {"lift": 0.7}).mass_matrix, [[3.0]], rtol=1e-15)
    np.testing.assert_allclose(equations_of_motion(robot, {"lift": 0.7}).gravity, [3.0 * 9.81 * sin(tilt)], rtol=1e-15)


@pytest.mark.parametrize("name", ROBOTS)
def test_gravity_is_the_slope_of_the_potential(name: str) -> None:
    """Gravity forces are the gradient of the potential energy, by central differences."""
    robot = ROBOTS[name]()
    layout = Tree(robot)

    def potential(q: np.ndarray) -> float:
        X = layout.frames(q)
        energy = 0.0
        for link in robot.links:
            i = layout.link_index[link.name]
            com = X[i, :3, :3] @ np.array(link.mass_properties.com) + X[i, :3, 3]
            energy -= link.mass_properties.mass * float(np.array(GRAVITY) @ com)
        return energy

    for configuration in configurations(robot, n=3):
        q = np.array([configuration[joint] for joint in layout.joints])
        step = 1e-6
        slope = [(potential(q + step * unit) - potential(q - step * unit)) / (2 * step) for unit in np.eye(len(q))]
        np.testing.assert_allclose(equations_of_motion(robot, configuration).gravity, slope, atol=1e-7)


@pytest.mark.parametrize("name", ROBOTS)
def test_mass_matrix_is_that_of_the_kinetic_energy(name: str) -> None:
    """Half v' M v is the kinetic energy of all links, with speeds by finite differences of their poses."""
    robot = ROBOTS[name]()
    layout = Tree(robot)
    configuration = configurations(robot, n=1)[0]
    q = np.array([configuration[joint] for joint in layout.joints])
    v = np.linspace(0.5, -0.8, len(q))
    ahead, here, behind = (layout.frames(q + step * v) for step in (1e-6, 0.0, -1e-6))
    energy = 0.0
    for link in robot.links:
        i, body = layout.link_index[link.name], link.mass_properties
        com = np.array([*body.com, 1.0])
        velocity = (ahead[i] @ com - behind[i] @ com)[:3] / 2e-6
        spin = (ahead[i, :3, :3] - behind[i, :3, :3]) @ here[i, :3, :3].T / 2e-6
        w_L = here[i, :3, :3].T @ np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        energy += 0.5 * body.mass * velocity @ velocity + 0.5 * w_L @ np.array(body.inertia) @ w_L
    M = equations_of_motion(robot, configuration).mass_matrix
    assert 0.5 * v @ M @ v == pytest.approx(energy, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("base", list(Base))
def test_armatures_are_on_the_diagonal_of_the_free_mass_matrix(base: Base) -> None:
    """Beside the textbook's matrix at q = 0; a base that floats has six coordinates more, and none of them."""
    arm = replace(_vertical_arm(), base=base)
    armatures = (0.3, 0.2)
    joints = (replace(j, dynamics=JointDynamics(armature=a)) for j, a in zip(arm.joints, armatures, strict=True))
    (names, bare), (_, M) = (free_mass_matrix(one) for one in (arm, replace(arm, joints=tuple(joints))))
    own = [names.index(name) for name in ("one", "two")]
    assert len(names) == (8 if base is Base.FLOATING else 2)
    assert M - bare == pytest.approx(np.diag([0.3 * (n == own[0]) + 0.2 * (n == own[1]) for n in range(len(names))]))
    coupled = I2 + m2 * c2 * (c2 + a1)
    first = I1 + I2 + m1 * c1**2 + m2 * (a1 + c2) ** 2
    assert bare[np.ix_(own, own)] == pytest.approx(np.array([[first, coupled], [coupled, I2 + m2 * c2**2]]))


def test_mass_matrix_is_symmetric_and_positive() -> None:
    """The mass matrix is symmetric and positive definite if every joint moves some mass."""
    for build in ROBOTS.values():
        robot = build()
        M = equations_of_motion(robot, configurations(robot, n=1)[0]).mass_matrix
        assert (M == M.T).all()
        assert (np.linalg.eigvalsh(M) > 0.0).all()


def test_a_robot_without_joints_has_an_empty_matrix() -> None:
    """A robot without joints has an empty mass matrix and no gravity forces."""
    equations = equations_of_motion(ROBOTS["one_link"](), {})
    M, g = equations.mass_matrix, equations.gravity
    assert M.shape == (0, 0)
    assert g.shape == (0,)


def test_mimics_stay_coordinates_of_their_own() -> None:
    """Mimics remain coordinates, as in every engine."""
    robot = ROBOTS["gripper_with_mimic"]()
    assert equations_of_motion(robot, {"finger": 0.01}).mass_matrix.shape == (3, 3)
    assert complete(robot, {"finger": 0.01}).keys() == link_poses_of_joints(robot)


def link_poses_of_joints(robot: Robot) -> set[str]:
    """Names of the joints whose child has a pose."""
    poses = link_poses(robot, {})
    return {joint.name for joint in robot.joints if joint.child in poses}
