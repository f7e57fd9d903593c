"""The shapes of a description: visuals and collisions with unique names, meshes as assets named after their files."""

from collections.abc import Callable
from pathlib import PurePosixPath
from urllib.parse import unquote

from stepbot.engines.description import DescribedShape, Description
from stepbot.geometry.mesh import TriMesh
from stepbot.robot.mesh_names import UniqueNames, ascii_name, free_name
from stepbot.robot.model import GREY, Collision, Geometry, MeshAsset, MeshRef, Visual


class Shapes:
    """The shapes of all links."""

    def __init__(self, description: Description, *, drawn: bool) -> None:
        self._shown = description.seen if drawn else [shape for shape in description.shapes if not shape.collides]
        self._solid = [shape for shape in description.shapes if shape.collides]
        self._meshes = UniqueNames()
        self._assets: dict[int, tuple[TriMesh, MeshAsset]] = {}
        self._taken: tuple[set[str], set[str]] = set(), set()

    @property
    def assets(self) -> tuple[MeshAsset, ...]:
        """All meshes that were used so far, sorted by name."""
        return tuple(sorted((asset for _, asset in self._assets.values()), key=lambda asset: asset.name))

    def visuals(self, link: str) -> tuple[Visual, ...]:
        """The visuals of a link; for a picture its collisions if it has none."""
        name = self._namer(link, 0)
        return tuple(
            Visual(name(shape), self._geometry(shape), shape.X_LG, shape.rgba or GREY)
            for shape in self._shown
            if shape.link == link
        )

    def collisions(self, link: str) -> tuple[Collision, ...]:
        """The collisions of a link."""
        name = self._namer(link, 1)
        return tuple(
            Collision(name(shape), self._geometry(shape), shape.X_LG, shape.surface)
            for shape in self._solid
            if shape.link == link
        )

    def _namer(self, link: str, kind: int) -> Callable[[DescribedShape], str]:
        """Names of the shapes of a link, unique among those of all links."""
        suffix = ("_visual", "_collision")[kind]
        return lambda shape: free_name(shape.name or f"{link}{suffix}", f"_{link}", self._taken[kind])

    def _geometry(self, shape: DescribedShape) -> Geometry:
        """A primitive, or the asset of a mesh; equal objects are one."""
        mesh = shape.geometry
        if not isinstance(mesh, TriMesh):
            return mesh
        if id(mesh) not in self._assets:
            name = self._meshes.unique(ascii_name(_stem(shape.mesh) or shape.name or shape.link))
            self._assets[id(mesh)] = mesh, MeshAsset(name, mesh, shape.mesh)
        return MeshRef(self._assets[id(mesh)][1].name)


def _stem(uri: str) -> str:
    return PurePosixPath(unquote(uri.replace("\\", "/"))).stem
