"""A launch file and settings of RViz, to look at the robot and move its joints."""

from collections.abc import Mapping
from typing import Any

from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.model import Base, Robot
from stepbot.robot.sensors import SensorKind

from ...sdformat.sensors import topic_of
from ..grippers import groups
from .moveit import controller_names, yaml_text
from .xacro import GAZEBO_HARDWARE, LEAST_MASS, needs_least_mass

_MESSAGES = {
    SensorKind.IMU: ("sensor_msgs/msg/Imu", "gz.msgs.IMU"),
    SensorKind.FORCE_TORQUE: ("geometry_msgs/msg/WrenchStamped", "gz.msgs.Wrench"),
    SensorKind.CAMERA: ("sensor_msgs/msg/Image", "gz.msgs.Image"),
    SensorKind.LIDAR: ("sensor_msgs/msg/LaserScan", "gz.msgs.LaserScan"),
}
"""For each kind of sensor its message in ROS and in Gazebo: https://github.com/gazebosim/ros_gz/tree/ros2/ros_gz_bridge."""


def view_launch(robot: Robot, package: str) -> str:
    """Starts robot_state_publisher, joint_state_publisher_gui and RViz; arguments are those of the xacro."""
    return f'''\
"""ros2 launch {package} view.launch.py [prefix:=left_ parent:=world xyz:="0 0 1" rpy:="0 0 0"]."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {{"prefix": "", "parent": "", "xyz": "0 0 0", "rpy": "0 0 0"}}


def generate_launch_description():
    share = Path(get_package_share_directory({package!r}))
    command = ["xacro '", str(share / "urdf" / {robot.name + ".urdf.xacro"!r}), "'"]
    for name in ARGUMENTS:
        command += [f" {{name}}:='", LaunchConfiguration(name), "'"]
    description = ParameterValue(Command(command), value_type=str)
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value) for name, value in ARGUMENTS.items()),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{{"robot_description": description}}],
            ),
            Node(package="joint_state_publisher_gui", executable="joint_state_publisher_gui"),
            Node(package="rviz2", executable="rviz2", arguments=["-d", str(share / "rviz" / "view.rviz")]),
        ]
    )
'''


def rviz(robot: Robot) -> str:
    """Grid, robot and frames, seen from the root link."""
    model = {
        "Class": "rviz_default_plugins/RobotModel",
        "Name": "RobotModel",
        "Enabled": True,
        "Description Source": "Topic",
        "Description Topic": {"Value": "/robot_description"},
    }
    frames = {"Class": "rviz_default_plugins/TF", "Name": "TF", "Enabled": False}
    return _settings(robot.root.name, model, frames)


def moveit_rviz(robot: Robot) -> str:
    """The panel in which MoveIt plans and shows its paths, with the drawn pose as the start."""
    group = groups(robot)[0][0].name
    planning = {
        "Class": "moveit_rviz_plugin/MotionPlanning",
        "Name": "MotionPlanning",
        "Enabled": True,
        "Planning Request": {"Planning Group": group, "Interactive Marker Size": 0, "Query Goal State": True},
        "Planned Path": {"Trajectory Topic": "display_planned_path", "Loop Animation": False},
        "Planning Scene Topic": "monitored_planning_scene",
        "Robot Description": "robot_description",
        "Scene Robot": {"Robot Alpha": 0.5},
    }
    return _settings("world", planning)


def _settings(fixed: str, *shown: Mapping[str, Any]) -> str:
    grid = {"Class": "rviz_default_plugins/Grid", "Name": "Grid", "Enabled": True}
    tools = ("Interact", "MoveCamera", "Select", "FocusCamera", "Measure")
    return yaml_text(
        {
            "Panels": [{"Class": "rviz_common/Displays", "Name": "Displays"}],
            "Visualization Manager": {
                "Class": "",
                "Displays": [grid, *shown],
                "Enabled": True,
                "Global Options": {"Fixed Frame": fixed, "Frame Rate": 30},
                "Tools": [{"Class": f"rviz_default_plugins/{name}"} for name in tools],
                "Views": {"Current": {"Class": "rviz_default_plugins/Orbit", "Name": "Current View", "Distance": 2}},
            },
        }
    )


