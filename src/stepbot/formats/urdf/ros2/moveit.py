"""Settings of MoveIt 2: https://moveit.picknik.ai/main/doc/examples/moveit_configuration/moveit_configuration_tutorial.html."""

import json
from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import ActuatorKind, Limit, Robot

from ...lowering.joints import UNLIMITED
from ..chains import Chain, module_of_joint
from ..extensions import COMMANDS
from ..wheels import DifferentialDrive, differential_drive

UPDATE_RATE = 100
"""[Hz]"""
_FORWARD = "forward_command_controller/ForwardCommandController"
CONTROLLERS = {
    ActuatorKind.POSITION: ("position_controller", "joint_trajectory_controller/JointTrajectoryController"),
    ActuatorKind.VELOCITY: ("velocity_controller", _FORWARD),
    ActuatorKind.MOTOR: ("effort_controller", _FORWARD),
}
"""For each kind of actuator, the controller of its joints."""
_BROADCASTER = "joint_state_broadcaster"
_WHEELS = "diff_drive_controller"


def driven(robot: Robot, kind: ActuatorKind) -> dict[str, list[str]]:
    """The joints with an actuator of a kind, by their controller: one for each module and one for all others.

    Wheels of a differential drive have a controller of their own.
    """
    inside, (name, _) = module_of_joint(robot), CONTROLLERS[kind]
    joints: dict[str, list[str]] = {}
    base = differential_drive(robot) if kind is ActuatorKind.VELOCITY else None
    wheels = () if base is None else (*base.left, *base.right)
    for actuator in robot.actuators:
        if actuator.kind is kind and actuator.joint not in wheels:
            module = inside.get(actuator.joint, "")
            of_one = joints.setdefault(f"{module}_{name}" if module else name, [])
            if actuator.joint not in of_one:
                of_one.append(actuator.joint)
    return joints


def controller_names(robot: Robot) -> list[str]:
    """The controllers of a robot with actuators, the broadcaster first."""
    base = differential_drive(robot)
    names = [name for kind in CONTROLLERS for name in driven(robot, kind)]
    return [_BROADCASTER, *names, *([] if base is None else [_name_of(base)])]


def _name_of(base: DifferentialDrive) -> str:
    return f"{base.module}_{_WHEELS}" if base.module else _WHEELS


def _of_base(base: DifferentialDrive) -> dict[str, Any]:
    """The settings of ``diff_drive_controller``, with the speeds that the wheels reach."""
    settings: dict[str, Any] = {
        "left_wheel_names": list(base.left),
        "right_wheel_names": list(base.right),
        "wheel_separation": base.separation,
        "wheel_radius": base.radius,
        "base_frame_id": base.frame,
    }
    if isfinite(base.speed) and base.speed < UNLIMITED:
        ahead = base.speed * base.radius
        for way, axis, speed in (("linear", "x", ahead), ("angular", "z", 2.0 * ahead / base.separation)):
            settings[way] = {axis: {"has_velocity_limits": True, "max_velocity": speed, "min_velocity": -speed}}
    return settings


def controllers(robot: Robot) -> str:
    """``ros2_controllers.yaml``: a broadcaster, and controllers of the base and of each module's kinds of actuators."""
    types: dict[str, Any] = {_BROADCASTER: {"type": f"{_BROADCASTER}/JointStateBroadcaster"}}
    settings: dict[str, Mapping[str, Any]] = {}
    for kind, (_, type_) in CONTROLLERS.items():
        for name, joints in driven(robot, kind).items():
            types[name] = {"type": type_}
            interfaces = {
                "command_interfaces": ["position"],
                "state_interfaces": ["position", "velocity"],
                "allow_partial_joints_goal": True,  # MoveIt moves one group at a time
            }
            more = interfaces if kind is ActuatorKind.POSITION else {"interface_name": COMMANDS[kind]}
            settings[name] = {"ros__parameters": {"joints": joints, **more}}
    base = differential_drive(robot)
    if base is not None:
        types[_name_of(base)] = {"type": f"{_WHEELS}/DiffDriveController"}
        settings[_name_of(base)] = {"ros__parameters": _of_base(base)}
    manager = {"controller_manager": {"ros__parameters": {"update_rate": UPDATE_RATE, **types}}}
    return yaml_text({**manager, **settings})


def yaml_text(value: Mapping[str, Any]) -> str:
    """Block style for mappings and lists of mappings; other lists in one line."""
    return "\n".join(_lines(value, "")) + "\n"


