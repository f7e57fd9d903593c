"""Forward kinematics, Jacobians and configurations, against closed forms and finite differences."""

from math import cos, inf, pi, sin

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, rotation_about
from stepbot.robot.kinematics import (
    Tree,
    complete,
    configurations,
    independent_joints,
    initial_configuration,
    leader_ranges,
    link_poses,
    mimic_relation,
    moving_joints,
    neighbours,
    sampling_range,
    within_limits,
)
from stepbot.robot.model import Joint, JointKind, Limit, Link, Mimic, Robot
from tests.robots import ROBOTS, four_bar, gripper_with_mimic, tree, two_link_arm


def _chain(*joints: Joint) -> Robot:
    return Robot("chain", (Link("base"), *(Link(joint.child) for joint in joints)), joints)


def test_planar_arm_in_closed_form() -> None:
    """The poses of a planar arm are sums of angles."""
    a, b = 0.4, 0.3
    robot = _chain(
        Joint("one", JointKind.REVOLUTE, "base", "upper"),
        Joint("two", JointKind.REVOLUTE, "upper", "fore", Pose.of(position=(a, 0, 0))),
        Joint("tip", JointKind.FIXED, "fore", "tool", Pose.of(position=(b, 0, 0))),
    )
    for q1, q2 in ((0.0, 0.0), (0.3, -1.2), (2.0, 3.0)):
        X = link_poses(robot, {"one": q1, "two": q2})["tool"]
        expected = (a * cos(q1) + b * cos(q1 + q2), a * sin(q1) + b * sin(q1 + q2), 0.0)
        np.testing.assert_allclose(X.p, expected, atol=1e-15)
        np.testing.assert_allclose(X.R, rotation_about((0, 0, 1), q1 + q2), atol=1e-15)


def test_sliding_joint_moves_along_its_axis_in_its_frame() -> None:
    """The axis of a prismatic joint is in the joint's frame, not in the parent's."""
    X_PC = Pose.from_xyz_rpy((1, 0, 0), (0, 0, pi / 2))
    robot = _chain(Joint("slide", JointKind.PRISMATIC, "base", "cart", X_PC, axis=(1.0, 0.0, 0.0)))
    np.testing.assert_allclose(link_poses(robot, {"slide": 0.25})["cart"].p, (1, 0.25, 0), atol=1e-15)


@pytest.mark.parametrize("name", ROBOTS)
def test_q_zero_is_the_model_as_it_stands(name: str) -> None:
    """At q = 0 without mimics every pose is the product of the joints' frames."""
    robot = ROBOTS[name]()
    robot = replace(robot, joints=tuple(replace(joint, mimic=None) for joint in robot.joints))
    X_W = link_poses(robot, {})
    for joint in robot.joints:
        distance, angle = X_W[joint.child].distance_to(X_W[joint.parent] @ joint.X_PC)
        assert distance < 1e-15
        assert angle < 1e-15


@pytest.mark.parametrize("name", ROBOTS)
def test_jacobian_is_the_derivative(name: str) -> None:
    """The Jacobian is the derivative of a point on every link, by central differences."""
    robot = ROBOTS[name]()
    layout = Tree(robot)
    q = np.linspace(0.1, 0.5, len(layout.joints))
    step = 1e-6
    for link in range(len(layout.links)):
        p_L = np.array([0.1, -0.2, 0.3])
        X = layout.frames(q)
        J = layout.jacobian(X, link, X[link, :3, :3] @ p_L + X[link, :3, 3])
        for column, unit in enumerate(np.eye(len(q))):
            ahead, behind = layout.frames(q + step * unit)[link], layout.frames(q - step * unit)[link]
            velocity = ((ahead[:3, :3] - behind[:3, :3]) @ p_L + ahead[:3, 3] - behind[:3, 3]) / (2 * step)
            spin = (ahead[:3, :3] - behind[:3, :3]) @ X[link, :3, :3].T / (2 * step)
            np.testing.assert_allclose(J[3:, column], velocity, atol=1e-9)
            np.testing.assert_allclose(J[:3, column], (spin[2, 1], spin[0, 2], spin[1, 0]), atol=1e-9)


