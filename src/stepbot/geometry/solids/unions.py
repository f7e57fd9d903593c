"""The union of solids: the fit of a link's shapes and their scores need the same one, so it is kept in between."""

from collections.abc import Sequence
from hashlib import sha256
from typing import Any

from ..mesh import TriMesh
from ..spatial import Pose
from .manifolds import joined_solid

_Union = tuple[Any | None, tuple[int, ...]]
"""As :func:`.joined_solid` returns it."""

_MOST_FACES = 500_000
"""Maximum number of faces of all unions that are kept, at about 230 bytes each (manifold3d 3.5)."""


class _Unions:
    """Unions by content, as long as there is room."""

    def __init__(self) -> None:
        self._kept: dict[bytes, _Union] = {}
        self._faces = 0

    def of(self, parts: Sequence[tuple[TriMesh, Pose]]) -> _Union:
        key = _content(parts)
        if key in self._kept:
            return self._kept[key]
        solid, left_out = joined_solid(parts)
        faces = 0 if solid is None else int(solid.num_tri())
        if self._faces + faces <= _MOST_FACES:
            self._kept[key] = solid, left_out
            self._faces += faces
        return solid, left_out


_UNIONS = _Unions()
"""Those of this process."""


def union(parts: Sequence[tuple[TriMesh, Pose]]) -> _Union:
    """:func:`.joined_solid`, computed once for equal parts."""
    return _UNIONS.of(parts)


def _content(parts: Sequence[tuple[TriMesh, Pose]]) -> bytes:
    """A hash of meshes and poses."""
    content = sha256()
    for mesh, X_AC in parts:
        for array in (mesh.vertices, mesh.faces, X_AC.matrix):
            content.update(repr(array.shape).encode())
            content.update(array.tobytes())
    return content.digest()
