"""Closed mechanisms: degrees of freedom, Newton's method, range of motion; against closed forms."""

from math import acos, asin, cos, isclose, pi, sin

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY, Pose, rotation_about
from stepbot.robot.closures import (
    DoesNotClose,
    Loops,
    close_loops,
    closure_gap,
    degrees_of_freedom,
    driven_joints,
    held_by_a_point,
    loop_ways,
)
from stepbot.robot.kinematics import complete, configurations, initial_configuration, link_poses, within_limits
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Limit, Link, LoopClosure, Mimic, Robot
from tests.closed_mechanisms import delta
from tests.robots import ROBOTS, crooked_four_bar, four_bar, four_bar_angles, four_bar_with_zeros, two_link_arm

CRANK, ROD = 0.1, 0.3
"""Lengths [m] of the slider-crank."""


def slider_crank(closure: JointKind = JointKind.REVOLUTE) -> Robot:
    """A crank, a rod and a piston along x, drawn with the crank at 90 degrees."""
    drawn_rod = -asin(CRANK / ROD)
    piston_x = ROD * cos(drawn_rod)
    limit = Limit(-2 * pi, 2 * pi)
    joints = (
        Joint("crank", JointKind.CONTINUOUS, "frame", "crank", Pose.of(rotation_about((0, 0, 1), pi / 2))),
        Joint(
            "pin",
            JointKind.REVOLUTE,
            "crank",
            "rod",
            Pose.of(rotation_about((0, 0, 1), drawn_rod - pi / 2), (CRANK, 0, 0)),
            limit=limit,
        ),
        Joint(
            "piston",
            JointKind.PRISMATIC,
            "frame",
            "piston",
            Pose.of(position=(piston_x, 0, 0)),
            (1.0, 0.0, 0.0),
            limit=Limit(-1.0, 1.0),
        ),
    )
    wrist = LoopClosure("wrist", closure, "rod", Pose.of(position=(ROD, 0, 0)), "piston", IDENTITY)
    return Robot("slider_crank", tuple(Link(n) for n in ("frame", "crank", "rod", "piston")), joints, (wrist,))


def _welded(robot: Robot) -> Robot:
    """The robot with a rigid closure."""
    return replace(robot, closures=tuple(replace(closure, kind=JointKind.FIXED) for closure in robot.closures))


def piston(crank: float) -> float:
    """Travel [m] of the piston from its drawn position, for a rotation of the crank from the drawing."""
    angle = crank + pi / 2
    return CRANK * cos(angle) + (ROD**2 - (CRANK * sin(angle)) ** 2) ** 0.5 - ROD * cos(asin(CRANK / ROD))


def test_four_bar_follows_its_equation_over_a_full_turn() -> None:
    """Rocker and coupler follow Freudenstein's equation to 1e-12 rad."""
    robot = four_bar()
    drawn_crank = pi / 3
    coupler0, rocker0 = four_bar_angles(drawn_crank)
    q = initial_configuration(robot)
    for turn in np.linspace(0.0, 2 * pi, 73)[1:]:
        q = close_loops(robot, {**q, "crank_pin": turn}, ("crank_pin",))
        coupler, rocker = four_bar_angles(drawn_crank + turn)
        assert isclose(_wrapped(q["ground_pin"] - (rocker - rocker0)), 0.0, abs_tol=1e-12)
        relative = (coupler - coupler0) - turn
        assert isclose(_wrapped(q["coupler_pin"] - relative), 0.0, abs_tol=1e-12)


