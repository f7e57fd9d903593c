"""Mesh files of a description, without opening the files that they refer to."""

from collections.abc import Iterable
from pathlib import Path

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_files import KINDS, Color, MeshContent, read_content
from stepbot.runtime.file import resolved

from ..resources import resolve


class MeshFiles:
    """Reads each mesh file of a description once."""

    def __init__(self, description: Path, packages: Iterable[Path] = ()) -> None:
        self._description, self._packages = description, tuple(packages)
        self._contents: dict[str, MeshContent | None] = {}
        self._files: list[Path] = []

    def mesh(self, uri: str, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> TriMesh | None:
        """Triangles in the file, scaled; None if it is missing or unreadable."""
        content = self._content(uri)
        return None if content is None else _scaled(content.mesh, scale)

    def parts(self, uri: str, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> tuple[tuple[TriMesh, Color | None], ...]:
        """Triangles in the file by colour, scaled; a file without colours is one part; none if it is unreadable."""
        content = self._content(uri)
        if content is None:
            return ()
        parts: tuple[tuple[TriMesh, Color | None], ...] = content.parts or ((content.mesh, None),)
        return tuple((_scaled(mesh, scale), color) for mesh, color in parts)

    def _content(self, uri: str) -> MeshContent | None:
        if uri not in self._contents:
            self._contents[uri] = self._read(uri)
        return self._contents[uri]

    @property
    def unread(self) -> tuple[str, ...]:
        """The unreadable files, as named in the description, sorted."""
        return tuple(sorted(uri for uri, content in self._contents.items() if content is None))

    @property
    def plain(self) -> tuple[str, ...]:
        """The files whose textures or further colours are not read, as named in the description, sorted."""
        return tuple(sorted(uri for uri, content in self._contents.items() if content and content.has_other_looks))

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that were read, in the order of the description."""
        return tuple(dict.fromkeys(self._files))

    def _read(self, uri: str) -> MeshContent | None:
        path = resolve(uri, self._description, self._packages)
        if path is None or path.suffix.lower() not in KINDS:
            return None
        content = read_content(path)
        self._files += [resolved(path), *(content.buffers if content else ())]
        return content


def _scaled(mesh: TriMesh, scale: tuple[float, ...]) -> TriMesh:
    if scale == (1.0, 1.0, 1.0):
        return mesh
    faces = mesh.faces if scale[0] * scale[1] * scale[2] > 0.0 else mesh.faces[:, ::-1]  # mirrored
    return TriMesh.of(mesh.vertices * scale, faces)
