"""Mechanisms with several loops: MuJoCo's and stepbot's solutions against closed forms."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.geometry.spatial import Pose
from stepbot.robot.closures import close_loops, degrees_of_freedom, driven_joints, loop_ways
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Robot
from tests.closed_mechanisms import (
    DELTA_DRAWN,
    DELTA_PLATFORM,
    HALF_WIDTH,
    HEIGHT,
    delta,
    delta_angle,
    delta_height,
    piston_position,
    slider_crank,
    sliding_closure,
    stewart,
    stewart_anchors,
    welded,
)
from tests.robots import four_bar_angles
from tests.simulators.conftest import look, write


@pytest.mark.parametrize("build", [slider_crank, sliding_closure])
def test_the_piston_is_where_the_textbook_has_it(build: type) -> None:
    """The piston is at x = r cos a + sqrt(l^2 - r^2 sin^2 a), for either closure."""
    robot: Robot = build()
    assert degrees_of_freedom(robot) == 1
    for way in loop_ways(robot):
        for q in way:
            crank = np.pi / 3 + q["shaft"]
            x, y, _ = link_poses(robot, q)["piston"].p
            assert x == pytest.approx(piston_position(crank), abs=1e-12)
            assert y == pytest.approx(0.0, abs=1e-12)


def test_a_weld_joins_two_halves_to_one_rocker() -> None:
    """A rocker of two welded halves follows the angles of the four-bar."""
    robot = welded()
    assert degrees_of_freedom(robot) == 1
    for way in loop_ways(robot):
        for q in way:
            rocker = four_bar_angles(np.pi / 3 + q["crank_pin"])[1]
            turned = rocker - four_bar_angles(np.pi / 3)[1]
            assert np.angle(np.exp(1j * (q["ground_pin"] - turned))) == pytest.approx(0.0, abs=1e-9)


def stewart_platform(X_WL: Pose) -> Pose:
    """Pose of the platform's centre; its link's frame is at its first head."""
    return X_WL @ Pose.of(np.eye(3), -stewart_anchors()[1][0])


@pytest.mark.slow
def test_inverse_kinematics_of_the_stewart_platform() -> None:
    """At any pose the length of each leg is the distance of its ends, |p + R b - a|."""
    robot = stewart()
    assert degrees_of_freedom(robot) == 6
    assert driven_joints(robot) == tuple(f"leg_{leg}" for leg in range(1, 7))
    feet, heads = stewart_anchors()
    drawn = np.linalg.norm(Pose.of(np.eye(3), (0, 0, HEIGHT)).apply(heads) - feet, axis=1)
    seen = 0
    for way in loop_ways(robot):
        for q in way[1:]:
            X_WP = stewart_platform(link_poses(robot, q)["platform"])
            lengths = np.linalg.norm(X_WP.apply(heads) - feet, axis=1)
            legs = [q[f"leg_{leg}"] for leg in range(1, 7)]
            np.testing.assert_allclose(lengths - drawn, legs, atol=1e-10)
            seen += 1
    assert seen >= 12


def test_inverse_kinematics_of_the_delta() -> None:
    """The platform stays level, and each upper arm has the angle of the inverse kinematics."""
    robot = delta()
    assert degrees_of_freedom(robot) == 3
    assert driven_joints(robot) == ("shoulder_0", "shoulder_1", "shoulder_2")
    for way in loop_ways(robot):
        for q in way:
            X_WL = link_poses(robot, q)["platform"]
            np.testing.assert_allclose(X_WL.R, np.eye(3), atol=1e-9)
            centre = X_WL.apply((-DELTA_PLATFORM, -HALF_WIDTH, 0.0))
            angles = [delta_angle(arm, centre) for arm in range(3)]
            np.testing.assert_allclose([DELTA_DRAWN + q[f"shoulder_{arm}"] for arm in range(3)], angles, atol=1e-9)


def test_the_delta_goes_straight_down() -> None:
    """With all arms at one angle the platform is on the axis, at the height of the closed form."""
    robot = delta()
    q = initial_configuration(robot)
    for angle in (0.05, 0.1, 0.2, 0.3):
        q = close_loops(robot, q | {f"shoulder_{arm}": angle for arm in range(3)}, driven_joints(robot))
        centre = link_poses(robot, q)["platform"].apply((-DELTA_PLATFORM, -HALF_WIDTH, 0.0))
        np.testing.assert_allclose(centre, (0, 0, -delta_height(DELTA_DRAWN + angle)), atol=1e-10)


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize(
    "build", [slider_crank, sliding_closure, welded, delta, pytest.param(stewart, marks=pytest.mark.long)]
)
def test_mujoco_closes_all_loops_as_stepbot_does(build: type, tmp_path: Path) -> None:
    """Newton's method on MuJoCo's rows agrees with stepbot's to 1e-9 m and rad over the range."""
    folder = write(build(), tmp_path)
    observed = look("mujoco", folder.request("mjcf"))
    closures = {closure.name: closure for closure in observed.closures or () if "/" not in closure.name}
    assert set(closures) == {closure.name for closure in folder.written["mjcf"].robot.closures}
    for closure in closures.values():
        assert closure.residual == pytest.approx(0.0, abs=1e-9)
        assert closure.angle_error == pytest.approx(0.0, abs=1e-9)
