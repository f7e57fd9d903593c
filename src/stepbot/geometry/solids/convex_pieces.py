"""Convex decomposition of a solid by planes, mostly those of its own faces.

Machined and printed parts are joined and hollowed at planes of their faces: an L-bracket cut at one of them is two
boxes, exactly. So the candidates are the largest planes of the faces, planes through the axes of bores, and a few
planes across the solid for free-form shapes. Each step makes the cut that reduces the total volume of the hulls most,
until the solid fills the wanted share of it. Then pieces whose common hull fills nearly as much are merged.

Candidates are compared on a simplified mesh, and the cuts are made on the exact one, too, by :mod:`.cut_surfaces`. The
result is the same in every run: gains are compared to nine digits, in a fixed order (decision 0028).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ..fixed_point import distinct_rows, exact_sum
from ..spatial import Array, corners, dot, matrix_product
from .cut_surfaces import ON, CutSurface, Plane, crossings
from .manifolds import hull_faces, hull_points, hull_volume, mesh_arrays
from .primitive_fits import RoundFace
from .slivers import face_normals
from .unions import SIMPLIFIED, Union

Mask = NDArray[np.bool_]

_COARSER = (2e-3, 4e-3)
"""Tolerances of the coarse mesh after the first, as shares of the diagonal: the first that leaves :data:`_FEW`
triangles."""
_FEW = 1500
_PLANES = 30
"""Number of planes of faces to try."""
_ACROSS = 4
"""Number of planes across the solid to try along each axis."""
_NARROWEST = 0.05
"""Radius of a bore, as a share of the diagonal, from which planes through its axis are tried."""
_THINNEST = 2e-3
"""Thickness of a piece, as a share of the solid's diagonal."""
_LEAST_GAIN = 3e-4
"""Share of the hulls' total volume from which a cut is a gain."""
_BLIND_CUTS = 4
"""Number of cuts without a gain that may prepare one: a ring has to be quartered first."""
_ROUNDING = 1e-6
"""Share of a hull's volume up to which it may differ from that of its solid by rounding."""
_SLIVER = 1e-9
"""Volume of a piece, as a share of the hull of the one that it was cut from, up to which it is omitted."""
_ANGLES, _OFFSETS = 1e3, 500.0
"""Steps per unit of a normal, and per diagonal, within which planes count as one."""


class _Cut(Struct, frozen=True, eq=False):
    gain: float
    """Reduction of the hulls' volume [m^3]."""
    plane: Plane


class _Solid:
    """A part of the simplified solid, on one side of several planes.

    Where faces lie on a plane, or cross it by the rounding of their vertices, the cut leaves films without a volume.
    Their points, from which no edge leads away from the plane, do not count.
    """

    def __init__(self, manifold: Any, planes: tuple[Plane, ...] = ()) -> None:
        self.manifold, self.planes = manifold, planes
        points, faces = mesh_arrays(manifold)
        sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        edges = sides[sides[:, 0] < sides[:, 1]].T
        counts = np.ones(len(points), dtype=bool)
        for plane in planes:
            heights = plane.heights(points)
            counts &= _reaching(heights > ON, np.abs(heights) <= ON, edges)
        renumbered = np.cumsum(counts) - 1
        self.points = points[counts]
        """Shape (n, 3) [m]."""
        self.edges = renumbered[edges[:, counts[edges].all(axis=0)]]
        """Indices (2, m) of points."""

    def split(self, plane: Plane) -> "tuple[_Solid, _Solid]":
        """The parts of this solid above and below a plane."""
        x, y, z = plane.normal.tolist()
        above, below = self.manifold.split_by_plane((x, y, z), plane.offset)
        return _Solid(above, (*self.planes, plane)), _Solid(below, (*self.planes, plane.reverse))

    def sections(self, heights: Array) -> "list[_Section]":
        """Where planes cut this solid, by the heights (k, n) [m] of its points above each."""
        above, below = heights > ON, heights < -ON
        first, second = self.edges
        planes, crosses = np.nonzero((above[:, first] & below[:, second]) | (below[:, first] & above[:, second]))
        a, b = first[crosses], second[crosses]
        points = crossings(self.points[a], self.points[b], heights[planes, a], heights[planes, b])
        ends = np.searchsorted(planes, np.arange(len(heights) + 1))
        on = ~(above | below)
        return [
            _Section(
                points[ends[k] : ends[k + 1]],
                on[k],
                (_reaching(above[k], on[k], self.edges), _reaching(below[k], on[k], self.edges)),
            )
            for k in range(len(heights))
        ]


