"""The mesh files of a robot: which mesh is written in which format, under which path.

A file with a colour has one: a mesh that visuals show in several colours has a file for each.
"""

from typing import TypeVar

from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.mesh import obj_bytes
from stepbot.geometry.mesh_bytes import dae_bytes, glb_bytes, stl_bytes

from .mesh_names import UniqueNames
from .model import Collision, Geometry, MeshAsset, MeshFormat, MeshRef, Rgba, Robot, Visual

COLORED = (MeshFormat.DAE, MeshFormat.GLB)
"""Formats whose files have a colour."""


class MeshFile(Struct, frozen=True):
    """A mesh in a format."""

    asset: MeshAsset
    format: MeshFormat
    stem: str
    """Name of the file without suffix."""
    rgba: Rgba | None = None
    """Of a file that has a colour."""

    @property
    def path(self) -> str:
        """Path of the file, relative to the output folder, with forward slashes."""
        return f"meshes/{self.stem}.{self.format.value}"

    def content(self) -> bytes:
        """The file."""
        match self.format:
            case MeshFormat.STL:
                return stl_bytes(self.asset.mesh)
            case MeshFormat.DAE if self.rgba:
                return dae_bytes(self.asset.mesh, self.stem, self.rgba)
            case MeshFormat.GLB if self.rgba:
                return glb_bytes(self.asset.mesh, self.stem, self.rgba)
            case _:
                return obj_bytes(self.asset.mesh, self.stem)


class MeshFiles:
    """The mesh files of a lowered robot, and which of them each shape refers to.

    Attributes:
        all: Every file, in the order of the robot's meshes; visuals first.
    """

    def __init__(self, robot: Robot) -> None:
        self._formats = robot.mesh_formats
        self._assets = robot.mesh_by_name
        self._names = UniqueNames(asset.name for asset in robot.meshes)
        self._stems: dict[tuple[str, Rgba | None], str] = {}
        files: dict[str, MeshFile] = {}
        for shape in robot.distinct_shapes:
            if isinstance(shape.geometry, MeshRef):
                file = self.of(shape)
                files.setdefault(file.path, file)
        order = {asset.name: number for number, asset in enumerate(robot.meshes)}
        self.all = tuple(sorted(files.values(), key=lambda file: order[file.asset.name]))

    def of(self, shape: Visual | Collision) -> MeshFile:
        """The file of a shape whose geometry is a mesh.

        Raises:
            ValueError: The geometry is a primitive.
        """
        if not isinstance(shape.geometry, MeshRef):
            raise ValueError("a primitive has no mesh file")
        name, is_visual = shape.geometry.name, isinstance(shape, Visual)
        kind = self._formats.visual if is_visual else self._formats.collision
        rgba = shape.rgba if isinstance(shape, Visual) and kind in COLORED else None
        return MeshFile(self._assets[name], kind, self._stem(name, rgba), rgba)

    def _stem(self, name: str, rgba: Rgba | None) -> str:
        """The mesh's name for its first colour; a new one for each further."""
        if (name, rgba) not in self._stems:
            is_first = rgba is None or not any(mesh_name == name and color for mesh_name, color in self._stems)
            self._stems[name, rgba] = name if is_first else self._names.unique(name)
        return self._stems[name, rgba]


_Shape = TypeVar("_Shape", Visual, Collision)


def share_meshes(robot: Robot) -> Robot:
    """The same robot without duplicate meshes."""
    first: dict[tuple[bytes, bytes], str] = {}
    contents = ((asset.name, (asset.mesh.vertices.tobytes(), asset.mesh.faces.tobytes())) for asset in robot.meshes)
    kept = {name: first.setdefault(content, name) for name, content in contents}
    instead: dict[Geometry, Geometry] = {MeshRef(own): MeshRef(name) for own, name in kept.items() if own != name}

    def shared(shapes: tuple[_Shape, ...]) -> tuple[_Shape, ...]:
        return tuple(
            replace(shape, geometry=instead[shape.geometry]) if shape.geometry in instead else shape for shape in shapes
        )

    if instead:
        links = (
            replace(link, visuals=shared(link.visuals), collisions=shared(link.collisions)) for link in robot.links
        )
        robot = replace(robot, links=tuple(links))
    used = {shape.geometry for shape in robot.distinct_shapes}
    return replace(robot, meshes=tuple(asset for asset in robot.meshes if MeshRef(asset.name) in used))
