"""Mesh files of a description, without materials and without opening referenced files."""

from collections.abc import Iterable
from pathlib import Path

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_files import KINDS, read_mesh

from ..resources import resolve


class MeshFiles:
    """Reads each mesh file of a description once."""

    def __init__(self, description: Path, packages: Iterable[Path] = ()) -> None:
        self._description, self._packages = description, tuple(packages)
        self._meshes: dict[str, TriMesh | None] = {}
        self._files: list[Path] = []

    def mesh(self, uri: str, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> TriMesh | None:
        """Triangles in the file, scaled; None if it is missing or unreadable."""
        if uri not in self._meshes:
            self._meshes[uri] = self._read(uri)
        mesh = self._meshes[uri]
        if mesh is None or scale == (1.0, 1.0, 1.0):
            return mesh
        faces = mesh.faces if scale[0] * scale[1] * scale[2] > 0.0 else mesh.faces[:, ::-1]  # mirrored
        return TriMesh.of(mesh.vertices * scale, faces)

    @property
    def unread(self) -> tuple[str, ...]:
        """The unreadable files, as named in the description, sorted."""
        return tuple(sorted(uri for uri, mesh in self._meshes.items() if mesh is None))

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that were read, in the order of the description."""
        return tuple(dict.fromkeys(self._files))

    def _read(self, uri: str) -> TriMesh | None:
        path = resolve(uri, self._description, self._packages)
        if path is None or path.suffix.lower() not in KINDS:
            return None
        self._files.append(path.resolve())
        return read_mesh(path)
