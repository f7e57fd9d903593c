"""A launch file that puts the robot into Gazebo: https://gazebosim.org/docs/latest/ros2_integration."""

from stepbot.robot.model import Base, Robot
from stepbot.robot.standing import standing_height

from .control import controller_names
from .xacro import GAZEBO_HARDWARE


def gazebo_launch(robot: Robot, package: str) -> str:
    """Starts Gazebo with the robot in a world, and the controllers of its actuators.

    A robot with a fixed base is mounted on the link ``world``; a floating one stands on a floor at z = 0.
    """
    arguments = " parent:=world" if robot.base is Base.FIXED else ""
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
HEIGHT = {str(standing_height(robot, {}))!r}


def generate_launch_description():
    share = Path(get_package_share_directory({package!r}))
    gazebo = Path(get_package_share_directory("ros_gz_sim")) / "launch" / "gz_sim.launch.py"
    command = f"xacro '{{share / 'urdf' / {robot.name + ".urdf.xacro"!r}}}'{{ARGUMENTS}}"
    if CONTROLLERS:
        command += f" controllers:='{{share / 'config' / 'controllers.yaml'}}'"
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
                arguments=["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"],
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