def _wrapped(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def test_slider_crank_follows_its_equation() -> None:
    """A loop with a prismatic joint in the tree follows its closed form."""
    robot = slider_crank()
    for way in loop_ways(robot):
        for q in way:
            assert isclose(q["piston"], piston(q["crank"]), abs_tol=1e-12)


@pytest.mark.parametrize(
    ("robot", "freedom"),
    [
        (four_bar(), 1),
        (four_bar_with_zeros(), 1),
        (slider_crank(), 1),
        (slider_crank(JointKind.BALL), 1),
        (_welded(four_bar()), 0),
        (two_link_arm(), 2),
        (ROBOTS["gripper_with_mimic"](), 1),
    ],
)
def test_degrees_of_freedom_are_counted_by_rank(robot: Robot, freedom: int) -> None:
    """Redundant rows do not reduce the degrees of freedom; mimics do."""
    assert degrees_of_freedom(robot) == freedom


def test_a_closure_holds_what_its_kind_holds() -> None:
    """The rank of each kind's rows is that between two bodies free along and about three axes."""
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    joints, above = [], "base"
    for kind in (JointKind.PRISMATIC, JointKind.CONTINUOUS):
        for number, axis in enumerate(axes):
            joints.append(Joint(f"{kind}{number}", kind, above, f"{kind}{number}", axis=axis))
            above = joints[-1].child
    links = (Link("base"), *(Link(joint.child) for joint in joints))
    expected = {JointKind.BALL: 3, JointKind.REVOLUTE: 5, JointKind.PRISMATIC: 5, JointKind.FIXED: 6}
    for kind, rank in expected.items():
        closure = LoopClosure("c", kind, "base", Pose.of(position=(0.1, 0, 0)), above, Pose.of(position=(0.1, 0, 0)))
        assert degrees_of_freedom(Robot("r", links, tuple(joints), (closure,))) == 6 - rank


def test_a_point_holds_a_pin_in_a_plane_alone() -> None:
    """A four-bar moves alike on a pin and on a ball; a link on a ball that a pin holds still turns about two balls."""
    assert held_by_a_point(four_bar()) == (four_bar().closures[0].name,)
    links = ("base", "yaw", "pitch", "roll")
    axes = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    joints = tuple(
        Joint(child, JointKind.CONTINUOUS, parent, child, axis=axis)
        for parent, child, axis in zip(links, links[1:], axes, strict=False)
    )
    pin = LoopClosure("c", JointKind.REVOLUTE, "base", Pose.of(position=(1, 0, 0)), "roll", Pose.of(position=(1, 0, 0)))
    held = Robot("held", tuple(map(Link, links)), joints, (pin,))
    ball = replace(held, closures=(replace(pin, kind=JointKind.BALL),))
    assert [degrees_of_freedom(one) for one in (held, ball)] == [0, 1]
    assert held_by_a_point(held) == ()


@pytest.mark.parametrize("kind", [JointKind.BALL, JointKind.REVOLUTE, JointKind.PRISMATIC, JointKind.FIXED])
def test_constraint_jacobian_is_the_derivative(kind: JointKind) -> None:
    """The Jacobian is the derivative of the residual at a closed pose, by central differences, with tilted frames."""
    tilted = Pose.from_xyz_rpy((0.1, 0.2, -0.1), (0.3, -0.5, 0.7))
    joints = (
        Joint("a", JointKind.REVOLUTE, "base", "one", tilted, (0.0, 0.6, 0.8)),
        Joint("b", JointKind.PRISMATIC, "one", "two", tilted, (1.0, 0.0, 0.0)),
        Joint("c", JointKind.CONTINUOUS, "base", "three", tilted.inverse(), (0.8, 0.0, 0.6)),
        Joint("d", JointKind.REVOLUTE, "three", "four", tilted, (0.0, 0.0, 1.0), mimic=Mimic("a", -2.0, 0.1)),
    )
    bare = Robot("r", tuple(Link(n) for n in ("base", "one", "two", "three", "four")), joints)
    q = complete(bare, {"a": 0.2, "b": 0.1, "c": -0.4})
    X_W = link_poses(bare, q)
    X_BF = X_W["four"].inverse() @ X_W["two"] @ tilted
    closure = LoopClosure("k", kind, "two", tilted, "four", X_BF, (0.6, 0.0, 0.8))
    loops = Loops(replace(bare, closures=(closure,)))
    u = loops.tree.vector(q)
    residual, J = loops.constraints(u)
    np.testing.assert_allclose(residual, 0.0, atol=1e-15)
    for column, unit in enumerate(np.eye(len(u))):
        ahead, behind = loops.constraints(u + 1e-6 * unit)[0], loops.constraints(u - 1e-6 * unit)[0]
        np.testing.assert_allclose(J[:, column], (ahead - behind) / 2e-6, atol=1e-9)


def test_actuated_joints_drive_first() -> None:
    """Actuated joints drive first, then those nearest the root, and those that add no rank, which cannot follow."""
    robot = four_bar()
    assert driven_joints(robot) == ("crank_pin",)
    by_rocker = replace(robot, actuators=(Actuator("m", "ground_pin", ActuatorKind.MOTOR),))
    assert driven_joints(by_rocker) == ("ground_pin",)
    assert driven_joints(replace(robot, actuators=())) == ("crank_pin",)
    assert driven_joints(two_link_arm()) == ("shoulder", "elbow")
    # the first leg's rods come before the other legs' arms in the robot's order
    assert driven_joints(replace(delta(), actuators=())) == ("shoulder_0", "shoulder_1", "shoulder_2")


def test_an_open_loop_reports_its_residual() -> None:
    """For a rocker that is too short Newton's method stalls, and the residual is the missing length."""
    robot = four_bar()
    X = robot.closures[0].X_BF
    short = replace(robot, closures=(replace(robot.closures[0], X_BF=Pose.of(X.R, X.p + np.array([0, 0, 0.01]))),))
    with pytest.raises(DoesNotClose, match="rocker_pin") as caught:
        close_loops(short, initial_configuration(short), ("crank_pin",))
    assert caught.value.distance == pytest.approx(0.01, rel=1e-6)
    assert caught.value.angle < 1e-9
    with pytest.raises(DoesNotClose):
        loop_ways(short)


def test_a_closure_turned_over_is_open() -> None:
    """Closure axes in opposite directions are not aligned, although their cross product is 0."""
    closure = LoopClosure("pin", JointKind.REVOLUTE, "a", IDENTITY, "b", IDENTITY)
    flipped = Pose.of(rotation_about((1, 0, 0), pi))
    assert closure_gap(closure, IDENTITY, flipped) == (0.0, pytest.approx(pi, abs=1e-15))


def test_gaps_by_kind() -> None:
    """The residual excludes the freedoms of the closure's kind."""
    shifted = Pose.of(rotation_about((0, 0, 1), 0.3), (0.0, 0.003, 0.004))

    def gap(kind: JointKind) -> tuple[float, float]:
        return closure_gap(LoopClosure("c", kind, "a", IDENTITY, "b", IDENTITY), IDENTITY, shifted)

    assert gap(JointKind.BALL) == (pytest.approx(0.005), 0.0)
    assert gap(JointKind.REVOLUTE) == (pytest.approx(0.005), pytest.approx(0.0, abs=1e-15))
    assert gap(JointKind.FIXED) == (pytest.approx(0.005), pytest.approx(0.3))
    assert gap(JointKind.PRISMATIC) == (pytest.approx(0.003), pytest.approx(0.3))


@pytest.mark.parametrize("robot", [four_bar(), four_bar_with_zeros(), slider_crank()])
def test_ways_start_as_drawn_stay_closed_and_span_the_range(robot: Robot) -> None:
    """Each path starts at the drawn pose; every configuration is closed to 1e-12 m and within limits."""
    ways = loop_ways(robot, n=24)
    assert 20 <= sum(len(way) - 1 for way in ways) <= 26
    drawn = initial_configuration(robot)
    for way in ways:
        assert way[0] == pytest.approx(drawn, abs=1e-9)
        for q in way:
            X_W = link_poses(robot, q)
            for closure in robot.closures:
                distance, angle = closure_gap(closure, X_W[closure.link_a], X_W[closure.link_b])
                assert distance < 1e-12
                assert angle < 1e-12
            assert within_limits(robot, q)
    reached = [q[driven_joints(robot)[0]] for way in ways for q in way]
    assert max(reached) == pytest.approx(pi, abs=1e-9)


@pytest.mark.slow
def test_a_way_ends_before_a_dead_centre() -> None:
    """Driven by its piston, the slider-crank stops before the dead centres, which are singular."""
    robot = replace(slider_crank(), actuators=(Actuator("m", "piston", ActuatorKind.MOTOR),))
    reached = [q["piston"] for way in loop_ways(robot) for q in way]
    drawn = ROD * cos(asin(CRANK / ROD))
    assert ROD - CRANK - drawn < min(reached) < -0.05
    assert 0.05 < max(reached) < ROD + CRANK - drawn


def test_a_way_ends_at_a_limit_of_a_following_joint() -> None:
    """A path ends at a limit of 0.2 rad of the rocker."""
    robot = four_bar()
    joints = tuple(
        replace(joint, kind=JointKind.REVOLUTE, limit=Limit(-0.2, 0.2)) if joint.name == "ground_pin" else joint
        for joint in robot.joints
    )
    moved = [q["ground_pin"] for way in loop_ways(replace(robot, joints=joints)) for q in way]
    assert 0.1 < max(map(abs, moved)) <= 0.2


def test_a_five_bar_has_two_drives_and_more_ways() -> None:
    """A five-bar has two independent joints, swept alone and together."""
    robot = _five_bar()
    assert degrees_of_freedom(robot) == 2
    assert driven_joints(robot) == ("left", "right")
    ways = loop_ways(robot, n=40)
    assert len(ways) > 4
    assert any(abs(q["left"]) > 0.2 and abs(q["right"]) > 0.2 for way in ways for q in way)
    assert all(way[0] == pytest.approx(initial_configuration(robot), abs=1e-9) for way in ways)


def _five_bar() -> Robot:
    """Cranks of 0.2 m at x = -0.1 and 0.1, upright; rods of 0.25 m that meet above the middle."""
    lean = acos(0.1 / 0.25)
    limit = Limit(-0.6, 0.6)
    wide = Limit(-3.0, 3.0)

    def crank(side: str, x: float) -> Joint:
        upright = Pose.from_xyz_rpy((x, 0, 0), (0, 0, pi / 2))
        return Joint(side, JointKind.REVOLUTE, "frame", f"{side}_crank", upright, limit=limit)

    def rod(side: str, angle: float) -> Joint:
        X_PC = Pose.from_xyz_rpy((0.2, 0, 0), (0, 0, angle - pi / 2))
        return Joint(f"{side}_elbow", JointKind.REVOLUTE, f"{side}_crank", f"{side}_rod", X_PC, limit=wide)

    joints = (crank("left", -0.1), crank("right", 0.1), rod("left", lean), rod("right", pi - lean))
    tip = Pose.of(position=(0.25, 0, 0))
    closure = LoopClosure("tip", JointKind.REVOLUTE, "left_rod", tip, "right_rod", tip)
    names = ("frame", *(joint.child for joint in joints))
    return Robot("five_bar", tuple(Link(name) for name in names), joints, (closure,))


def test_a_drive_at_its_limit_has_one_way() -> None:
    """A joint drawn at its lower limit is swept upwards only."""
    robot = four_bar()
    joints = tuple(
        replace(joint, kind=JointKind.REVOLUTE, limit=Limit(0.0, 1.0)) if joint.name == "crank_pin" else joint
        for joint in robot.joints
    )
    ways = loop_ways(replace(robot, joints=joints))
    assert len(ways) == 1
    assert max(q["crank_pin"] for q in ways[0]) == pytest.approx(1.0, abs=1e-12)


def test_without_closures_there_are_no_ways() -> None:
    """Without closures there are no paths, and closing returns the completed configuration."""
    robot = two_link_arm()
    assert loop_ways(robot) == ()
    q = configurations(robot, n=1)[0]
    assert close_loops(robot, q, driven_joints(robot)) == q


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-7])
def test_a_joint_through_the_point_that_it_would_hold_cannot_follow(off: float) -> None:
    """A wrist that turns about the ball between two arms moves nothing but by rounding; the loop has its followers."""
    robot = four_bar()
    (pin,) = robot.closures
    wrist = Joint("wrist", JointKind.CONTINUOUS, pin.link_b, "hand", pin.X_BF)
    ball = replace(pin, kind=JointKind.BALL, link_b="hand", X_BF=Pose.of(position=(off, 0.0, 0.0)))
    robot = replace(robot, links=(*robot.links, Link("hand")), joints=(*robot.joints, wrist), closures=(ball,))
    assert degrees_of_freedom(robot) == 2
    assert driven_joints(robot) == ("crank_pin", "wrist")


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [1e-7, 1e-5, 5e-5])
def test_pins_that_are_not_quite_parallel_do_not_lock_the_mechanism(tilt: float) -> None:
    """Slightly tilted pins leave one degree of freedom, and the loop opens by no more than the tilt causes."""
    crooked = crooked_four_bar(tilt)
    assert degrees_of_freedom(crooked) == 1
    assert driven_joints(crooked) == ("crank_pin",)
    ways = loop_ways(crooked)
    assert max(q["crank_pin"] for way in ways for q in way) == pytest.approx(pi, abs=1e-9)
    for q in (q for way in ways for q in way):
        X_W = link_poses(crooked, q)
        distance, angle = closure_gap(crooked.closures[0], X_W["coupler"], X_W["rocker"])
        assert distance < tilt * 0.3
        assert angle < 3 * tilt


def test_a_small_mechanism_counts_like_a_large_one() -> None:
    """A four-bar 300 micrometres long has the degrees of freedom of a large one."""
    robot = four_bar()

    def shrunk(X: Pose) -> Pose:
        return Pose.of(X.R, X.p * 1e-3)

    joints = tuple(replace(joint, X_PC=shrunk(joint.X_PC)) for joint in robot.joints)
    closures = tuple(replace(c, X_AF=shrunk(c.X_AF), X_BF=shrunk(c.X_BF)) for c in robot.closures)
    small = replace(robot, joints=joints, closures=closures)
    assert degrees_of_freedom(small) == 1
    assert max(q["crank_pin"] for way in loop_ways(small) for q in way) == pytest.approx(pi, abs=1e-9)
