"""Mesh files of descriptions: where they are, substitutes where an engine does not read them, and their boxes."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.mesh import obj_bytes
from stepbot.geometry.mesh_files import read_mesh
from stepbot.geometry.spatial import Array, Pose, join_bounds
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds
from stepbot.runtime.file import is_file, read_regular

from .observation import ObservedLink, ObservedShape

_SCHEMES = ("package", "model", "file")


def resolve(uri: str, description: Path, packages: Iterable[Path] = ()) -> Path | None:
    """The file that ``uri`` refers to in a description; None if it does not exist.

    A package is searched upwards from the description: ``package://arm/meshes/a.obj`` is ``meshes/a.obj`` in the first
    folder above that contains it, or in its subfolder ``arm``; before that in ``packages``, folders of packages or the
    folders that contain them. A relative path is of the description's folder, or else of one of ``packages``: those in
    a xacro are relative to the URDF that is made of it elsewhere.
    """
    return next((candidate for candidate in candidates(uri, description, packages) if is_file(candidate)), None)


def candidates(uri: str, description: Path, packages: Iterable[Path] = ()) -> Iterator[Path]:
    """Candidate paths of the file that ``uri`` refers to, the likeliest first."""
    scheme, _, rest = uri.partition("://")
    if not rest or scheme not in _SCHEMES:
        yield from (folder / uri for folder in (description.parent, *packages))
    elif scheme == "file":
        yield Path(unquote(urlsplit(uri).path))
    else:
        inside = Path(*Path(rest).parts[1:])
        for folder in (*packages, *description.absolute().parents):
            yield from (folder / rest, folder / inside)


_STL_HEAD = 1024
"""Bytes within which an STL in ASCII has its first facet."""


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
        if path.suffix.lower() in self._readable and not _is_text_stl(path):
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


def _is_text_stl(path: Path) -> bool:
    """Whether a file is an STL in ASCII, which engines that read binary ones reject."""
    if path.suffix.lower() != ".stl":
        return False
    start = read_regular(path)[:_STL_HEAD]
    return start.lstrip().startswith(b"solid") and b"facet" in start


def box_around(shapes: Sequence[ObservedShape]) -> Bounds | None:
    """Bounding box [m] of all shapes; None without shapes, or if the box of one is unknown."""
    return joined_boxes([shape.bounds for shape in shapes])


def joined_boxes(boxes: Sequence[Bounds | None]) -> Bounds | None:
    """The box around all; None without any, or if one is unknown."""
    known = [box for box in boxes if box is not None]
    return join_bounds(known) if known and len(known) == len(boxes) else None


def with_shapes(
    link: ObservedLink, visuals: tuple[ObservedShape, ...], collisions: tuple[ObservedShape, ...]
) -> ObservedLink:
    """The link with shapes, and the boxes around them."""
    return replace(
        link,
        visual_bounds=box_around(visuals),
        collision_bounds=box_around(collisions),
        has_visuals=bool(visuals),
        has_collisions=bool(collisions),
        visuals=visuals,
        collisions=collisions,
    )


def mesh_file_bounds(
    uri: str, file: Path, X_LG: Pose, scale: Sequence[float] = (1.0, 1.0, 1.0)
) -> tuple[Bounds | None, list[str]]:
    """The bounding box [m] of a mesh file in its link, if it can be read, and the file if it is missing.

    Args:
        uri: The mesh file, as in the description.
    """
    path = resolve(uri, file)
    if path is None:
        return None, [uri]
    vertices = vertices_of(path)
    return (None if vertices is None else mesh_bounds(vertices * np.array(scale), X_LG)), []


def vertices_of(path: Path) -> Array | None:
    """Vertices (n, 3) of a mesh file; None if it cannot be read."""
    content = read_regular(path)
    return _of_obj(content) if path.suffix.lower() == ".obj" else _of_other(path, content)


@lru_cache(maxsize=1024)
def _of_other(path: Path, content: bytes) -> Array | None:  # noqa: ARG001 - a part of the cache key
    mesh = read_mesh(path)
    return None if mesh is None else mesh.vertices


@lru_cache(maxsize=1024)
def _of_obj(obj: bytes) -> Array | None:
    """Vertices (n, 3) of a Wavefront OBJ; parsed once, since visuals and collisions share meshes."""
    words = [line.split()[1:4] for line in obj.splitlines() if line.startswith(b"v ")]
    try:
        vertices = np.array(words, dtype="S").astype(np.float64).reshape(-1, 3)
    except ValueError:
        return None
    if not len(vertices) or not bool(np.isfinite(vertices).all()):
        return None
    vertices.setflags(write=False)
    return vertices
