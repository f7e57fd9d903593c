"""Controllers of ros2_control for the actuators that the URDF declares: https://control.ros.org."""

from collections.abc import Mapping
from typing import Any

from stepbot.robot.model import ActuatorKind, Robot

from .yaml_text import yaml_text

UPDATE_RATE = 100
"""[Hz]"""
CONTROLLERS = {
    ActuatorKind.POSITION: ("position_controller", "joint_trajectory_controller/JointTrajectoryController"),
    ActuatorKind.VELOCITY: ("velocity_controller", "velocity_controllers/JointGroupVelocityController"),
    ActuatorKind.MOTOR: ("effort_controller", "effort_controllers/JointGroupEffortController"),
}
"""For each kind of actuator, the controller of its joints."""
_BROADCASTER = "joint_state_broadcaster"


def driven(robot: Robot, kind: ActuatorKind) -> list[str]:
    """The joints with an actuator of a kind."""
    return list(dict.fromkeys(actuator.joint for actuator in robot.actuators if actuator.kind is kind))


def controller_names(robot: Robot) -> list[str]:
    """The controllers of a robot with actuators, the broadcaster first."""
    return [_BROADCASTER, *(name for kind, (name, _) in CONTROLLERS.items() if driven(robot, kind))]


def controllers(robot: Robot) -> str:
    """``controllers.yaml``: a broadcaster of joint states, and a controller for each kind of actuator."""
    types: dict[str, Any] = {_BROADCASTER: {"type": f"{_BROADCASTER}/JointStateBroadcaster"}}
    settings: dict[str, Mapping[str, Any]] = {}
    for kind, (name, type_) in CONTROLLERS.items():
        if joints := driven(robot, kind):
            types[name] = {"type": type_}
            interfaces = {
                "command_interfaces": ["position"],
                "state_interfaces": ["position", "velocity"],
                "allow_partial_joints_goal": True,  # MoveIt moves one group at a time
            }
            more = interfaces if kind is ActuatorKind.POSITION else {}
            settings[name] = {"ros__parameters": {"joints": joints, **more}}
    manager = {"controller_manager": {"ros__parameters": {"update_rate": UPDATE_RATE, **types}}}
    return yaml_text({**manager, **settings})
