"""Sampled configurations: within limits, loops closed, the whole range covered, the same every time."""

from math import pi

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import Array
from stepbot.robot.closures import Loops
from stepbot.robot.dynamics import equations_of_motion
from stepbot.robot.kinematics import Tree, complete, initial_configuration, moving_joints
from stepbot.robot.model import Limit, Robot
from stepbot.robot.multi_dof import unfolded
from stepbot.robot.sampling import sampled, worst_postures
from tests.closed_mechanisms import delta, four_bar_angles, slider_crank, stewart
from tests.mechanisms import floating
from tests.robots import ROBOTS, four_bar, four_bar_with_zeros, one_link, two_link_arm

CLOSED = {robot.__name__: robot for robot in (four_bar, four_bar_with_zeros, slider_crank, delta, stewart)}


@pytest.mark.parametrize("name", ROBOTS)
def test_the_drawn_pose_is_first_and_limits_hold(name: str) -> None:
    """The first configuration is the drawn pose, and all are within the limits of all joints, mimics included."""
    robot = ROBOTS[name]()
    q = sampled(robot, 200)
    tree = Tree(robot)
    drawn = complete(robot, initial_configuration(robot))
    np.testing.assert_allclose(q[0], [drawn[joint] for joint in tree.joints], atol=1e-9)
    for joint, positions in zip(moving_joints(robot), q.T, strict=True):
        assert joint.limit.lower - 1e-8 <= positions.min() <= positions.max() <= joint.limit.upper + 1e-8


def test_open_chains_are_sampled_uniformly() -> None:
    """The distribution of a joint without loops is uniform between its limits: Kolmogorov, at a level of 0.1 %."""
    robot = two_link_arm()
    q = sampled(robot, 4000)
    for joint, positions in zip(moving_joints(robot), q[1:].T, strict=True):
        low, high = joint.limit.lower, joint.limit.upper
        shares = np.sort((positions - low) / (high - low))
        steps = np.arange(1, len(shares) + 1) / len(shares)
        assert np.abs(shares - steps).max() < 1.95 / np.sqrt(len(shares))


@pytest.mark.slow
@pytest.mark.parametrize("name", CLOSED)
def test_loops_are_closed_in_every_configuration(name: str) -> None:
    """Every sampled configuration of a closed mechanism closes its loops, as the gaps of its closures show."""
    robot = CLOSED[name]()
    q = sampled(robot, 500)
    assert len(q) == 500
    loops = Loops(robot)
    independent = [loops.tree.joints.index(joint) for joint in loops.tree.independent]
    drawn = max(loops.gaps(q[0, independent]).values())
    for configuration in q[::25]:
        distance, angle = max(loops.gaps(configuration[independent]).values())
        assert distance < max(1e-9, 2 * drawn[0])
        assert angle < max(1e-8, 2 * drawn[1])


@pytest.mark.slow
def test_the_range_of_a_four_bar_is_covered() -> None:
    """The crank of a four-bar is sampled over its whole turn, and the other angles are those of its closed form."""
    robot = four_bar_with_zeros()
    q = sampled(robot, 2000)
    assert Tree(robot).joints == ("crank_pin", "coupler_pin", "ground_pin")
    assert np.diff(np.sort(q[:, 0])).max() < 0.1
    assert np.ptp(q[:, 0]) > 2.0 * pi - 0.2
    for crank, coupler, rocker in q[::100]:
        angles, expected = np.array([crank + coupler, rocker]), np.array(four_bar_angles(crank))
        np.testing.assert_allclose(np.exp(1j * angles), np.exp(1j * expected), atol=1e-6)


@pytest.mark.slow
def test_the_same_every_time() -> None:
    """Samples are reproducible, and depend on the seed."""
    for robot in (two_link_arm(), delta()):
        np.testing.assert_array_equal(sampled(robot, 50), sampled(robot, 50))
        assert not np.array_equal(sampled(robot, 50), sampled(robot, 50, seed=2))


def test_a_robot_that_cannot_move_has_one_configuration() -> None:
    """A robot without joints has its drawn pose, and so has one whose loop leaves no freedom."""
    assert sampled(one_link(), 100).shape == (1, 0)
    robot = four_bar()
    drawn = initial_configuration(robot)
    held = tuple(replace(j, limit=Limit(drawn[j.name], drawn[j.name])) for j in robot.joints)
    assert np.ptp(sampled(replace(robot, joints=held), 100), axis=0).max() < 1e-6


@pytest.mark.parametrize("robot", [four_bar(), delta(), floating(), two_link_arm()], ids=lambda robot: robot.name)
def test_many_configurations_at_once_are_as_one_after_the_other(robot: Robot) -> None:
    """Frames, Jacobians and constraints of a batch equal those of its configurations."""
    loops = Loops(robot)
    tree = loops.tree
    u = np.random.default_rng(3).normal(size=(2, 3, len(tree.independent)))
    X, (residual, J) = tree.frames(tree.follow(u)), loops.constraints(u)
    for place in np.ndindex(2, 3):
        one = tree.frames(tree.follow(u[place]))
        np.testing.assert_allclose(X[place], one, atol=1e-14)
        at = one[-1, :3, 3]
        J_tip = tree.jacobian(X, len(tree.links) - 1, X[..., -1, :3, 3])[place]
        np.testing.assert_allclose(J_tip, tree.jacobian(one, len(tree.links) - 1, at), atol=1e-13)
        for many, alone in zip((residual, J), loops.constraints(u[place]), strict=True):
            np.testing.assert_allclose(many[place], alone, atol=1e-13)


@pytest.mark.parametrize("name", [name for name, robot in ROBOTS.items() if not robot().closures])
def test_no_random_posture_is_worse_than_the_worst(name: str) -> None:
    """The largest inertia and weight of each joint are those of the equations of motion there, and nowhere more."""
    robot = unfolded(ROBOTS[name]())
    tree = Tree(robot)
    if not tree.independent:
        return

    def seen(q: Array) -> tuple[Array, Array]:
        equations = equations_of_motion(robot, dict(zip(tree.joints, q.tolist(), strict=True)), tree=tree)
        return np.diag(tree.B.T @ equations.mass_matrix @ tree.B), np.abs(equations.gravity @ tree.B)

    n = len(tree.independent)
    worst = worst_postures(robot, tree, range(n))
    assert worst is not None
    postures, inertia, weight = worst
    there = [seen(q) for q in postures]
    np.testing.assert_allclose(inertia, [there[i][0][i] for i in range(n)], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(weight, [there[n + i][1][i] for i in range(n)], rtol=1e-9, atol=1e-9)
    anywhere = [seen(q) for q in sampled(robot, 1000, seed=7)]
    assert (np.max([one[0] for one in anywhere], axis=0) <= 1.02 * inertia + 1e-12).all()
    assert (np.max([one[1] for one in anywhere], axis=0) <= 1.02 * weight + 1e-9).all()
    assert all(
        joint.limit.lower - 1e-9 <= low and high <= joint.limit.upper + 1e-9
        for joint, low, high in zip(moving_joints(robot), postures.min(axis=0), postures.max(axis=0), strict=True)
    )
