"""The files of a robot in a format, as bytes by path: the main file, its companions and the meshes."""

from collections.abc import Mapping
from itertools import chain
from weakref import WeakKeyDictionary

from stepbot.diagnostics import Diagnostics
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import MeshAsset, Rgba, Robot

from . import format_named
from .format import Format
from .lowering import lower

_CONTENTS: WeakKeyDictionary[MeshAsset, dict[tuple[str, Rgba | None], bytes]] = WeakKeyDictionary()
"""Bytes of the meshes currently in use: all formats refer to the same files, so they are made once."""


def render(robot: Robot, name: str, diagnostics: Diagnostics) -> dict[str, bytes]:
    """The files of a robot in one format, by path relative to the output folder: the main file, then its meshes.

    Args:
        diagnostics: Receives features that the format rewrites or lacks; after an error there are no files.

    Raises:
        KeyError: There is no such format.
    """
    written = format_named(name)
    losses = Diagnostics()
    lowered = lower(robot, written, losses)
    diagnostics.extend(losses)
    return {} if losses.has_errors else files_of(lowered, written)


def files_of(lowered: Robot, written: Format) -> dict[str, bytes]:
    """The files of a robot lowered for the format: the main file, its companions and scenes, then its mesh files."""
    files = {main_file(lowered, written): written.writer.render(lowered)}
    companions = written.writer.companions(lowered)
    files |= {beside.path: beside.content for beside in companions}
    files |= written.writer.scenes(lowered)
    robots = (lowered, *(beside.robot for beside in companions)) if written.mesh_files else ()
    for file in chain.from_iterable(MeshFiles(robot).all for robot in robots):
        contents = _CONTENTS.setdefault(file.asset, {})
        key = file.path, file.rgba
        if key not in contents:
            contents[key] = file.content()
        files[file.path] = contents[key]
    return files


def joined(files: Mapping[str, Mapping[str, bytes]]) -> dict[str, bytes]:
    """The files of all formats, which share their meshes."""
    return {path: content for of_format in files.values() for path, content in of_format.items()}


def main_file(robot: Robot, written: Format) -> str:
    """Name of a robot's main file in a format."""
    return f"{written.stem(robot.name)}{written.suffix}"
