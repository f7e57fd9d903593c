"""Robot to files: one module per format, found by looking, all with the same names.

A module of this package that has a ``NAME`` is a format. It also has ``ALIASES``, ``SUFFIX``, ``TITLE``,
``EXPRESSES`` (what the format can say, see :mod:`.lowering`), ``reserves``, ``render``, which turns a robot
that :func:`.lower` has prepared into the bytes of its main file, and ``companions``, for readers that
need another one beside it. Nothing here touches the disk.
"""

from collections.abc import Mapping
from importlib import import_module
from pkgutil import iter_modules
from typing import Protocol, cast
from weakref import WeakKeyDictionary

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mesh import obj_bytes
from stepbot.robot.model import MeshAsset, MeshRef, Robot

from .companion import Companion
from .lowering import Format, geometries, lower


class Writer(Format, Protocol):
    """The module of a format."""

    NAME: str
    """What users call it: ``urdf``."""
    ALIASES: tuple[str, ...]
    """What else they may call it."""

    def render(self, robot: Robot) -> bytes:
        """The main file of a lowered robot."""

    def companions(self, robot: Robot) -> tuple[Companion, ...]:
        """Files for readers that cannot do with the main one."""


def _discover() -> dict[str, Writer]:
    names = sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))
    modules = [import_module(f"{__name__}.{name}") for name in names]
    writers = [cast(Writer, module) for module in modules if hasattr(module, "NAME")]
    order = {"urdf": 0, "sdf": 1, "mjcf": 2}  # the order in which people name them; what is new comes after
    return {writer.NAME: writer for writer in sorted(writers, key=lambda writer: order.get(writer.NAME, len(order)))}


FORMATS: Mapping[str, Writer] = _discover()
"""All formats by name."""

_OBJ: WeakKeyDictionary[MeshAsset, bytes] = WeakKeyDictionary()
"""Bytes of the meshes that are still in use: all formats refer to the same files, so they are made once."""


def writer_of(name: str) -> Writer:
    """The writer of a format, by its name or an alias.

    Raises:
        KeyError: There is no such format.
    """
    for writer in FORMATS.values():
        if name.lower() in (writer.NAME, *writer.ALIASES):
            return writer
    raise KeyError(name)


def render(robot: Robot, name: str, found: Diagnostics) -> dict[str, bytes]:
    """The files of a robot in one format, by path relative to the output folder: the main file, then its meshes.

    Args:
        robot: The robot.
        name: Name or alias of the format.
        found: Takes what the format says otherwise or not at all; after an error there are no files.

    Raises:
        KeyError: There is no such format.
    """
    writer = writer_of(name)
    losses = Diagnostics()
    lowered = lower(robot, writer, losses)
    found.extend(losses)
    return {} if losses.has_errors else files_of(lowered, writer)


def files_of(lowered: Robot, writer: Writer) -> dict[str, bytes]:
    """The files of a robot that is lowered for the writer already: the main file, its companions, then its meshes."""
    files = {main_file(lowered, writer): writer.render(lowered)}
    files |= {beside.path: beside.content for beside in writer.companions(lowered)}
    for asset in used_meshes(lowered):
        if asset not in _OBJ:
            _OBJ[asset] = obj_bytes(asset.mesh, asset.name)
        files[asset.path] = _OBJ[asset]
    return files


def joined(files: Mapping[str, Mapping[str, bytes]]) -> dict[str, bytes]:
    """The files of all formats, which share their meshes."""
    return {path: content for of_format in files.values() for path, content in of_format.items()}


def main_file(robot: Robot, writer: Writer) -> str:
    """Name of a robot's main file in a format."""
    return f"{robot.name}{writer.SUFFIX}"


def used_meshes(robot: Robot) -> tuple[MeshAsset, ...]:
    """The mesh assets that some link shows or touches with, in the robot's order."""
    used = {shape.name for link in robot.links for shape in geometries(link) if isinstance(shape, MeshRef)}
    return tuple(asset for asset in robot.meshes if asset.name in used)