def demo_launch(robot: Robot, package: str) -> str:
    """Starts MoveIt with its panel of RViz, and controllers with the placeholder of the hardware.

    Without actuators a publisher of joint states takes their place, which holds the drawn pose: paths are planned only.
    """
    drawn = {"rate": 10} | {
        f"zeros.{joint.name}": joint.drawn_position for joint in robot.joints if joint.drawn_position
    }
    publisher = "joint_state_publisher"
    moved = f"""\
    actions.append(Node(package="{publisher}", executable="{publisher}", parameters=[{drawn!r}]))"""
    if robot.actuators:
        moved = f"""\
    actions.append(
        Node(
            package="controller_manager",
            executable="ros2_control_node",
            parameters=[str(moveit.package_path / "config" / "ros2_controllers.yaml")],
            remappings=[("/controller_manager/robot_description", "/robot_description")],
        )
    )
    for name in {controller_names(robot)!r}:
        actions.append(Node(package="controller_manager", executable="spawner", arguments=[name]))"""
    return f'''\
"""ros2 launch {package} demo.launch.py: plan in RViz, and move the placeholder of the hardware."""

from launch import LaunchDescription
from launch_ros.actions import Node
from moveit_configs_utils import MoveItConfigsBuilder
from moveit_configs_utils.launches import (
    generate_move_group_launch,
    generate_moveit_rviz_launch,
    generate_rsp_launch,
    generate_static_virtual_joint_tfs_launch,
)


def generate_launch_description():
    moveit = MoveItConfigsBuilder({robot.name!r}, package_name={package!r}).to_moveit_configs()
    started = [
        generate_static_virtual_joint_tfs_launch(moveit),
        generate_rsp_launch(moveit),
        generate_move_group_launch(moveit),
        generate_moveit_rviz_launch(moveit),
    ]
    actions = [action for one in started for action in one.entities]
{moved}
    return LaunchDescription(actions)
'''


def bridged(robot: Robot) -> list[str]:
    """What ``parameter_bridge`` hands on to ROS: the clock, and a topic for each sensor."""
    topics = ["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"]
    for sensor in robot.sensors:
        if topic := topic_of(sensor):
            ros, gazebo = _MESSAGES[sensor.kind]
            topics.append(f"/{topic}@{ros}[{gazebo}")
            if sensor.kind is SensorKind.CAMERA:
                topics.append(f"/{sensor.name}/camera_info@sensor_msgs/msg/CameraInfo[gz.msgs.CameraInfo")
    return topics


def gazebo_launch(robot: Robot, package: str) -> str:
    """Starts Gazebo with the robot in a world, and the controllers of its actuators.

    A robot with a fixed base is mounted on the link ``world``; a floating one stands on a floor at z = 0.
    """
    arguments = " parent:=world" if robot.base is Base.FIXED else ""
    if needs_least_mass(robot):
        arguments += f" least_mass:={LEAST_MASS:g}"
    controllers: list[str] = []
    if robot.actuators:
        arguments += f" hardware:={GAZEBO_HARDWARE}"
        controllers = controller_names(robot)
    return f'''\
"""ros2 launch {package} gazebo.launch.py [world:=empty.sdf]."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import AppendEnvironmentVariable, DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {arguments!r}
CONTROLLERS = {controllers!r}
TOPICS = {bridged(robot)!r}
HEIGHT = {str(standing_height(robot, {}))!r}


def generate_launch_description():
    share = Path(get_package_share_directory({package!r}))
    gazebo = Path(get_package_share_directory("ros_gz_sim")) / "launch" / "gz_sim.launch.py"
    command = f"xacro '{{share / 'urdf' / {robot.name + ".urdf.xacro"!r}}}'{{ARGUMENTS}}"
    if CONTROLLERS:
        command += f" controllers:='{{share / 'config' / 'ros2_controllers.yaml'}}'"
    description = ParameterValue(Command([command]), value_type=str)
    return LaunchDescription(
        [
            DeclareLaunchArgument("world", default_value="empty.sdf"),
            AppendEnvironmentVariable("GZ_SIM_RESOURCE_PATH", str(share.parent)),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(gazebo)),
                launch_arguments={{"gz_args": ["-r ", LaunchConfiguration("world")]}}.items(),
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{{"robot_description": description, "use_sim_time": True}}],
            ),
            Node(
                package="ros_gz_bridge",
                executable="parameter_bridge",
                arguments=TOPICS,
            ),
            Node(
                package="ros_gz_sim",
                executable="create",
                arguments=["-topic", "robot_description", "-name", {robot.name!r}, "-z", HEIGHT],
            ),
            *(Node(package="controller_manager", executable="spawner", arguments=[name]) for name in CONTROLLERS),
        ]
    )
'''