def _lines(value: Mapping[str, Any], indent: str) -> Iterator[str]:
    for key, item in value.items():
        name = f"{indent}{_scalar(key)}:"
        if isinstance(item, Mapping) and item:
            yield name
            yield from _lines(item, f"{indent}  ")
        elif isinstance(item, Sequence) and item and isinstance(item[0], Mapping):
            yield name
            for one in item:
                first, *others = _lines(one, f"{indent}    ")
                yield f"{indent}  - {first.strip()}"
                yield from others
        else:
            yield f"{name} {_scalar(item)}"


def _scalar(value: Any) -> str:
    if isinstance(value, str) and value.isidentifier() and value.lower() not in _WORDS:
        return value
    text = json.dumps(value, ensure_ascii=False)
    # YAML 1.1, as launch files read it, takes a number without a point for a text
    return text.replace("e", ".0e") if isinstance(value, float) and "." not in text else text


_WORDS = frozenset({"true", "false", "yes", "no", "on", "off", "null", "y", "n", "nan", "inf"})
"""Identifiers that some YAML readers do not take for strings."""


def kinematics(arms: Sequence[Chain]) -> str:
    """``kinematics.yaml``: KDL's solver for each group."""
    solver = {
        "kinematics_solver": "kdl_kinematics_plugin/KDLKinematicsPlugin",
        "kinematics_solver_search_resolution": 0.005,
        "kinematics_solver_timeout": 0.05,
    }
    return yaml_text({chain.name: solver for chain in arms})


def cartesian_limits() -> str:
    """``pilz_cartesian_limits.yaml``, which MoveIt's builder of settings needs: the values of its setup assistant."""
    limits = {"max_trans_vel": 1.0, "max_trans_acc": 2.25, "max_trans_dec": -5.0, "max_rot_vel": 1.57}
    return yaml_text({"cartesian_limits": limits})


def initial_positions(robot: Robot) -> str:
    """``initial_positions.yaml``: where the placeholder of the hardware and Gazebo start, the drawn pose."""
    driven = dict.fromkeys(actuator.joint for actuator in robot.actuators)
    return yaml_text({"initial_positions": {name: robot.joint_by_name[name].drawn_position for name in driven}})


def setup_assistant(robot: Robot, package: str) -> str:
    """``.setup_assistant``, by which MoveIt finds the URDF and the SRDF."""
    urdf = {"package": package, "relative_path": f"urdf/{robot.name}.urdf.xacro"}
    srdf = {"relative_path": f"{robot.name}.srdf"}
    return yaml_text({"moveit_setup_assistant_config": {"urdf": urdf, "srdf": srdf}})


def joint_limits(robot: Robot, allowed: Mapping[str, float]) -> str:
    """``joint_limits.yaml``: velocities, jerks where the robot limits them, and accelerations.

    Args:
        allowed: Accelerations of joints that the robot does not limit, since MoveIt plans no trajectory without.
    """
    limits = {}
    for joint in (joint for joint in robot.joints if joint.kind in MOVING and joint.mimic is None):
        bounded = joint.limit.velocity < UNLIMITED
        acceleration = joint.limit.acceleration if isfinite(joint.limit.acceleration) else allowed.get(joint.name, 0.0)
        limits[joint.name] = {
            "has_velocity_limits": bounded,
            "max_velocity": joint.limit.velocity if bounded else 0.0,
            "has_acceleration_limits": acceleration > 0.0,
            "max_acceleration": acceleration,
            **_further(joint.limit),
        }
    return yaml_text({"joint_limits": limits})


def _further(limit: Limit) -> dict[str, float | bool]:
    """Limits that MoveIt has only where a file states them."""
    given = {name: getattr(limit, name) for name in ("deceleration", "jerk") if isfinite(getattr(limit, name))}
    return {k: v for name, value in given.items() for k, v in ((f"has_{name}_limits", True), (f"max_{name}", value))}


def moveit_controllers(robot: Robot) -> str:
    """``moveit_controllers.yaml``: the trajectory controllers of the joints with position actuators."""
    joints = driven(robot, ActuatorKind.POSITION)
    action = {"action_ns": "follow_joint_trajectory", "type": "FollowJointTrajectory", "default": True}
    manager = {"controller_names": list(joints), **{name: {**action, "joints": one} for name, one in joints.items()}}
    return yaml_text(
        {
            "moveit_controller_manager": "moveit_simple_controller_manager/MoveItSimpleControllerManager",
            "moveit_simple_controller_manager": manager,
        }
    )
