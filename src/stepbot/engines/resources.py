"""Resolves the mesh files of a description: relative paths, ``file://``, ``package://`` and ``model://``."""

from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from urllib.parse import unquote, urlsplit

from stepbot.geometry.mesh import obj_bytes
from stepbot.geometry.mesh_files import read_mesh
from stepbot.runtime.file import is_file

_SCHEMES = ("package", "model", "file")


def resolve(uri: str, description: Path, packages: Iterable[Path] = ()) -> Path | None:
    """The file that ``uri`` refers to in a description; None if it does not exist.

    A package is searched upwards from the description: ``package://arm/meshes/a.obj`` is ``meshes/a.obj`` in the first
    folder above that contains it, or in its subfolder ``arm``; before that in ``packages``, folders of packages or the
    folders that contain them.
    """
    return next((candidate for candidate in candidates(uri, description, packages) if is_file(candidate)), None)


def candidates(uri: str, description: Path, packages: Iterable[Path] = ()) -> Iterator[Path]:
    """Candidate paths of the file that ``uri`` refers to, the likeliest first."""
    scheme, _, rest = uri.partition("://")
    if not rest or scheme not in _SCHEMES:
        yield description.parent / uri
    elif scheme == "file":
        yield Path(unquote(urlsplit(uri).path))
    else:
        inside = Path(*Path(rest).parts[1:])
        for folder in (*packages, *description.absolute().parents):
            yield from (folder / rest, folder / inside)


class MeshSubstitutes:
    """Makes the substitutes of one description."""

    def __init__(self, engine: str, readable: Collection[str]) -> None:
        """Start without any.

        Args:
            engine: Name of the engine in prose.
            readable: Suffixes of the files that it reads.
        """
        self._engine, self._readable = engine, readable
        self._replaced: dict[Path, bytes] = {}

    def of(self, path: Path) -> bytes | None:
        """An OBJ of the triangles in a file that the engine does not read; None for others, and for broken files."""
        if path.suffix.lower() in self._readable:
            return None
        if path not in self._replaced:
            mesh = read_mesh(path)
            if mesh is None:
                return None
            self._replaced[path] = obj_bytes(mesh, "mesh")
        return self._replaced[path]

    def notes(self) -> tuple[str, ...]:
        """What was replaced, for the report."""
        kinds = sorted({path.suffix.lower() for path in self._replaced})
        return tuple(
            f"read from a copy with OBJ in place of {kind} meshes, which {self._engine} does not read" for kind in kinds
        )