def test_mimics_follow_through_a_chain() -> None:
    """A mimic of a mimic follows the first joint."""
    robot = gripper_with_mimic()
    assert mimic_relation(robot, "thumb_pivot") == ("finger", -100 / 7, 0.1)
    q = complete(robot, {"finger": 0.02, "thumb_pivot": 99.0})
    assert q["finger_mirrored"] == 0.02
    assert q["thumb_pivot"] == pytest.approx(-100 / 7 * 0.02 + 0.1, abs=1e-15)
    assert [joint.name for joint in independent_joints(robot)] == ["finger"]


def test_a_chain_with_offsets_composes() -> None:
    """c = 3 b + 1 and b = 2 a + 5 compose to c = 6 a + 16."""
    robot = _chain(
        Joint("a", JointKind.REVOLUTE, "base", "x"),
        Joint("b", JointKind.REVOLUTE, "x", "y", mimic=Mimic("a", 2.0, 5.0)),
        Joint("c", JointKind.REVOLUTE, "y", "z", mimic=Mimic("b", 3.0, 1.0)),
    )
    assert mimic_relation(robot, "c") == ("a", 6.0, 16.0)
    assert complete(robot, {"a": 0.5}) == {"a": 0.5, "b": 6.0, "c": 19.0}


def test_a_circle_of_mimics_is_an_error() -> None:
    """A cycle of mimics is an error instead of an endless loop."""
    robot = _chain(
        Joint("a", JointKind.REVOLUTE, "base", "x", mimic=Mimic("b")),
        Joint("b", JointKind.REVOLUTE, "x", "y", mimic=Mimic("a")),
    )
    with pytest.raises(ValueError, match="mimics itself"):
        mimic_relation(robot, "a")


def test_an_unknown_joint_is_an_error() -> None:
    """An unknown joint name is an error instead of position 0."""
    with pytest.raises(KeyError, match="sholder"):
        link_poses(two_link_arm(), {"sholder": 1.0})
    with pytest.raises(KeyError, match="base_to_post"):
        complete(tree(), {"base_to_post": 1.0})


@pytest.mark.parametrize("q", [(0.3, -0.7, 1.1), (-2.0, 1.4, 3.0)])
def test_joints_of_several_freedoms_in_closed_form(q: tuple[float, float, float]) -> None:
    """Poses of the child of a multi-dof joint are the textbook's rotations."""
    yaw, pitch, roll = q
    ball = link_poses(_chain(Joint("b", JointKind.BALL, "base", "c")), {"b_yaw": yaw, "b_pitch": pitch, "b_roll": roll})
    assert ball["c"].distance_to(Pose.from_xyz_rpy((0, 0, 0), (roll, pitch, yaw))) == pytest.approx((0, 0), abs=1e-14)

    cross = _chain(Joint("u", JointKind.UNIVERSAL, "base", "c", axis=(0.0, 0.0, 1.0), axis2=(1.0, 0.0, 0.0)))
    expected = rotation_about((0, 0, 1), yaw) @ rotation_about((1, 0, 0), pitch)
    np.testing.assert_allclose(link_poses(cross, {"u_1": yaw, "u_2": pitch})["c"].R, expected, atol=1e-15)

    sleeve = _chain(Joint("s", JointKind.CYLINDRICAL, "base", "c", axis=(0.6, 0.0, 0.8)))
    X = link_poses(sleeve, {"s_slide": pitch, "s_turn": yaw})["c"]
    np.testing.assert_allclose(X.p, (0.6 * pitch, 0, 0.8 * pitch), atol=1e-15)
    np.testing.assert_allclose(X.R, rotation_about((0.6, 0, 0.8), yaw), atol=1e-15)

    table = _chain(Joint("t", JointKind.PLANAR, "base", "c", axis=(0.0, 0.0, 1.0)))
    X = link_poses(table, {"t_x": pitch, "t_y": roll, "t_turn": yaw})["c"]
    np.testing.assert_allclose(X.p, (pitch, roll, 0), atol=1e-15)
    np.testing.assert_allclose(X.R, rotation_about((0, 0, 1), yaw), atol=1e-15)


