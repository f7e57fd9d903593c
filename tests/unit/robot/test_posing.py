"""A robot at given positions, against the closed form of the four-bar linkage."""

from collections.abc import Mapping
from math import pi

import pytest

from stepbot.robot.closures import Loops
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import Robot
from stepbot.robot.posing import NotReached, coordinates, leader_of, posed
from tests.closed_mechanisms import four_bar_angles, piston_position, slider_crank
from tests.robots import ROBOTS


def test_without_positions_a_robot_is_as_drawn() -> None:
    """Loops are closed in the drawing already."""
    for name in ("four_bar", "two_link_arm", "gripper_with_mimic"):
        robot = ROBOTS[name]()
        assert posed(robot, {}) == pytest.approx(initial_configuration(robot), abs=1e-9), name


@pytest.mark.parametrize("turn", [-0.7, 0.3, pi / 2, 2.5])
def test_the_four_bar_follows_its_crank(turn: float) -> None:
    """Coupler and rocker are at the angles of the closed form, on the branch of the drawing."""
    robot = ROBOTS["four_bar"]()
    q = posed(robot, {"crank_pin": turn})
    assert gap(robot, q) < 1e-9
    (coupler, rocker), (was_coupler, was_rocker) = four_bar_angles(pi / 3 + turn), four_bar_angles(pi / 3)
    assert q["crank_pin"] == pytest.approx(turn, abs=1e-12)
    assert q["coupler_pin"] == pytest.approx(coupler - was_coupler - turn, abs=1e-7)
    assert q["ground_pin"] == pytest.approx(rocker - was_rocker, abs=1e-7)


@pytest.mark.parametrize("turn", [0.2, 0.6])
def test_a_loop_follows_any_of_its_joints(turn: float) -> None:
    """A joint that does not drive the loop can be given, too: the crank follows the rocker."""
    robot = ROBOTS["four_bar"]()
    rocker = posed(robot, {"crank_pin": turn})["ground_pin"]
    assert posed(robot, {"ground_pin": rocker})["crank_pin"] == pytest.approx(turn, abs=1e-6)


def test_the_piston_follows_its_shaft() -> None:
    """A sliding joint in a loop, in closed form."""
    q = posed(slider_crank(), {"shaft": 1.2})
    assert q["cylinder"] == pytest.approx(piston_position(pi / 3 + 1.2) - piston_position(pi / 3), abs=1e-8)


def test_a_position_that_the_loop_does_not_allow_is_not_reached() -> None:
    """The rocker stops before its dead centre; where it stops is reported."""
    robot = ROBOTS["four_bar"]()
    lowest = min(four_bar_angles(k * pi / 1800)[1] for k in range(3600)) - four_bar_angles(pi / 3)[1]
    with pytest.raises(NotReached) as caught:
        posed(robot, {"ground_pin": lowest - 0.5})
    assert caught.value.reached["ground_pin"] == pytest.approx(lowest, abs=0.05)


def test_joints_of_one_loop_cannot_all_be_given() -> None:
    """Positions that contradict each other are not reached."""
    with pytest.raises(NotReached):
        posed(ROBOTS["four_bar"](), {"crank_pin": 0.5, "ground_pin": 0.0})


def test_mimics_follow_their_leader() -> None:
    """A chain of mimics, geared and offset."""
    robot = ROBOTS["gripper_with_mimic"]()
    q = posed(robot, {"finger": 0.01})
    assert q == pytest.approx({"finger": 0.01, "finger_mirrored": 0.01, "thumb_pivot": 0.1 - 0.01 * 100 / 7})
    assert leader_of(robot, "thumb_pivot") == "finger"


def test_a_joint_of_several_degrees_of_freedom_has_coordinates() -> None:
    """A pose names the coordinates of a ball joint, not the joint."""
    robot = ROBOTS["ball"]()
    assert list(coordinates(robot)) == ["shoulder_yaw", "shoulder_pitch", "shoulder_roll", "hinge"]
    assert posed(robot, {"shoulder_pitch": 0.4})["shoulder_pitch"] == 0.4
    with pytest.raises(KeyError):
        posed(robot, {"shoulder": 0.4})


def gap(robot: Robot, q: Mapping[str, float]) -> float:
    """The largest gap [m] of the robot's closures."""
    loops = Loops(robot)
    return max(distance for distance, _ in loops.gaps(loops.tree.vector(q)).values())
