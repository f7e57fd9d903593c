"""All files of the package beside the URDF, its SRDF and its meshes."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import JointKind, MeshFormat, Robot

from ..grippers import groups
from .control import controllers
from .gazebo_launch import gazebo_launch
from .launch import rviz, view_launch
from .manifest import MANIFEST, cmake_lists, package_xml
from .moveit import joint_limits, kinematics, moveit_controllers
from .xacro import instance_xacro, macro_xacro

_REMEDIES = {
    "maintainer": ("maintainer: Ada Lovelace <ada@example.com>", "--maintainer 'Ada Lovelace <ada@example.com>'"),
    "license": ("license: Apache-2.0", "--license Apache-2.0"),
}
"""What a package must state: in a sidecar, and as an option."""


def ros2_package(robot: Robot, package: str) -> dict[str, bytes]:
    """The files by path relative to the package's folder.

    Args:
        robot: The robot as URDF expresses it.
        package: Name of the package.
    """
    found, _ = groups(robot)
    texts = {
        MANIFEST: package_xml(robot, package),
        "CMakeLists.txt": cmake_lists(robot, package),
        "launch/view.launch.py": view_launch(robot, package),
        "launch/gazebo.launch.py": gazebo_launch(robot, package),
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


def shown_in_rviz(robot: Robot) -> Robot:
    """The robot with visual meshes as STL, unless the user has chosen a format.

    RViz shows the colour of a URDF only on meshes without materials. Its importer gives those of OBJ files a grey one.
    """
    formats = robot.mesh_formats
    return robot if formats.is_chosen else replace(robot, mesh_formats=replace(formats, visual=MeshFormat.STL))


def report_gaps(robot: Robot, found: Diagnostics) -> None:
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
        help = [f"in the sidecar: `metadata: {{{keys}}}`", f"without a sidecar of yours: `{options}`"]
        found.add("SB640", f"the package {' and '.join(faults)}", Span(MANIFEST), help=help)
    if not robot.actuators:
        joint = next((joint.name for joint in robot.joints if joint.kind is not JointKind.FIXED), "elbow")
        remedy = f"in the sidecar: `actuators: {{{joint}_motor: {{joint: {joint}, kind: position, gains: auto}}}}`"
        found.add("SB641", "no actuators, so the package has no controllers", Span("config"), help=[remedy])
