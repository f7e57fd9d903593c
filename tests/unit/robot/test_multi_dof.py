"""Multi-dof joints, unfolded into chains: names, order, unchanged properties."""

from math import inf

import pytest
from msgspec.structs import replace

from stepbot.robot.model import Joint, JointKind, Limit, Link, Robot
from stepbot.robot.multi_dof import ball_coordinates, split, steps_by_child, unfolded
from stepbot.robot.sensors import Sensor, SensorKind
from tests.mechanisms import MECHANISMS
from tests.robots import two_link_arm


@pytest.mark.parametrize("name", MECHANISMS)
def test_unfolding_keeps_links_in_tree_order(name: str) -> None:
    """Every link is in the chain, each parent before its children, each joint in the order of its child."""
    robot = MECHANISMS[name]()
    flat = unfolded(robot)
    names = [link.name for link in flat.links]
    assert [link for link in flat.links if link.name in robot.link_by_name] == list(robot.links)
    assert names[1:] == [joint.child for joint in flat.joints]
    assert all(names.index(joint.parent) < names.index(joint.child) for joint in flat.joints)


def test_a_robot_of_single_freedoms_is_left_alone() -> None:
    """A robot of single joints is returned unchanged."""
    robot = two_link_arm()
    assert unfolded(robot) is robot


def test_names_that_are_taken_are_not_taken_again() -> None:
    """A joint with the name of a new coordinate keeps its name."""
    joints = (Joint("hip", JointKind.BALL, "base", "leg"), Joint("hip_yaw", JointKind.CONTINUOUS, "leg", "hip_pitch"))
    robot = Robot("r", (Link("base"), Link("leg"), Link("hip_pitch")), joints)
    assert ball_coordinates(robot) == {"hip": ("hip_yaw_joint", "hip_pitch_joint", "hip_roll")}
    assert "hip_yaw" in unfolded(robot).joint_by_name


def test_a_floating_joint_ends_in_a_ball() -> None:
    """A floating joint has three distances and the three angles of a ball joint."""
    robot = MECHANISMS["floating"]()
    assert ball_coordinates(robot) == {"free_turn": ("free_turn_yaw", "free_turn_pitch", "free_turn_roll")}
    kinds = [step.kind for step in steps_by_child(robot)["body"]]
    assert kinds == [JointKind.PRISMATIC] * 3 + [JointKind.BALL]


def test_the_slide_of_a_screw_leaves_the_limits_to_the_screw() -> None:
    """The range of a screw is written once, at the rotation."""
    robot = MECHANISMS["screw"]()
    slide, turn = steps_by_child(robot)["body"]
    assert slide.limit == Joint("", JointKind.PRISMATIC, "", "").limit
    assert replace(turn.limit, velocity=0.0) == replace(robot.joints[0].limit, velocity=0.0)


def test_a_screw_without_pitch_does_not_advance() -> None:
    """However far it turns: 0 times infinity is no position."""
    robot = MECHANISMS["screw"]()
    joint = replace(robot.joints[0], pitch=0.0, limit=Limit(-inf, inf))
    slide = split(replace(robot, joints=(joint, *robot.joints[1:])), JointKind.SCREW).joint_by_name[
        f"{joint.name}_slide"
    ]
    assert (slide.limit.lower, slide.limit.upper) == (0.0, 0.0)


@pytest.mark.parametrize("name", MECHANISMS)
def test_sensors_of_an_unfolded_joint(name: str) -> None:
    """An encoder becomes one for each independent step; a force-torque sensor stays above the same link."""
    robot = MECHANISMS[name]()
    joint = robot.joints[0]
    encoder, wrench = (
        Sensor(kind.value, kind, joint.child, joint=joint.name) for kind in (SensorKind.JOINT, SensorKind.FORCE_TORQUE)
    )
    flat = unfolded(replace(robot, sensors=(encoder, wrench)))
    above = {one.child: one for one in flat.joints}
    steps = [above[joint.child]]
    while steps[0].parent != joint.parent:
        steps.insert(0, above[steps[0].parent])
    independent = [step for step in steps if step.mimic is None]
    *encoders, last = flat.sensors
    assert [(one.kind, one.joint, one.link) for one in encoders] == [
        (SensorKind.JOINT, step.name, step.child) for step in independent
    ]
    assert len({one.name for one in flat.sensors}) == len(independent) + 1
    assert last == replace(wrench, joint=steps[-1].name)
