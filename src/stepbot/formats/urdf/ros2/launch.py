"""A launch file and settings of RViz, to look at the robot and move its joints."""

from stepbot.robot.model import Robot


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
    from .yaml_text import yaml_text

    displays = [
        {"Class": "rviz_default_plugins/Grid", "Name": "Grid", "Enabled": True},
        {
            "Class": "rviz_default_plugins/RobotModel",
            "Name": "RobotModel",
            "Enabled": True,
            "Description Source": "Topic",
            "Description Topic": {"Value": "/robot_description"},
        },
        {"Class": "rviz_default_plugins/TF", "Name": "TF", "Enabled": False},
    ]
    tools = [{"Class": f"rviz_default_plugins/{name}"} for name in ("MoveCamera", "Select", "FocusCamera", "Measure")]
    return yaml_text(
        {
            "Panels": [{"Class": "rviz_common/Displays", "Name": "Displays"}],
            "Visualization Manager": {
                "Class": "",
                "Displays": displays,
                "Enabled": True,
                "Global Options": {"Fixed Frame": robot.root.name, "Frame Rate": 30},
                "Tools": tools,
                "Views": {"Current": {"Class": "rviz_default_plugins/Orbit", "Name": "Current View", "Distance": 2}},
            },
        }
    )
