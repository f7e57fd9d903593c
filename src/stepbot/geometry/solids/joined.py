"""The union of solids, kept from the fit of a link's shapes to their scores: a third of the time of either."""

from collections.abc import Sequence
from hashlib import sha256
from typing import Any

from ..mesh import TriMesh
from ..spatial import Pose
from .manifolds import joined_solid

_MOST_FACES = 500_000
"""Maximum number of faces of all unions that are kept, about 100 bytes each."""


class _Kept:
    """The unions that this process has made, by content."""

    unions: dict[bytes, tuple[Any, tuple[int, ...]]] = {}  # noqa: RUF012 - the process has one
    faces = 0


def joined(parts: Sequence[tuple[TriMesh, Pose]]) -> tuple[Any | None, tuple[int, ...]]:
    """:func:`.joined_solid`, which is computed once for equal parts as long as there is room."""
    content = sha256()
    for mesh, X_AC in parts:
        for array in (mesh.vertices, mesh.faces, X_AC.matrix):
            content.update(repr(array.shape).encode())
            content.update(array.tobytes())
    key = content.digest()
    if (kept := _Kept.unions.get(key)) is not None:
        return kept
    union, left_out = joined_solid(parts)
    faces = 0 if union is None else int(union.num_tri())
    if _Kept.faces + faces <= _MOST_FACES:
        _Kept.unions[key] = union, left_out
        _Kept.faces += faces
    return union, left_out