def test_a_screw_advances_as_it_turns() -> None:
    """A screw advances by its pitch along its axis, and its Jacobian agrees at any point of the link."""
    spindle = _chain(Joint("s", JointKind.SCREW, "base", "nut", axis=(0.0, 0.0, 1.0), pitch=0.003))
    X = link_poses(spindle, {"s": 2.5})["nut"]
    np.testing.assert_allclose(X.p, (0, 0, 0.0075), atol=1e-16)
    np.testing.assert_allclose(X.R, rotation_about((0, 0, 1), 2.5), atol=1e-15)
    layout = Tree(spindle)
    J = layout.jacobian(layout.frames(np.array([2.5])), 1, np.array([0.1, 0.0, 0.5]))
    np.testing.assert_allclose(J[:, 0], (0, 0, 1, 0, 0.1, 0.003), atol=1e-15)


def test_a_universal_joint_turns_unevenly() -> None:
    """A universal joint satisfies Cardan's formula tan(driven) = tan(driving) / cos(beta), beta between the shafts."""
    beta, driving = 0.5, 0.8
    # The driving yoke turns about x and carries the cross on its y, in the plane of the shafts; the driven one on its
    # z.
    cross = _chain(
        Joint("one", JointKind.REVOLUTE, "base", "yoke", axis=(1.0, 0.0, 0.0)),
        Joint("u", JointKind.UNIVERSAL, "yoke", "out", axis=(0.0, 1.0, 0.0), axis2=(0.0, 0.0, 1.0)),
    )
    shaft = np.array([np.cos(beta), np.sin(beta), 0.0])
    in_yoke = rotation_about((1, 0, 0), -driving) @ shaft
    q = {"one": driving, "u_2": float(np.arcsin(in_yoke[1])), "u_1": float(np.arctan2(-in_yoke[2], in_yoke[0]))}
    R = link_poses(cross, q)["out"].R
    np.testing.assert_allclose(R[:, 0], shaft, atol=1e-14)
    turned = np.arctan2(np.cross(shaft, (0.0, 0.0, 1.0)) @ R[:, 2], R[2, 2])
    assert np.tan(turned) == pytest.approx(np.tan(driving) / np.cos(beta), rel=1e-14)


@pytest.mark.parametrize("name", ROBOTS)
def test_configurations_keep_limits_and_mimics(name: str) -> None:
    """All 32 configurations are within the limits of every joint, mimics included."""
    robot = ROBOTS[name]()
    drawn = configurations(robot)
    assert len(drawn) == 32
    for q in drawn:
        assert list(q) == [joint.name for joint in moving_joints(robot)]
        assert q == complete(robot, q)
        assert within_limits(robot, q)


def test_configurations_are_the_same_for_everyone() -> None:
    """Configurations are those of PCG64 with a fixed seed, since every report depends on them."""
    first = configurations(two_link_arm(), n=2, seed=1)
    assert first == configurations(two_link_arm(), n=32, seed=1)[:2]
    assert first != configurations(two_link_arm(), n=2, seed=2)
    low, high = -pi / 3, 2 * pi / 3
    assert first[0]["shoulder"] == pytest.approx(low + 0.5118216247002567 * (high - low), abs=1e-15)


