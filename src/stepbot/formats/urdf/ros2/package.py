"""All files of the package beside the URDF, its SRDF and its meshes."""

from collections.abc import Iterable, Mapping

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import JointKind, MeshFormat, Robot

from ...xml import document, element, root
from ..grippers import groups
from ..wheels import place_without_frame
from .launch import demo_launch, gazebo_launch, moveit_rviz, rviz, view_launch
from .moveit import (
    cartesian_limits,
    controllers,
    initial_positions,
    joint_limits,
    kinematics,
    moveit_controllers,
    setup_assistant,
)
from .xacro import instance_xacro, macro_xacro

MANIFEST = "package.xml"
_RUN = (
    *("ament_index_python", "launch", "launch_ros"),
    *("robot_state_publisher", "joint_state_publisher_gui", "rviz2", "ros_gz_bridge", "ros_gz_sim", "xacro"),
)
_CONTROL = ("controller_manager", "gz_ros2_control", "ros2_controllers")
"""Further packages for a robot with actuators."""
_PLAN = ("moveit", "moveit_configs_utils")
"""Further packages for a robot with groups."""
_ASSISTANT = ".setup_assistant"
UNKNOWN = "unknown"


def package_xml(robot: Robot, package: str, further: Iterable[str]) -> str:
    """The manifest; a maintainer or licence that the sidecar does not state is unknown."""
    metadata = robot.metadata
    top = root("package", robot.source, format="3")
    element(top, "name", package)
    element(top, "version", metadata.version or "0.0.0")
    element(top, "description", metadata.description or f"Description of {robot.name}")
    element(top, "maintainer", metadata.maintainer or UNKNOWN, email=metadata.email or f"{UNKNOWN}@example.com")
    element(top, "license", metadata.license or UNKNOWN)
    element(top, "buildtool_depend", "ament_cmake")
    for name in (*_RUN, *further):
        element(top, "exec_depend", name)
    element(element(top, "export"), "build_type", "ament_cmake")
    return document(top).decode()


def cmake_lists(robot: Robot, package: str, further: Iterable[str]) -> str:
    """Installs the URDF, its SRDF, further files, and all folders."""
    name = _quoted(robot.name)
    files = " ".join([*(f'"{name}.{suffix}"' for suffix in ("urdf", "srdf")), *further])
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


_REMEDIES = {
    "maintainer": ("maintainer: Ada Lovelace <ada@example.com>", "--maintainer 'Ada Lovelace <ada@example.com>'"),
    "license": ("license: Apache-2.0", "--license Apache-2.0"),
}
"""What a package must state: in a sidecar, and as an option."""


def ros2_package(robot: Robot, package: str, allowed: Mapping[str, float]) -> dict[str, bytes]:
    """The files by path relative to the package's folder.

    Args:
        robot: The robot as URDF expresses it.
        allowed: The acceleration [rad/s^2] or [m/s^2] that the efforts of the whole robot, with its armatures and
            loops, allow each joint.
    """
    planned, _ = groups(robot)
    needed = (*(_CONTROL if robot.actuators else ()), *(_PLAN if planned else ()))
    texts = {
        MANIFEST: package_xml(robot, package, needed),
        "CMakeLists.txt": cmake_lists(robot, package, [_ASSISTANT] if planned else ()),
        "launch/view.launch.py": view_launch(robot, package),
        "launch/gazebo.launch.py": gazebo_launch(robot, package),
        "rviz/view.rviz": rviz(robot),
        "config/joint_limits.yaml": joint_limits(robot, allowed),
    }
    if planned:
        texts |= {
            _ASSISTANT: setup_assistant(robot, package),
            "config/kinematics.yaml": kinematics(planned),
            "config/pilz_cartesian_limits.yaml": cartesian_limits(),
            "config/moveit.rviz": moveit_rviz(robot),
            "config/moveit_controllers.yaml": moveit_controllers(robot),
            "launch/demo.launch.py": demo_launch(robot, package),
        }
    if robot.actuators:
        texts["config/ros2_controllers.yaml"] = controllers(robot)
        texts["config/initial_positions.yaml"] = initial_positions(robot)
    files = {path: text.encode() for path, text in texts.items()}
    files[f"urdf/{robot.name}.macro.xacro"] = macro_xacro(robot, package)
    files[f"urdf/{robot.name}.urdf.xacro"] = instance_xacro(robot)
    return files


def shown_in_rviz(robot: Robot) -> Robot:
    """The robot with visual meshes as STL, unless the user has chosen a format.

    RViz shows the colour of a URDF only on meshes without materials. Its importer gives those of OBJ files a grey one.
    """
    formats = robot.mesh_formats
    return robot if formats.is_chosen else replace(robot, mesh_formats=replace(formats, visual=MeshFormat.STL))


def report_gaps(robot: Robot, diagnostics: Diagnostics) -> None:
    """Report an unknown maintainer or licence (SB640), and a package without controllers (SB641)."""
    metadata, faults, wanted = robot.metadata, list[str](), list[str]()
    missing = [name for name in _REMEDIES if not getattr(metadata, name)]
    if missing:
        faults.append(f"has no {' and no '.join(missing)}")
        wanted += missing
    if metadata.is_placeholder:
        faults.append(f"has a placeholder as maintainer: {metadata.maintainer} <{metadata.email}>")
        wanted.insert(0, "maintainer")
    if faults:
        keys, options = (
            ", ".join(_REMEDIES[name][0] for name in wanted),
            " ".join(_REMEDIES[name][1] for name in wanted),
        )
        help = ["write your own name and address"] if metadata.is_placeholder else []
        help += [f"in the sidecar: `metadata: {{{keys}}}`", f"without a sidecar of yours: `{options}`"]
        diagnostics.add("SB640", f"the package {' and '.join(faults)}", Span(MANIFEST), help=help)
    if not robot.actuators:
        joint = next((joint.name for joint in robot.joints if joint.kind is not JointKind.FIXED), "elbow")
        remedy = f"in the sidecar: `actuators: {{{joint}_motor: {{joint: {joint}, kind: position, gains: auto}}}}`"
        diagnostics.add("SB641", "no actuators, so the package has no controllers", Span("config"), help=[remedy])
    if (place := place_without_frame(robot)) is not None:
        name = robot.root.name
        xyz = ", ".join(f"{value:g}" for value in place)
        origin = f"{{xyz: [{xyz}], relative_to: {name}}}"
        diagnostics.add(
            "SB641",
            "no link or frame of the base is between its wheels, so that they have no `diff_drive_controller`",
            Span("config"),
            help=[f"in the sidecar: `frames: {{axle: {{link: {name}, origin: {origin}}}}}`"],
        )
