"""Groups and passive joints of the SRDF: what MoveIt plans for, and whose positions it does not wait for."""

from xml.etree import ElementTree as ET

import pytest
from msgspec.structs import replace

from stepbot.formats.urdf.srdf import srdf
from stepbot.robot.model import Actuator, ActuatorKind, JointKind, Limit, Robot
from tests.robots import tree, two_link_arm


def written(robot: Robot) -> tuple[list[str], list[str]]:
    """Names of the groups, and of the passive joints."""
    top = ET.fromstring(srdf(robot.name, None, robot.source, robot))
    return [one.attrib["name"] for one in top.iter("group")], [one.attrib["name"] for one in top.iter("passive_joint")]


def driven(robot: Robot, kind: ActuatorKind, *joints: str) -> Robot:
    """The robot with actuators on these joints alone."""
    return replace(robot, actuators=tuple(Actuator(f"{name}_drive", name, kind) for name in joints))


def test_without_actuators_all_chains_are_planned() -> None:
    """Nothing is passive there: the user moves the joints by sliders."""
    groups, passive = written(replace(two_link_arm(), actuators=()))
    assert len(groups) == 1
    assert not passive


def test_a_single_jaw_at_the_end_is_a_gripper() -> None:
    """By its name; the joints before it are the arm."""
    first, second = two_link_arm().joints
    robot = replace(two_link_arm(), joints=(first, replace(second, name="jaw", limit=Limit(0.0, 1.5))), actuators=())
    assert written(robot)[0] == ["upper_arm", "upper_arm_gripper"]


def test_joints_without_actuators_are_passive() -> None:
    """A chain with a driven joint remains a group; MoveIt does not wait for the positions of the others."""
    arm = two_link_arm()
    first, second = (one.name for one in arm.joints if one.kind is not JointKind.FIXED)
    assert written(driven(arm, ActuatorKind.POSITION, first)) == (written(arm)[0], [second])
    assert written(driven(arm, ActuatorKind.POSITION, first, second)) == (written(arm)[0], [])


def test_chains_that_nothing_drives_are_no_groups() -> None:
    """As casters, rollers and the rods of a delta are, whose loops are open here."""
    robot = replace(tree(), actuators=())
    groups, _ = written(robot)
    moving = [one.name for one in robot.joints if one.kind is not JointKind.FIXED and one.mimic is None]
    found, passive = written(driven(robot, ActuatorKind.POSITION, moving[0]))
    assert len(groups) > len(found) == 1
    assert passive == moving[1:]


@pytest.mark.parametrize(("kind", "is_group"), [(ActuatorKind.VELOCITY, False), (ActuatorKind.POSITION, True)])
def test_wheels_are_no_groups(kind: ActuatorKind, is_group: bool) -> None:
    """A joint that turns without end by a velocity has no positions to plan; nor is it passive."""
    arm = two_link_arm()
    joints = tuple(
        one if one.kind is JointKind.FIXED else replace(one, kind=JointKind.CONTINUOUS, drawn_position=0.0)
        for one in arm.joints
    )
    moving = [one.name for one in joints if one.kind is not JointKind.FIXED]
    groups, passive = written(driven(replace(arm, joints=joints), kind, *moving))
    assert bool(groups) == is_group
    assert not passive