class _Section(Struct, frozen=True, eq=False):
    """Where a plane cuts a solid."""

    points: Array
    """Points (m, 3) [m] where edges cross the plane."""
    on: Mask
    """Points (n,) of the solid that are on the plane."""
    sides: tuple[Mask, Mask]
    """Points (n,) of the solid that belong to the part above and to the part below."""


def _reaching(beyond: Any, on: Any, edges: Any) -> Any:
    """Points beyond a plane, and those on it that have an edge to one: a face on the plane has far corners."""
    if not on.any():
        return beyond
    first, second = edges
    reached = np.zeros(len(on), dtype=bool)
    reached[second[beyond[first]]] = True
    reached[first[beyond[second]]] = True
    return beyond | (reached & on)


class _Piece:
    """A piece of the solid, exact and coarse."""

    def __init__(self, exact: CutSurface, coarse: _Solid) -> None:
        self.exact, self.coarse = exact, coarse
        self.volume, self.hull = float(coarse.manifold.volume()), hull_volume(coarse.points)
        self.search: _Search | None = None
        self.cut: _Cut | None = None

    @property
    def excess(self) -> float:
        """Volume of the hull outside the solid [m^3]: the most that a cut can gain."""
        return self.hull - self.volume


def convex_pieces(solid: Union, bores: Sequence[RoundFace], filled: float, max_pieces: int) -> list[Array]:
    """Points (n, 3) [m] of each convex piece; their hulls together enclose the solid.

    Args:
        bores: Axes of its bores.
        filled: Share of the total volume of its pieces' hulls that the solid has to fill.
    """
    pieces = [_Piece(CutSurface.of(*solid.arrays), _Solid(_simplified(solid)))]
    planes = _candidates(*solid.arrays, bores, solid.diagonal)
    blind = 0
    while len(pieces) < max_pieces:
        total = exact_sum(piece.hull for piece in pieces)
        if exact_sum(piece.volume for piece in pieces) >= filled * total:
            break
        _try_cuts(pieces, planes, _THINNEST * solid.diagonal, _LEAST_GAIN * total)
        best = max(range(len(pieces)), key=lambda i: _rank(pieces[i].cut, total))
        cut = pieces[best].cut
        if cut is None or cut.gain < _LEAST_GAIN * total:
            best = max(range(len(pieces)), key=lambda i: _digits(pieces[i].excess, total))
            cut = _middle_cut(pieces[best])
            blind += 1
            if blind > _BLIND_CUTS:
                break
        else:
            blind = 0
        pieces[best : best + 1] = _halves(pieces[best], cut.plane)
    return _merged(pieces, filled)


def _try_cuts(pieces: Sequence[_Piece], planes: tuple[Array, Array], thinnest: float, least: float) -> None:
    """Find the best cuts of pieces, except where they gain less than a cut that is known, or than the least."""
    for piece in sorted(pieces, key=lambda piece: -piece.excess):
        if piece.excess + _ROUNDING * piece.hull < least:
            break
        if piece.search is None:
            piece.search = _Search(piece, *planes, thinnest)
        piece.cut = piece.search.best(least)
        if piece.cut is not None:
            least = max(least, piece.cut.gain)


def _simplified(solid: Union) -> Any:
    """A mesh with fewer triangles, on which cuts are compared."""
    coarse = solid.manifold
    for tolerance in (SIMPLIFIED, *_COARSER):
        made = solid.simplified if tolerance == SIMPLIFIED else coarse.simplify(tolerance * solid.diagonal)
        if made.is_empty() or made.volume() <= 0.0:
            break
        coarse = made
        if coarse.num_tri() <= _FEW:
            break
    return coarse


