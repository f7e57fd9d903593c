"""All files of the package beside the URDF, its SRDF and its meshes."""

from stepbot.robot.model import Robot

from ..chains import chains
from .control import controllers
from .launch import rviz, view_launch
from .manifest import cmake_lists, package_xml
from .moveit import joint_limits, kinematics, moveit_controllers
from .xacro import instance_xacro, macro_xacro


def ros2_package(robot: Robot, package: str) -> dict[str, bytes]:
    """The files by path relative to the package's folder.

    Args:
        robot: The robot as URDF expresses it.
        package: Name of the package.
    """
    found = chains(robot)
    texts = {
        "package.xml": package_xml(robot, package),
        "CMakeLists.txt": cmake_lists(robot, package),
        "launch/view.launch.py": view_launch(robot, package),
        "rviz/view.rviz": rviz(robot),
        "config/kinematics.yaml": kinematics(found),
        "config/joint_limits.yaml": joint_limits(robot),
    }
    if robot.actuators:
        texts["config/controllers.yaml"] = controllers(robot)
        texts["config/moveit_controllers.yaml"] = moveit_controllers(robot)
    files = {path: text.encode() for path, text in texts.items()}
    files[f"urdf/{robot.name}.macro.xacro"] = macro_xacro(robot, package)
    files[f"urdf/{robot.name}.urdf.xacro"] = instance_xacro(robot)
    return files
