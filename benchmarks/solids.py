"""Solids of known volume: plates with bores, and reliefs of thousands of triangles."""

import math

from msgspec import Struct

from .exchange import Exchange, Point


class Plate(Struct, frozen=True):
    """A plate with a row by row grid of bores [mm]."""

    length: float
    width: float
    height: float
    columns: int
    rows: int
    radius: float

    @property
    def volume(self) -> float:
        """[mm^3]."""
        bores = self.columns * self.rows * math.pi * self.radius**2
        return (self.length * self.width - bores) * self.height

    def write(self, to: Exchange) -> int:
        """Write it as a ``MANIFOLD_SOLID_BREP``: plane faces and cylinders with a seam."""
        faces, above, below = [], [], []
        for row in range(self.rows):
            for column in range(self.columns):
                x = self.length * (column + 0.5) / self.columns
                y = self.width * (row + 0.5) / self.rows
                face, top, bottom = _bore(to, (x, y), self.height, self.radius)
                faces.append(face)
                above.append(to.loop([(top, False)], is_outer=False))
                below.append(to.loop([(bottom, True)], is_outer=False))
        corners = [(0.0, 0.0), (self.length, 0.0), (self.length, self.width), (0.0, self.width)]
        return to.solid(faces + _box(to, corners, self.height, above, below))


class Relief(Struct, frozen=True):
    """A square block of 1 mm cells with two plane triangles each on its upper side, like converted meshes."""

    cells: int

    @property
    def volume(self) -> float:
        """[mm^3]."""
        total = 0.0
        for i in range(self.cells):
            for j in range(self.cells):
                a, b, c, d = (_height(*corner) for corner in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
                total += 0.5 * ((a + b + c) / 3.0 + (a + c + d) / 3.0)
        return total

    def write(self, to: Exchange) -> int:
        """Write it as a ``MANIFOLD_SOLID_BREP``."""
        n = self.cells
        point = {(i, j): (float(i), float(j), _height(i, j)) for i in range(n + 1) for j in range(n + 1)}
        vertex = {key: to.vertex(p) for key, p in point.items()}

        def edge(a: tuple[int, int], b: tuple[int, int]) -> int:
            return to.line((vertex[a], point[a]), (vertex[b], point[b]))

        along = {(i, j): edge((i, j), (i + 1, j)) for i in range(n) for j in range(n + 1)}
        across = {(i, j): edge((i, j), (i, j + 1)) for i in range(n + 1) for j in range(n)}
        faces = []
        for i in range(n):
            for j in range(n):
                diagonal = edge((i, j), (i + 1, j + 1))
                a, b, c, d = (point[key] for key in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
                right = to.loop([(along[i, j], True), (across[i + 1, j], True), (diagonal, False)], is_outer=True)
                left = to.loop([(diagonal, True), (along[i, j + 1], False), (across[i, j], False)], is_outer=True)
                faces.append(to.plane([right], a, _normal(a, b, c), _between(a, b)))
                faces.append(to.plane([left], a, _normal(a, c, d), _between(a, c)))
        rims = [
            [(along[i, 0], False) for i in reversed(range(n))],
            [(across[n, j], False) for j in reversed(range(n))],
            [(along[i, n], True) for i in range(n)],
            [(across[0, j], True) for j in range(n)],
        ]
        return to.solid(faces + self._below(to, vertex, rims))

    def _below(self, to: Exchange, vertex: dict[tuple[int, int], int], rims: list[list[tuple[int, bool]]]) -> list[int]:
        """Bottom and sides; each rim is directed from the later corner of its side to the earlier one."""
        n, size = self.cells, float(self.cells)
        corners = [(0.0, 0.0, 0.0), (size, 0.0, 0.0), (size, size, 0.0), (0.0, size, 0.0)]
        feet = [to.vertex(p) for p in corners]
        tops = [(0, 0), (n, 0), (n, n), (0, n)]
        bottom = [to.line((feet[k], corners[k]), (feet[k - 3], corners[k - 3])) for k in range(4)]
        upright = [
            to.line((feet[k], corners[k]), (vertex[tops[k]], (*corners[k][:2], _height(*tops[k])))) for k in range(4)
        ]
        faces = []
        for k, rim in enumerate(rims):
            after = (k + 1) % 4
            bound = to.loop([(bottom[k], True), (upright[after], True), *rim, (upright[k], False)], is_outer=True)
            outwards = [(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)][k]
            faces.append(to.plane([bound], corners[k], outwards, _between(corners[k], corners[after])))
        under = to.loop([(bottom[k], False) for k in reversed(range(4))], is_outer=True)
        return [*faces, to.plane([under], corners[0], (0.0, 0.0, -1.0), (1.0, 0.0, 0.0))]


def _bore(to: Exchange, center: tuple[float, float], height: float, radius: float) -> tuple[int, int, int]:
    """A bore: its face, and its rims above and below."""
    low, high = (*center, 0.0), (*center, height)
    ends = [(center[0] + radius, center[1], z) for z in (0.0, height)]
    v_low, v_high = (to.vertex(p) for p in ends)
    bottom, top = to.circle(v_low, low, radius), to.circle(v_high, high, radius)
    seam = to.line((v_low, ends[0]), (v_high, ends[1]))
    bound = to.loop([(top, True), (seam, False), (bottom, False), (seam, True)], is_outer=True)
    return to.bore([bound], low, radius), top, bottom


def _box(
    to: Exchange, corners: list[tuple[float, float]], height: float, above: list[int], below: list[int]
) -> list[int]:
    """The plane faces of a prism over an anticlockwise polygon, with holes in its top and its bottom."""
    count = len(corners)
    low = [(x, y, 0.0) for x, y in corners]
    high = [(x, y, height) for x, y in corners]
    v_low, v_high = [to.vertex(p) for p in low], [to.vertex(p) for p in high]
    bottom, top, upright = [], [], []
    for k in range(count):
        after = (k + 1) % count
        bottom.append(to.line((v_low[k], low[k]), (v_low[after], low[after])))
        top.append(to.line((v_high[k], high[k]), (v_high[after], high[after])))
        upright.append(to.line((v_low[k], low[k]), (v_high[k], high[k])))
    faces = []
    for k in range(count):
        after = (k + 1) % count
        bound = to.loop(
            [(bottom[k], True), (upright[after], True), (top[k], False), (upright[k], False)], is_outer=True
        )
        along = _between(low[k], low[after])
        faces.append(to.plane([bound], low[k], (along[1], -along[0], 0.0), along))
    over = to.loop([(edge, True) for edge in top], is_outer=True)
    under = to.loop([(edge, False) for edge in reversed(bottom)], is_outer=True)
    faces.append(to.plane([over, *above], high[0], (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
    faces.append(to.plane([under, *below], low[0], (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)))
    return faces


def _height(i: int, j: int) -> float:
    """Height of a relief [mm]; rough, and deterministic."""
    return 10.0 + ((7 * i * i + 3 * j * j + 5 * i * j) % 11) / 4.0


def _between(a: Point, b: Point) -> Point:
    return (b[0] - a[0], b[1] - a[1], b[2] - a[2])


def _normal(a: Point, b: Point, c: Point) -> Point:
    (x1, y1, z1), (x2, y2, z2) = _between(a, b), _between(a, c)
    return (y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2)
