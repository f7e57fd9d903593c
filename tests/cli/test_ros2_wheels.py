"""The controller of a base with two wheels, in the settings of ros2_control."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from ruamel.yaml import YAML

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.urdf.ros2.moveit import controller_names
from stepbot.formats.urdf.ros2.package import ros2_package
from stepbot.formats.urdf.wheels import differential_drive, place_without_frame
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Collision,
    Cylinder,
    Frame,
    Joint,
    JointKind,
    Limit,
    Link,
    Robot,
)

URDF = format_named("urdf")
PAIR = ((0.0, 0.14), (0.0, -0.16))


def rover(
    places: tuple[tuple[float, float], ...], axis: Any = (0, 0, 1), turned: float = 0.0, **settings: Any
) -> Robot:
    """A base with wheels of radius 0.05 at places (x, y), each in a frame whose z is to the left."""
    X_BW = Pose.from_xyz_rpy((0, 0, 0), (-np.pi / 2, 0, 0))
    names = [f"wheel_{i}" for i in range(len(places))]
    rim = Collision("", Cylinder(0.05, 0.02), Pose.from_xyz_rpy((0, 0, 0.01), (0, 0, 0)))
    wheels = [Link(name, collisions=(replace(rim, name=name),)) for name in names]
    heading = Pose.from_xyz_rpy((0, 0, 0), (0, 0, turned))
    joints = [
        Joint(
            f"axle_{i}",
            JointKind.CONTINUOUS,
            "base",
            names[i],
            heading @ Pose.of(X_BW.R, (x, y, 0)),
            axis,
            limit=Limit(velocity=10.0),
        )
        for i, (x, y) in enumerate(places)
    ]
    motors = [Actuator(f"motor_{i}", f"axle_{i}", ActuatorKind.VELOCITY, kv=1.0) for i in range(len(places))]
    return Robot(
        "rover", (Link("base"), *wheels), tuple(joints), actuators=tuple(motors), base=Base.FLOATING, **settings
    )


def test_the_base_of_two_wheels_has_its_controller() -> None:
    """Sizes and speeds by hand: the middles of the wheels, drawn 10 mm to the left of their frames, are 0.3 m apart."""
    files = ros2_package(lower(rover(PAIR), URDF, Diagnostics()), "rover_description", {})
    settings = YAML(typ="safe").load(files["config/ros2_controllers.yaml"].decode())
    manager = settings["controller_manager"]["ros__parameters"]
    assert manager["diff_drive_controller"] == {"type": "diff_drive_controller/DiffDriveController"}
    assert "velocity_controller" not in manager
    speed, turn = 10.0 * 0.05, 2 * 10.0 * 0.05 / 0.3
    limits = {"has_velocity_limits": True}
    found = settings["diff_drive_controller"]["ros__parameters"]
    assert (
        found["angular"]["z"].pop("max_velocity") == -found["angular"]["z"].pop("min_velocity") == pytest.approx(turn)
    )
    assert found == {
        "left_wheel_names": ["axle_0"],
        "right_wheel_names": ["axle_1"],
        "wheel_separation": 0.3,
        "wheel_radius": 0.05,
        "base_frame_id": "base",
        "linear": {"x": {**limits, "max_velocity": speed, "min_velocity": -speed}},
        "angular": {"z": limits},
    }
    assert b"'diff_drive_controller'" in files["launch/gazebo.launch.py"]


@pytest.mark.parametrize(
    "robot",
    [
        rover(PAIR, axis=(0, 0, -1)),
        rover(PAIR, turned=np.pi / 2),
        rover(((0.1, 0.14), (0.1, -0.16))),
        rover(((0.1, 0.14), (-0.1, -0.16))),
        rover((*PAIR, (0.2, 0.14), (0.2, -0.16))),
        rover(((0.0, 0.14),)),
        rover((*PAIR, (0.0, -0.3))),
        replace(rover(PAIR), base=Base.FIXED),
        replace(rover(PAIR), links=tuple(replace(link, collisions=()) for link in rover(PAIR).links)),
    ],
    ids=["backwards", "sideways", "no frame between", "oblique", "slips", "one", "three", "fixed", "no shapes"],
)
def test_wheels_that_no_difference_turns(robot: Robot) -> None:
    """All others have a controller of speeds, as drives of any kind."""
    lowered = lower(robot, URDF, Diagnostics())
    assert differential_drive(lowered) is None
    assert controller_names(lowered) == ["joint_state_broadcaster", "velocity_controller"]


def test_a_frame_between_the_wheels() -> None:
    """Odometry is about a frame of the base, if its root link is elsewhere."""
    frames = (Frame("axle", "base", Pose.from_xyz_rpy((0.1, -0.0, -0.05), (0, 0, 0))),)
    found = differential_drive(lower(rover(((0.1, 0.14), (0.1, -0.16)), frames=frames), URDF, Diagnostics()))
    assert found is not None
    assert (found.frame, found.left, found.right) == ("axle", ("axle_0",), ("axle_1",))


def test_the_frame_that_a_base_lacks_is_stated() -> None:
    """It is in the middle of the wheels; other wheels, and a base that has one, lack none."""
    wheels = ((0.1, 0.14), (0.1, -0.16))
    lacking = lower(rover(wheels), URDF, Diagnostics())
    place = place_without_frame(lacking)
    assert place is not None
    frames = (Frame("axle", "base", Pose.from_xyz_rpy(place, (0, 0, 0))),)
    whole = lower(rover(wheels, frames=frames), URDF, Diagnostics())
    assert place[:2] == pytest.approx((0.1, 0.0))
    assert differential_drive(whole) is not None
    for other in (whole, lower(rover(PAIR), URDF, Diagnostics()), lower(rover(((0.0, 0.14),)), URDF, Diagnostics())):
        assert place_without_frame(other) is None