@pytest.mark.parametrize(
    ("kind", "limit", "expected"),
    [
        (JointKind.REVOLUTE, Limit(-1.0, 2.0), (-1.0, 2.0)),
        (JointKind.CONTINUOUS, Limit(), (-pi, pi)),
        (JointKind.PRISMATIC, Limit(), (-1.0, 1.0)),
        (JointKind.PRISMATIC, Limit(-inf, 0.25), (-1.0, 0.25)),
        (JointKind.PRISMATIC, Limit(-inf, -5.0), (-6.0, -5.0)),
        (JointKind.REVOLUTE, Limit(5.0, inf), (5.0, 5.0 + pi)),
        (JointKind.PRISMATIC, Limit(-1e9, 0.25), (-1.0, 0.25)),
    ],
)
def test_what_has_no_limit_is_sampled_within_reach(
    kind: JointKind, limit: Limit, expected: tuple[float, float]
) -> None:
    """Joints without limits are sampled within half a turn or a metre; numbers that mean unlimited are ignored."""
    assert sampling_range(Joint("j", kind, "base", "x", limit=limit)) == expected


def test_a_leader_minds_those_who_follow() -> None:
    """The range of a leader is limited by its mimics: the thumb's leaves the finger all of its stroke."""
    robot = gripper_with_mimic()
    assert leader_ranges(robot, ["finger"])["finger"] == (0.0, 0.03)
    thumb = replace(robot.joint_by_name["thumb_pivot"], limit=Limit(-0.1, 1.0))
    robot = replace(robot, joints=(*robot.joints[:-1], thumb))
    low, high = leader_ranges(robot, ["finger"])["finger"]
    assert low == 0.0
    assert high == pytest.approx(0.2 * 7 / 100, abs=1e-15)


@pytest.mark.parametrize(
    ("multiplier", "expected"),
    [(1.0, (-0.6, 0.4)), (-1.0, (-0.4, 0.6)), (2.0, (-0.3, 0.2)), (0.25, (-1.0, 1.0)), (0.0, (-1.0, 1.0))],
)
def test_the_range_that_a_follower_leaves_its_leader(multiplier: float, expected: tuple[float, float]) -> None:
    """Where multiplier * q + 0.1 is between -0.5 and 0.5, within its own; one that stands still bounds nothing."""
    robot = _chain(
        Joint("a", JointKind.REVOLUTE, "base", "x", limit=Limit(-1.0, 1.0)),
        Joint("b", JointKind.REVOLUTE, "x", "y", limit=Limit(-0.5, 0.5), mimic=Mimic("a", multiplier, 0.1)),
    )
    assert leader_ranges(robot, ["a"])["a"] == pytest.approx(expected, abs=1e-15)


def test_contradicting_followers_leave_the_leader_its_own_range() -> None:
    """Contradicting mimics leave the leader its own range, so that poses can still be compared."""
    robot = _chain(
        Joint("a", JointKind.REVOLUTE, "base", "x", limit=Limit(0.0, 1.0)),
        Joint("b", JointKind.REVOLUTE, "x", "y", limit=Limit(5.0, 6.0), mimic=Mimic("a")),
    )
    assert leader_ranges(robot, ["a"])["a"] == (0.0, 1.0)


def test_the_initial_configuration_is_the_drawn_one() -> None:
    """The initial configuration has the drawn position of every movable joint."""
    assert initial_configuration(two_link_arm()) == {"shoulder": 0.0, "elbow": pi / 6}


def test_neighbours_reach_across_fixed_joints_and_closures() -> None:
    """Neighbours are all links connected by a joint or closure, including those fixed to either side."""
    close = neighbours(tree())
    assert frozenset(("base", "left_arm")) in close
    assert frozenset(("post", "right_arm")) in close
    assert frozenset(("left_arm", "tip")) in close
    assert frozenset(("left_arm", "right_arm")) not in close
    assert frozenset(("right_arm", "tip")) not in close
    assert frozenset(("coupler", "rocker")) in neighbours(four_bar())
    assert frozenset(("crank", "rocker")) not in neighbours(four_bar())
