"""``package.xml`` and ``CMakeLists.txt``: https://www.ros.org/reps/rep-0149.html."""

from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Robot

from ...xml import document, element, root

MANIFEST = "package.xml"
_RUN = ("robot_state_publisher", "joint_state_publisher_gui", "rviz2", "ros_gz_bridge", "ros_gz_sim", "xacro")
_CONTROL = ("controller_manager", "gz_ros2_control", "ros2_controllers")
"""Further packages for a robot with actuators."""
UNKNOWN = "unknown"


def package_xml(robot: Robot, package: str) -> str:
    """The manifest; a maintainer or licence that the sidecar does not state is unknown."""
    metadata = robot.metadata
    top = root("package", robot.source, format="3")
    element(top, "name", package)
    element(top, "version", metadata.version or "0.0.0")
    element(top, "description", metadata.description or f"Description of {robot.name}")
    element(top, "maintainer", metadata.maintainer or UNKNOWN, email=metadata.email or f"{UNKNOWN}@example.com")
    element(top, "license", metadata.license or UNKNOWN)
    element(top, "buildtool_depend", "ament_cmake")
    for name in (*_RUN, *(_CONTROL if robot.actuators else ())):
        element(top, "exec_depend", name)
    element(element(top, "export"), "build_type", "ament_cmake")
    return document(top).decode()


def cmake_lists(robot: Robot, package: str) -> str:
    """Installs the URDF, its SRDF, and all folders."""
    name = _quoted(robot.name)
    files = " ".join(f'"{name}.{suffix}"' for suffix in ("urdf", "srdf"))
    folders = " ".join(["config", "launch", *(["meshes"] if MeshFiles(robot).all else []), "rviz", "urdf"])
    return f"""\
cmake_minimum_required(VERSION 3.8)
project({package})
find_package(ament_cmake REQUIRED)
install(FILES {files} DESTINATION share/${{PROJECT_NAME}})
install(DIRECTORY {folders} DESTINATION share/${{PROJECT_NAME}})
ament_package()
"""


def _quoted(name: str) -> str:
    """A name inside a quoted argument of CMake."""
    return name.replace("\\", "\\\\").replace("$", "\\$").replace(";", "\\;")
