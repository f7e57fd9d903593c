"""The union of solids: the fit of a link's shapes and their scores need the same one, so it is kept in between."""

from collections.abc import Sequence
from functools import cached_property
from hashlib import sha256
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ..mesh import TriMesh
from ..primitives import Primitive
from ..spatial import Array, Pose
from .manifolds import joined_solid, mesh_arrays

SIMPLIFIED = 1e-3
"""Tolerance of :attr:`Union.simplified`, as a share of the diagonal."""
_MOST_FACES = 500_000
"""Maximum number of faces of all unions that are kept, at about 300 bytes each (manifold3d 3.5)."""


class PlacedSolid(Struct, frozen=True, eq=False):
    """A closed mesh, given in C, in the common frame A."""

    mesh: TriMesh
    X_AC: Pose


class PlacedShape(Struct, frozen=True, eq=False):
    """A shape in the frame A of the solids; of an open mesh, its convex hull counts."""

    geometry: Primitive | TriMesh
    X_AG: Pose


class Union:
    """Solids as one, without voids; other forms of it are made when they are first needed."""

    def __init__(self, manifold: Any, left_out: tuple[int, ...]) -> None:
        self.manifold = manifold
        """None without any volume."""
        self.left_out = left_out
        """Indices of the solids whose meshes bound no volume."""

    @cached_property
    def face_count(self) -> int:
        """Number of faces; 0 without any volume."""
        return 0 if self.manifold is None else int(self.manifold.num_tri())

    @cached_property
    def arrays(self) -> tuple[Array, NDArray[np.int64]]:
        """Vertices (n, 3) [m] and faces (m, 3), sorted."""
        return mesh_arrays(self.manifold)

    @cached_property
    def diagonal(self) -> float:
        """Diagonal [m] of the bounding box."""
        return float(np.linalg.norm(np.ptp(self.arrays[0], axis=0)))

    @cached_property
    def volume(self) -> float:
        """[m^3]."""
        return float(self.manifold.volume())

    @cached_property
    def simplified(self) -> Any:
        """A manifold with fewer faces, whose surface is displaced by at most :data:`SIMPLIFIED`.

        The same one if nothing would be left.
        """
        made = self.manifold.simplify(SIMPLIFIED * self.diagonal)
        return self.manifold if made.is_empty() or made.volume() <= 0.0 else made


_kept: dict[bytes, Union] = {}
"""Those of this process, by the hash of meshes and poses."""


def union(solids: Sequence[PlacedSolid]) -> Union:
    """The union of solids, computed once for equal ones, as long as there is room."""
    content = sha256()
    for one in solids:
        for array in (one.mesh.vertices, one.mesh.faces, one.X_AC.matrix):
            content.update(repr(array.shape).encode())
            content.update(array.tobytes())
    key = content.digest()
    if key in _kept:
        return _kept[key]
    made = Union(*joined_solid([(solid.mesh, solid.X_AC) for solid in solids]))
    if sum(one.face_count for one in (*_kept.values(), made)) <= _MOST_FACES:
        _kept[key] = made
    return made
