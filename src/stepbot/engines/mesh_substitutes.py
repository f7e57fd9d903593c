"""OBJ in place of mesh files that an engine does not read, so that it can read the rest of a description."""

from collections.abc import Collection
from pathlib import Path

from stepbot.geometry.mesh import obj_bytes
from stepbot.geometry.mesh_files import read_mesh


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
