"""Settings of MoveIt 2: https://moveit.picknik.ai/main/doc/examples/moveit_configuration/moveit_configuration_tutorial.html."""

from collections.abc import Sequence

from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import ActuatorKind, Robot

from ...lowering import UNLIMITED
from ..chains import Chain
from .control import CONTROLLERS, driven
from .yaml_text import yaml_text


def kinematics(found: Sequence[Chain]) -> str:
    """``kinematics.yaml``: KDL's solver for each group."""
    solver = {
        "kinematics_solver": "kdl_kinematics_plugin/KDLKinematicsPlugin",
        "kinematics_solver_search_resolution": 0.005,
        "kinematics_solver_timeout": 0.05,
    }
    return yaml_text({chain.name: solver for chain in found})


def joint_limits(robot: Robot) -> str:
    """``joint_limits.yaml``: velocities of the URDF; accelerations are unknown, and so unlimited."""
    limits = {}
    for joint in (joint for joint in robot.joints if joint.kind in MOVING and joint.mimic is None):
        bounded = joint.limit.velocity < UNLIMITED
        limits[joint.name] = {
            "has_velocity_limits": bounded,
            "max_velocity": joint.limit.velocity if bounded else 0.0,
            "has_acceleration_limits": False,
            "max_acceleration": 0.0,
        }
    return yaml_text({"joint_limits": limits})


def moveit_controllers(robot: Robot) -> str:
    """``moveit_controllers.yaml``: the trajectory controller of the joints with position actuators."""
    name, _ = CONTROLLERS[ActuatorKind.POSITION]
    joints = driven(robot, ActuatorKind.POSITION)
    action = {"action_ns": "follow_joint_trajectory", "type": "FollowJointTrajectory", "default": True}
    manager = {"controller_names": [name] if joints else [], **({name: {**action, "joints": joints}} if joints else {})}
    return yaml_text(
        {
            "moveit_controller_manager": "moveit_simple_controller_manager/MoveItSimpleControllerManager",
            "moveit_simple_controller_manager": manager,
        }
    )