def _rank(cut: _Cut | None, total: float) -> float:
    return -1.0 if cut is None else _digits(cut.gain, total)


def _digits(value: float, total: float) -> float:
    """A volume as a share of the total, without the last digits, which depend on threads."""
    return round(value / total, 9)


def _halves(piece: _Piece, plane: Plane) -> list[_Piece]:
    """The parts of a piece on both sides of a plane, those with a volume."""
    halves = [_Piece(*half) for half in zip(piece.exact.split(plane), piece.coarse.split(plane), strict=True)]
    return [half for half in halves if half.hull > 0.0 and half.volume > _SLIVER * piece.hull] or [piece]


class _Search:
    """Searches the cut that reduces the volume of a piece's hull most.

    The corners of the hull, and the points on a plane, give an upper bound of a gain. Planes are tried in the order of
    their bounds, as long as these exceed what is known.
    """

    def __init__(self, piece: _Piece, normals: Array, offsets: Array, thinnest: float) -> None:
        self._points, self._hull = piece.coarse.points, piece.hull
        self._gains: dict[int, float] = {}
        self._bounds: list[float] = []
        if piece.hull <= 0.0 or piece.excess <= _ROUNDING * piece.hull:
            return
        heights = matrix_product(normals, self._points.T) - offsets[:, None]
        crosses = (heights.max(axis=1) > thinnest) & (heights.min(axis=1) < -thinnest)
        self._normals, self._offsets = normals[crosses], offsets[crosses]
        self._sections = piece.coarse.sections(heights[crosses])
        is_corner = np.zeros(len(self._points), dtype=bool)
        is_corner[hull_faces(self._points)] = True
        self._bounds = [self._gain(section, is_corner | section.on) for section in self._sections]

    def best(self, least: float) -> _Cut | None:
        """The first of the cuts that gain most; any other one, or None, if all gain less than ``least`` [m^3]."""
        most = max([least, *self._gains.values()])
        for k in sorted(set(range(len(self._bounds))) - set(self._gains), key=lambda k: -self._bounds[k]):
            if self._bounds[k] < most - _ROUNDING * self._hull:
                break
            self._gains[k] = self._gain(self._sections[k])
            most = max(most, self._gains[k])
        best: _Cut | None = None
        for k, gain in sorted(self._gains.items()):
            if best is None or _digits(gain - best.gain, self._hull) > 0.0:
                best = _Cut(gain, Plane(self._normals[k], float(self._offsets[k])))
        return best

    def _gain(self, section: _Section, some: Mask | None = None) -> float:
        """Reduction of the hull's volume [m^3] by a cut; of only some points (n,), an upper bound of it."""
        sides = section.sides if some is None else [side & some for side in section.sides]
        halves = (np.concatenate([self._points[side], section.points]) for side in sides)
        return self._hull - exact_sum(map(hull_volume, halves))


def _middle_cut(piece: _Piece) -> _Cut:
    """The cut across the longest axis of the bounding box, in its middle."""
    low, high = corners(piece.coarse.points)
    axis = int((high - low).round(9).argmax())
    return _Cut(0.0, Plane(np.eye(3)[axis], float(0.5 * (low + high)[axis])))


def _merged(pieces: list[_Piece], filled: float) -> list[Array]:
    """The points of the pieces, merged while the solid fills enough of the hulls' volume."""
    points = [hull_points(piece.exact.corners()) for piece in pieces]
    hulls = [hull_volume(of) for of in points]
    solid = exact_sum(piece.volume for piece in pieces)
    costs = {(i, j): _cost(points, hulls, i, j) for j in range(len(points)) for i in range(j)}
    left = list(range(len(points)))
    while costs:
        total = exact_sum(hulls[i] for i in left)
        (i, j), cost = min(costs.items(), key=lambda item: (_digits(item[1], total), item[0]))
        if solid < filled * (total + cost) and cost > 1e-6 * total:
            break
        points.append(np.vstack([points[i], points[j]]))
        hulls.append(hulls[i] + hulls[j] + cost)
        left = [k for k in left if k not in (i, j)]
        costs = {pair: known for pair, known in costs.items() if not {i, j} & set(pair)}
        costs |= {(k, len(points) - 1): _cost(points, hulls, k, len(points) - 1) for k in left}
        left.append(len(points) - 1)
    return [points[i] for i in left]


