"""Fewer triangles for a mesh: edges are collapsed in the order of the error that this causes.

A vertex moves to a neighbour, so that the vertices of the result are vertices of the mesh. The error of a move is the
sum of the squared distances from the planes of all triangles that the vertex has stood for (Garland and Heckbert,
*Surface simplification using quadric error metrics*, 1997): 0 within a plane and along a straight edge. Borders, and
borders between labels, count as planes across the surface. Many vertices move at once, none of them neighbours, which
numpy does fast.

The result is the same on all machines: sums are in a fixed order, and no operation depends on a linear algebra library.

Meshes that share a budget of triangles get about the same deviation.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray

from .fixed_point import distinct
from .mesh import TriMesh, joined, merged
from .mesh_distance import Integers, largest_distance
from .spatial import Array, cross, dot, lengths

_LEAST_TURN = 0.2
"""Cosine of the largest angle by which a triangle may turn."""
_LEAST_AREA = 1e-18
"""Twice the area [m^2] below which a triangle has none."""
_POWERS = 24
"""Costs that are smaller than the limit by more powers of two are equal."""
_LEAST_SHARE = 1e-3
"""Number of vertices that a pass has to move, as a share of the faces, for another pass with the same limit."""


class Simplification(Struct, eq=False):
    """A mesh that becomes coarser step by step."""

    original: TriMesh
    """With one vertex in place of equal ones."""
    labels: Integers
    """Of each current face (m,)."""
    faces: Integers
    """Current faces (m, 3), as vertices of the original."""
    target: Integers
    """For each vertex of the original, the one that has taken its place."""
    _quadrics: Array
    _blocked: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    """Moves that would fold the surface, as keys."""

    @staticmethod
    def of(mesh: TriMesh, labels: NDArray[np.int32] | None = None) -> "Simplification":
        """Start with a mesh, and a label for each of its faces (m,), whose borders stay; drops faces without area."""
        given = np.zeros(len(mesh.faces), np.int64) if labels is None else labels.astype(np.int64)
        original = merged(mesh)
        faces = original.faces.astype(np.int64)
        kept = lengths(_across(original.vertices, faces)) > _LEAST_AREA
        faces, given = faces[kept], given[kept]
        count = len(original.vertices)
        quadrics = _quadrics(original.vertices, faces, given, count)
        return Simplification(original, given, faces, np.arange(count), quadrics)

    def reduce(self, error: float, faces: int = 0) -> None:
        """Move vertices while the error [m] of a move is at most this, and there are more faces than this."""
        self._blocked = np.zeros(0, np.int64)
        while len(self.faces) > faces:
            if self._pass(error * error, (len(self.faces) - faces + 1) // 2) <= _LEAST_SHARE * len(self.faces):
                return

    def deviation(self) -> float:
        """Largest distance [m] between the surfaces, measured at points of both.

        They are the vertices and the centres of the original's triangles, and the middles of the edges and the centres
        of the current ones, whose vertices are vertices of the original.
        """
        vertices, target = self.original.vertices, self.target
        fine, coarse = self.original.faces.astype(np.int64), self.faces
        used = distinct(fine)
        points = np.concatenate([vertices[used], _centers(vertices, fine)])
        there = largest_distance(points, np.concatenate([target[used], target[fine[:, 0]]]), vertices, coarse, coarse)
        a, b, c = coarse.T
        middles = [0.5 * (vertices[start] + vertices[end]) for start, end in ((a, b), (b, c), (c, a))]
        points = np.concatenate([*middles, _centers(vertices, coarse)])
        return max(there, largest_distance(points, np.concatenate([a, b, c, a]), vertices, fine, target[fine]))

    def piece(self, label: int) -> TriMesh:
        """The current faces with a label."""
        mesh = TriMesh.of(self.original.vertices, self.faces)
        return mesh.subset(self.labels == label)

    def _pass(self, limit: float, most: int) -> int:
        """Move at most so many vertices, none of them neighbours; returns how many were moved, or cannot be."""
        count, vertices = len(self.original.vertices), self.original.vertices
        if not len(self.faces):
            return 0
        # Every edge in both directions, once: its start and its end, sorted.
        a, b = self.faces[:, (0, 1, 2)].reshape(-1), self.faces[:, (1, 2, 0)].reshape(-1)
        keys = distinct(np.concatenate([a * count + b, b * count + a]))
        start, end = keys // count, keys % count
        cost = _cost(self._quadrics[start] + self._quadrics[end], vertices[end])
        order = np.flatnonzero((cost <= limit) & ~np.isin(start * count + end, self._blocked))
        if not len(order):
            return 0
        order = order[_priority(cost[order], limit, start[order], end[order])]
        rank = np.full(count, len(order), np.int64)
        rank[start[order][::-1]] = np.arange(len(order))[::-1]  # the first of each vertex is written last
        to = np.full(count, -1, np.int64)
        best = rank < len(order)
        to[best] = end[order[rank[best]]]
        around = np.full(count, len(order), np.int64)
        first = np.flatnonzero(np.diff(start, prepend=-1))  # the edges are sorted by their starts
        around[start[first]] = np.minimum.reduceat(rank[end], first)
        moved = best & (rank < around)
        moved, unable = self._checked(moved, to, start, end)
        able = np.flatnonzero(moved)
        moved[able[np.argsort(rank[able], kind="stable")[most:]]] = False
        self._blocked = np.concatenate([self._blocked, unable * count + to[unable]])
        self._move(moved, to)
        return int(np.count_nonzero(moved)) + len(unable)

    def _checked(
        self, moved: NDArray[np.bool_], to: Integers, start: Integers, end: Integers
    ) -> tuple[NDArray[np.bool_], Integers]:
        """The vertices that can move without folds or pinches, and those that cannot."""
        vertices, count = self.original.vertices, len(self.original.vertices)
        corner = moved[self.faces]
        touched = corner.any(axis=1)
        faces, corner = self.faces[touched], corner[touched]
        mover = faces[corner]  # one in each: those that move are no neighbours
        goal = to[mover]
        dropped = (faces == goal[:, None]).any(axis=1)
        changed = np.where(corner, goal[:, None], faces)[~dropped]
        before, after = _across(vertices, faces[~dropped]), _across(vertices, changed)
        turn = dot(before, after) - _LEAST_TURN * lengths(before) * lengths(after)
        folds = (turn <= 0.0) | (lengths(after) <= _LEAST_AREA)
        flat = np.bincount(mover, minlength=count)[mover[~dropped]] == 3  # may fall onto another face
        folds[flat] |= np.isin(_triples(changed[flat], count), _triples(self.faces, count))
        unable = np.zeros(count, np.bool_)
        unable[mover[~dropped][folds]] = True
        # A pinch: a neighbour of both ends that is in no face with both.
        of_movers = moved[start]
        shared = np.isin(to[start[of_movers]] * count + end[of_movers], start * count + end)
        neighbours = np.bincount(start[of_movers][shared], minlength=count)
        unable |= moved & (neighbours != np.bincount(mover[dropped], minlength=count))
        return moved & ~unable, np.flatnonzero(moved & unable)

    def _move(self, moved: NDArray[np.bool_], to: Integers) -> None:
        goal = np.where(moved, to, np.arange(len(moved)))
        movers = np.flatnonzero(moved)
        np.add.at(self._quadrics, to[movers], self._quadrics[movers])
        faces = goal[self.faces]
        a, b, c = faces.T
        kept = (a != b) & (b != c) & (c != a)
        self.faces, self.labels = faces[kept], self.labels[kept]
        self.target = goal[self.target]


def _priority(cost: Array, limit: float, start: Integers, end: Integers) -> Integers:
    """The order of moves: by the power of two of their cost, then scattered.

    Where all costs are about equal, as on a sphere, an order by cost or by number would leave hardly any vertex that
    comes before all of its neighbours.
    """
    power = np.maximum(np.frexp(cost)[1], np.frexp(limit)[1] - _POWERS)
    scattered = (start * 2654435761 + end * 40503) & 0xFFFFFFFF
    return np.lexsort((end, start, scattered, power))


def _quadrics(vertices: Array, faces: Integers, labels: Integers, count: int) -> Array:
    """Of each vertex (n, 10), the sum over the planes of its faces, and over planes across borders."""
    across = _across(vertices, faces)
    normals = across / lengths(across)[:, None]
    total = np.zeros((count, 10))
    planes = _planes(normals, vertices[faces[:, 0]])
    for i in range(3):
        np.add.at(total, faces[:, i], planes)
    a, b, face = _border(faces, labels)
    along = vertices[b] - vertices[a]
    outwards = cross(along, normals[face])
    size = lengths(outwards)
    borders = _planes(outwards / np.where(size > 0.0, size, 1.0)[:, None], vertices[a])
    for ends in (a, b):
        np.add.at(total, ends, borders)
    return total


def _border(faces: Integers, labels: Integers) -> tuple[Integers, Integers, Integers]:
    """Edges of faces whose edge no face of the same label shares the other way round: two vertices, and the face."""
    a, b = faces[:, (0, 1, 2)].reshape(-1), faces[:, (1, 2, 0)].reshape(-1)
    face = np.repeat(np.arange(len(faces)), 3)
    count, owners = (int(faces.max()) + 1 if len(faces) else 1), labels[face]
    keys, opposite = (
        (a * count + b) * (owners.max(initial=0) + 1) + owners,
        (b * count + a) * (owners.max(initial=0) + 1) + owners,
    )
    alone = ~np.isin(keys, opposite)
    return a[alone], b[alone], face[alone]


def _planes(normals: Array, points: Array) -> Array:
    """Quadrics (n, 10) of the squared distance from planes."""
    x, y, z = normals.T
    d = -dot(normals, points)
    return np.stack([x * x, x * y, x * z, x * d, y * y, y * z, y * d, z * z, z * d, d * d], axis=1)


def _cost(quadrics: Array, points: Array) -> Array:
    """Values (n,) [m^2] of quadrics at points; not negative."""
    xx, xy, xz, xd, yy, yz, yd, zz, zd, dd = quadrics.T
    x, y, z = points.T
    value = x * (xx * x + 2.0 * (xy * y + xz * z + xd)) + y * (yy * y + 2.0 * (yz * z + yd))
    return np.asarray(np.maximum(value + z * (zz * z + 2.0 * zd) + dd, 0.0))


def _triples(faces: Integers, count: int) -> Integers:
    """A key of each face, the same for all orders of its vertices; ``count`` below two million."""
    low, middle, high = np.sort(faces, axis=1).T
    return np.asarray((low * count + middle) * count + high)


def _centers(vertices: Array, faces: Integers) -> Array:
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return (a + b + c) / 3.0


def _across(vertices: Array, faces: Integers) -> Array:
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return cross(b - a, c - a)


_FIRST, _LAST = 2.0**-17, 2.0**6
"""Smallest and largest limit of error, as a share of the largest diagonal: it is a sum over hundreds of planes."""
_STEP = sqrt(2.0)
_DECIMALS = 7
"""Of deviations [m]."""


class Unit(Struct, frozen=True, eq=False):
    """Meshes with common borders, such as the colours of a part."""

    meshes: tuple[TriMesh, ...]
    count: int
    """How often it is drawn."""


class TriangleBudget(Struct, frozen=True, eq=False):
    """Units that share a budget."""

    units: tuple[Unit, ...]
    max_triangles: int
    """Of all that is drawn."""


class Simplified(Struct, frozen=True, eq=False):
    """The simplified meshes of a budget."""

    units: tuple[tuple[TriMesh, ...], ...]
    """For each unit, its meshes; one may be without faces."""
    triangles: int
    """Of all that is drawn; more than the budget if there is no simpler shape."""
    deviation: float
    """The largest distance [m] between a mesh and its simplified form, in either direction, to 0.1 micrometres."""


def simplified(budget: TriangleBudget) -> Simplified:
    """Collapse edges of all units with the same limit of error, which increases until the budget is met."""
    states = [_started(unit) for unit in budget.units]
    counts = [unit.count for unit in budget.units]
    largest = max((state.original.diagonal for state in states), default=0.0)
    error = _FIRST * largest
    while _drawn(states, counts) > budget.max_triangles and error <= _LAST * largest:
        # Largest first: the last ones may stay finer.
        for index in sorted(range(len(states)), key=lambda i: -counts[i] * len(states[i].faces)):
            surplus = _drawn(states, counts) - budget.max_triangles
            if surplus > 0:
                faces = len(states[index].faces) - -(-surplus // counts[index])
                states[index].reduce(error, max(faces, 0))
        error *= _STEP
    units, deviation = [], 0.0
    for unit, state in zip(budget.units, states, strict=True):
        if len(state.faces) < len(state.original.faces):
            deviation = max(deviation, state.deviation())
            units.append(tuple(state.piece(label) for label in range(len(unit.meshes))))
        else:
            units.append(unit.meshes)
    return Simplified(tuple(units), _drawn(states, counts), round(deviation, _DECIMALS))


def all_simplified(budgets: Sequence[TriangleBudget]) -> tuple[Simplified, ...]:
    """The result of :func:`simplified` for each budget."""
    return tuple(map(simplified, budgets))


def _started(unit: Unit) -> Simplification:
    labels = np.repeat(np.arange(len(unit.meshes), dtype=np.int32), [len(mesh.faces) for mesh in unit.meshes])
    return Simplification.of(joined(list(unit.meshes)), labels)


def _drawn(states: Sequence[Simplification], counts: Sequence[int]) -> int:
    return sum(len(state.faces) * count for state, count in zip(states, counts, strict=True))
