"""The files of a robot in a format, as bytes by path: the main file, its companions and the meshes."""

from collections.abc import Mapping
from weakref import WeakKeyDictionary

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mesh import obj_bytes
from stepbot.robot.model import MeshAsset, MeshRef, Robot

from . import format_named
from .format import Format
from .lowering import geometries, lower

_OBJ: WeakKeyDictionary[MeshAsset, bytes] = WeakKeyDictionary()
"""Bytes of the meshes currently in use: all formats refer to the same files, so they are made once."""


def render(robot: Robot, name: str, found: Diagnostics) -> dict[str, bytes]:
    """The files of a robot in one format, by path relative to the output folder: the main file, then its meshes.

    Args:
        robot: The robot.
        name: Name or alias of the format.
        found: Receives features that the format rewrites or lacks; after an error there are no files.

    Raises:
        KeyError: There is no such format.
    """
    written = format_named(name)
    losses = Diagnostics()
    lowered = lower(robot, written, losses)
    found.extend(losses)
    return {} if losses.has_errors else files_of(lowered, written)


def files_of(lowered: Robot, written: Format) -> dict[str, bytes]:
    """The files of a robot lowered for the format: the main file, its companions and scenes, then its mesh files."""
    files = {main_file(lowered, written): written.writer.render(lowered)}
    files |= {beside.path: beside.content for beside in written.writer.companions(lowered)}
    files |= written.writer.scenes(lowered)
    for asset in used_meshes(lowered) if written.mesh_files else ():
        if asset not in _OBJ:
            _OBJ[asset] = obj_bytes(asset.mesh, asset.name)
        files[asset.path] = _OBJ[asset]
    return files


def joined(files: Mapping[str, Mapping[str, bytes]]) -> dict[str, bytes]:
    """The files of all formats, which share their meshes."""
    return {path: content for of_format in files.values() for path, content in of_format.items()}


def main_file(robot: Robot, written: Format) -> str:
    """Name of a robot's main file in a format."""
    return f"{written.stem(robot.name)}{written.suffix}"


def used_meshes(robot: Robot) -> tuple[MeshAsset, ...]:
    """The mesh assets that visuals and collisions of the links use, in the robot's order."""
    used = {shape.name for link in robot.links for shape in geometries(link) if isinstance(shape, MeshRef)}
    return tuple(asset for asset in robot.meshes if asset.name in used)
