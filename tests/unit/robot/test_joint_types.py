"""The table of joint types, against what joints of these types do."""

import pickle

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY
from stepbot.robot.joint_types import JointKind, kinds_with
from stepbot.robot.kinematics import link_poses, moving_joints
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


@pytest.mark.parametrize("kind", [kind for kind in JointKind if kind.chain])
def test_rows_describe_the_motion(kind: JointKind) -> None:
    """What a joint slides along and what stays in place follow from the poses that its coordinates give its child."""
    robot = robots.pendulum()
    (hinge,) = robot.joints
    one = replace(hinge, name="j", kind=kind, X_PC=IDENTITY, axis=(0.0, 0.0, 1.0), axis2=(1.0, 0.0, 0.0), pitch=0.1)
    moved = replace(robot, joints=(replace(one, drawn_position=0.0),))
    names, random = [joint.name for joint in moving_joints(moved)], np.random.default_rng(1)
    samples = [dict(zip(names, random.uniform(0.2, 1.0, len(names)), strict=True)) for _ in range(5)]
    poses = [link_poses(moved, q)[hinge.parent].inverse() @ link_poses(moved, q)[hinge.child] for q in samples]
    p, R = np.array([pose.p for pose in poses]), np.array([pose.R for pose in poses])
    turns, leaves_the_line = np.ptp(R, axis=0).max() > 0.1, np.abs(p[:, :2]).max() > 0.1
    keeps_direction = np.abs(R[:, 2, 2] - 1.0).max() < 1e-12
    about = "" if not turns or leaves_the_line else "line" if keeps_direction else "point"
    assert (kind.about, kind.slides) == (about, np.ptp(p[:, 2]) > 0.01 and not leaves_the_line)


def test_columns_of_the_table() -> None:
    """Types with an axis, those that need limits as SDFormat and URDF do, and those that close loops."""
    assert set(JointKind) - set(kinds_with(has_axis=True)) == {"fixed", "ball", "floating"}
    assert kinds_with(closes=True) == ("fixed", "revolute", "prismatic", "ball")