def _cost(points: Sequence[Array], hulls: Sequence[float], i: int, j: int) -> float:
    """Increase of the hulls' volume [m^3] if two pieces share one."""
    return hull_volume(np.vstack([points[i], points[j]])) - hulls[i] - hulls[j]


def _candidates(points: Array, faces: Any, bores: Sequence[RoundFace], diagonal: float) -> tuple[Array, Array]:
    """Normals (n, 3) and offsets (n,) [m] of the planes to try, the larger faces first."""
    normals, areas, a = face_normals(points, faces)
    of_faces = _distinct(normals, np.einsum("ij,ij->i", normals, a), areas, diagonal)
    axes = main_axes(normals, areas)
    candidates = [of_faces]
    wide = sorted((bore for bore in bores if bore.radius >= _NARROWEST * diagonal), key=lambda bore: -bore.radius)
    for bore in wide:
        across = np.cross(bore.direction, axes)
        lengths = np.linalg.norm(across, axis=1)
        across = across[lengths > 0.5] / lengths[lengths > 0.5, None]
        candidates.append((across, dot(across, bore.point)))
    for axis in axes:
        heights = dot(points, axis)
        offsets = np.linspace(heights.min(), heights.max(), _ACROSS + 2)[1:-1]
        candidates.append((np.tile(axis, (_ACROSS, 1)), offsets))
    return np.vstack([planes for planes, _ in candidates]), np.concatenate([offsets for _, offsets in candidates])


def _distinct(normals: Array, offsets: Array, areas: Array, diagonal: float) -> tuple[Array, Array]:
    """The planes with most area, each once whichever side its faces look to."""
    leading = (np.abs(normals) > 0.5 / _ANGLES).argmax(axis=1)
    signs = np.sign(normals[np.arange(len(normals)), leading])
    normals, offsets = normals * signs[:, None], offsets * signs
    keys = np.column_stack([(normals * _ANGLES).round(), (offsets / diagonal * _OFFSETS).round()]).astype(np.int64)
    first, groups = distinct_rows(keys)
    sums = np.bincount(groups, weights=areas)
    # The plane of the largest face stands for its group.
    order = np.lexsort((-areas, groups))
    largest = order[np.searchsorted(groups[order], np.arange(len(first)))]
    chosen = largest[np.lexsort((np.arange(len(sums)), -sums.round(15)))][:_PLANES]
    return normals[chosen], offsets[chosen]


def main_axes(normals: Array, areas: Array) -> Array:
    """Three orthogonal axes (3, 3), as rows: the normals of the largest faces; the coordinate axes without planes."""
    signs = np.sign(normals[np.arange(len(normals)), (np.abs(normals) > 0.5 / _ANGLES).argmax(axis=1)])
    towards = normals * signs[:, None]
    _, groups = distinct_rows((towards * _ANGLES).round().astype(np.int64))
    sums = np.bincount(groups, weights=areas).round(15)
    order = np.lexsort((groups, -areas))
    first = towards[order[[int((groups[order] == g).argmax()) for g in np.argsort(-sums, kind="stable")[:50]]]]
    z = first[0]
    across = first[np.abs(dot(first, z)) < 1.0 / _ANGLES]
    x = across[0] if len(across) else np.eye(3)[int(np.abs(z).argmin())]
    x = x - dot(x, z) * z
    x = x / np.linalg.norm(x)
    return np.vstack([x, np.cross(z, x), z])
