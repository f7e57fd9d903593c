"""The table of joint types, against what joints of these types do."""

import pickle
from dataclasses import replace

import pytest

from stepbot.robot.joint_types import JointKind, kinds_with
from stepbot.robot.kinematics import moving_joints
from tests import robots


@pytest.mark.parametrize("kind", list(JointKind))
def test_coordinates_are_those_that_it_unfolds_to(kind: JointKind) -> None:
    """A joint has the coordinates of its row, with their names."""
    robot = robots.pendulum()
    (hinge,) = robot.joints
    one = replace(hinge, name="j", kind=kind, axis=(0.0, 0.0, 1.0), axis2=(1.0, 0.0, 0.0), pitch=0.01)
    assert [joint.name for joint in moving_joints(replace(robot, joints=(one,)))] == [f"j{end}" for end in kind.chain]


def test_a_type_is_its_name() -> None:
    """A type is read from its name, and equal to it, after pickling too."""
    for kind in JointKind:
        assert JointKind(kind.value) is kind
        assert pickle.loads(pickle.dumps(kind)) is kind
        assert kind == kind.value == str(kind)


def test_types_are_found_by_their_row() -> None:
    """`kinds_with` takes columns and derived properties."""
    assert kinds_with(bounded=True) == ("revolute", "prismatic")
    assert kinds_with(is_hinge=True) == ("revolute", "continuous")
    assert kinds_with(is_pair=True) == ("revolute", "continuous", "prismatic")
