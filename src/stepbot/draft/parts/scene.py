"""The parts of an assembly with their faces in the assembly's frame."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.draft.parts.parts import least_gap
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, Matrix3, cross, unit
from stepbot.step.assembly import Assembly, Body, Component
from stepbot.step.faces import Face, FaceKind

Indices = NDArray[np.intp]
T = TypeVar("T")
_ROUND = (FaceKind.CYLINDER, FaceKind.CONE)


_EQUAL_POSE = 1e-9
"""Steps [1, m] of relative poses that are taken for equal."""
_PAIRS_AT_ONCE = 10_000
_ALONG_AXIS = 1e-9
"""One less the cosine of an angle up to which a direction is along an axis."""
_DECIMALS = 9
"""Decimals [m] of where faces begin and end along turned axes: those below are rounding, and differ by processor."""
_HEAVIEST, _EVEN = 64, 1e-3
"""Faces whose directions may be those of a part's own axes, at most; sine up to which directions are equal."""
_MOST_KEPT = 5_000
"""Definitions along directions whose bounds and faces are kept: they take some memory."""
_FILLED = 0.5
"""Share of its box from which a plane fills it."""


class PlacedFace(NamedTuple):
    """A face of a component."""

    part: int
    """Index of the component."""
    face: Face
    """In the component's frame."""
    point: Array
    """Shape (3,) [m], in the assembly, as ``direction``, ``low`` and ``high``."""
    direction: Array
    low: Array
    """Lowest corner of its bounding box."""
    high: Array


class Columns(NamedTuple):
    """Faces of one kind of a part, in file order."""

    faces: tuple[Face, ...]
    """In the component's frame."""
    points: Array
    """Shape (n, 3) [m], in the assembly, as ``directions``, ``low`` and ``high``."""
    directions: Array
    low: Array
    high: Array


class _Drawn(Struct, frozen=True, eq=False):
    """The faces of a definition in its own frame."""

    rows: dict[FaceKind, Indices]
    """The numbers of the faces of each kind."""
    points: Array
    """Shape (n, 3) [m]."""
    directions: Array
    middles: Array
    """Shape (n, 3) [m]: the middle of each bounding box."""
    halves: Array
    """Shape (n, 3) [m]: half of its size."""
    round: Indices
    """The numbers of cylinders and cones."""
    reach: Array
    """Shape (n, 2) [m]: half of their length, and their radius."""
    flat: Indices
    """The numbers of planes with an outline."""
    outlines: Array
    """Shape (m, 3) [m]: the points of these, one outline after the other."""
    starts: Indices
    """Where each begins."""

    def bounds(self, D: Array) -> tuple[Array, Array]:
        """Where each face begins and ends (n, k) [m] along directions (3, k) of its own frame.

        Boxes are wider than what is in them along any but their own axes: there cylinders and outlines count, too.
        """
        middles, halves = self.middles @ D, self.halves @ np.abs(D)
        low, high = middles - halves, middles + halves
        across = np.flatnonzero(np.abs(D).max(axis=0) < 1.0 - _ALONG_AXIS)
        if len(across) and len(self.round):
            at, along = self.points[self.round] @ D[:, across], self.directions[self.round] @ D[:, across]
            out = self.reach[:, :1] * np.abs(along) + self.reach[:, 1:] * np.sqrt(np.maximum(0.0, 1.0 - along**2))
            some = np.ix_(self.round, across)
            low[some], high[some] = np.maximum(low[some], at - out), np.minimum(high[some], at + out)
        if len(across) and len(self.flat):
            at, some = self.outlines @ D[:, across], np.ix_(self.flat, across)
            low[some] = np.maximum(low[some], np.minimum.reduceat(at, self.starts))
            high[some] = np.minimum(high[some], np.maximum.reduceat(at, self.starts))
        return np.round(low, _DECIMALS), np.round(high, _DECIMALS)


class Scene:
    """Input of the inference: parts are the indices of all components with a body, in file order."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.parts = tuple(c.index for c in assembly.components if c.body >= 0)
        self._drawn: dict[int, _Drawn] = {}
        self._known: dict[tuple[int, Callable[[Body], Any]], Any] = {}
        self._whole: dict[Callable[[Scene], Any], Any] = {}
        self._corners_of: dict[int, tuple[Array, Array]] = {}
        self._bounded: dict[tuple[int, bytes], tuple[Array, Array]] = {}
        self._columns: dict[tuple[int, FaceKind, Matrix3], Columns] = {}
        self._gaps: dict[bytes, float] = {}
        self._last: tuple[int, ...] = ()
        self._along: dict[bytes, Array] = {}
        placed = [assembly.components[part] for part in self.parts]
        self._row = {part: row for row, part in enumerate(self.parts)}
        self._bodies = np.array([c.body for c in placed], dtype=np.int64)
        self._turned = np.array([c.X_WC.R for c in placed]).reshape(-1, 3, 3)
        self._moved = np.array([c.X_WC.p for c in placed]).reshape(-1, 3)
        self._turns = [turn.tobytes() for turn in np.rint(self._turned / _EQUAL_POSE).astype(np.int64)]

    def component(self, part: int) -> Component:
        """The component with an index."""
        return self.assembly.components[part]

    def body(self, part: int) -> Body:
        """The body of a part."""
        return self.assembly.bodies[self.component(part).body]

    def of_definition(self, part: int, find: Callable[[Body], T]) -> T:
        """What a function finds of a part's body in its own frame: once for all occurrences of the definition."""
        key = self.component(part).body, find
        if key not in self._known:
            self._known[key] = find(self.body(part))
        return cast(T, self._known[key])

    def of_all(self, find: Callable[["Scene"], T]) -> T:
        """What a function finds of all parts, once."""
        if find not in self._whole:
            self._whole[find] = find(self)
        return cast(T, self._whole[find])

    def faces(self, kind: FaceKind) -> list[PlacedFace]:
        """All faces of a kind, in file order."""
        return [placed for part in self.parts for placed in self.faces_of(part, kind)]

    def faces_of(self, part: int, kind: FaceKind) -> list[PlacedFace]:
        """The faces of a kind of a part."""
        return [PlacedFace(part, *row) for row in zip(*self.columns(part, kind), strict=True)]

    def count(self, part: int, kind: FaceKind) -> int:
        """The number of faces of a kind of a part."""
        return len(self._drawn_faces(part).rows.get(kind, ()))

    def columns(self, part: int, kind: FaceKind) -> Columns:
        """The faces of a kind of a part, as arrays."""
        X, drawn = self.component(part).X_WC, self._drawn_faces(part)
        key = self.component(part).body, kind, X.rotation
        if key not in self._columns:
            if len(self._columns) >= _MOST_KEPT:
                self._columns.clear()
            rows, faces = drawn.rows.get(kind, np.zeros(0, dtype=np.intp)), self.body(part).faces
            low, high = self._bounds(part, X.R.T)
            turned = X.turn(drawn.points[rows]), X.turn(drawn.directions[rows])
            self._columns[key] = Columns(tuple(faces[row] for row in rows.tolist()), *turned, low[rows], high[rows])
        one = self._columns[key]
        return Columns(one.faces, one.points + X.p, one.directions, one.low + X.p, one.high + X.p)

    @cached_property
    def boxes(self) -> dict[int, Array]:
        """Bounding box (2, 3) [m] of each part in the assembly; parts without extent are left out."""
        boxes = {}
        for part in self.parts:
            low, high = self._corners(part)
            if len(low):
                boxes[part] = np.array([low.min(axis=0), high.max(axis=0)])
        return boxes

    def face_boxes(self, part: int) -> Array:
        """Bounding boxes (n, 2, 3) [m] of the faces of a part in the assembly."""
        return np.stack(self._corners(part), axis=1)

    def gap(self, members: Sequence[int], other: int) -> float:
        """Distance [m] of another part from some parts, at least, by boxes of their faces.

        Boxes along the axes of the assembly are wide around faces of a limb that is drawn turned, so those along the
        axes of the first and of the other part count, too. It is found once for equal parts that are placed alike.
        """
        key = b"".join(key for _, key in self.shifted([(other, i) for i in members]))
        if key not in self._gaps:
            self._gaps[key] = self._least_gap(members, other)
        return self._gaps[key]

    def _least_gap(self, members: Sequence[int], other: int) -> float:
        axes = (self.component(i).X_WC.R @ self.of_definition(i, own_axes) for i in (members[0], other))
        turns = {R.tobytes(): R for R in (np.eye(3), *axes)}
        return max(least_gap(self._all_boxes_along(members, R), self._boxes_along(other, R)) for R in turns.values())

    def _all_boxes_along(self, members: Sequence[int], R: Array) -> Array:
        """Likewise of several parts; those of the last ones are kept for the next part compared with them."""
        if self._last != (some := tuple(members)):
            self._last, self._along = some, {}
        key = R.tobytes()
        if key not in self._along:
            self._along[key] = np.concatenate([self._boxes_along(i, R) for i in members])
        return self._along[key]

    def _boxes_along(self, part: int, R: Array) -> Array:
        """Boxes (n, 2, 3) [m] of the faces of a part along turned axes; of the edges of a plane with little in it."""
        X, (is_hollow, starts, ends) = self.component(part).X_WC, self.of_definition(part, _hollow_faces)
        D = X.R.T @ R
        low, high = self._bounds(part, D)
        one, two = starts @ D, ends @ D
        lows = np.concatenate([low[~is_hollow], np.minimum(one, two)])
        highs = np.concatenate([high[~is_hollow], np.maximum(one, two)])
        return np.stack([lows, highs], axis=1) + X.p @ R

    def span(self, part: int, direction: Array) -> tuple[float, float]:
        """Where a part begins and ends along a direction [m], by the boxes of its faces in its own frame."""
        (low,), (high,) = self._ends(part, direction[:, None])
        return float(low), float(high)

    def _ends(self, part: int, directions: Array) -> tuple[Array, Array]:
        """Where a part begins and ends (n,) [m] along directions (3, n)."""
        X = self.component(part).X_WC
        low, high = self._bounds(part, X.R.T @ directions)
        return low.min(axis=0) + X.p @ directions, high.max(axis=0) + X.p @ directions

    def extent(self, part: int) -> Array:
        """Size (3,) [m] of a part's bounding box along its own axes."""
        low, high = self._bounds(part, self.of_definition(part, own_axes))
        return np.asarray(high.max(axis=0) - low.min(axis=0)) if len(low) else np.zeros(3)

    def size_of(self, parts: Sequence[int], along: int) -> float:
        """Diagonal [m] of the bounding box of parts along the own axes of one of them."""
        R = self.component(along).X_WC.R @ self.of_definition(along, own_axes)
        ends = np.array([self._ends(part, R) for part in parts])
        return float(np.linalg.norm(ends[:, 1].max(axis=0) - ends[:, 0].min(axis=0)))

    def fill(self, part: int) -> float:
        """Share of its bounding box that a part fills, along its own axes."""
        exact, size = self.body(part).exact, float(np.prod(self.extent(part)))
        return exact.volume / size if exact is not None and size else 0.0

    def arranged(self, pairs: Sequence[tuple[int, int]]) -> Iterator[tuple[tuple[int, int], bytes]]:
        """Pairs of parts, each with a key that is equal for equal definitions at equal relative poses."""
        for start in range(0, len(pairs), _PAIRS_AT_ONCE):
            some = pairs[start : start + _PAIRS_AT_ONCE]
            one, two = np.array([(self._row[a], self._row[b]) for a, b in some], dtype=np.intp).T
            R, p = self._turned[one], self._moved[two] - self._moved[one]
            relative = np.concatenate([self._turned[two].swapaxes(1, 2) @ R, p[:, None] @ R], axis=1)
            steps = np.rint(relative.reshape(-1, 12) / _EQUAL_POSE).astype(np.int64)
            keys = np.column_stack([self._bodies[one], self._bodies[two], steps])
            yield from ((pair, key.tobytes()) for pair, key in zip(some, keys, strict=True))

    def shift(self, one: int, other: int) -> Array:
        """From the origin of one part to that of another (3,) [m]."""
        return np.asarray(self._moved[self._row[other]] - self._moved[self._row[one]])

    def shifted(self, pairs: Sequence[tuple[int, int]]) -> Iterator[tuple[tuple[int, int], bytes]]:
        """:meth:`arranged`, with keys that differ for pairs which are turned in the assembly."""
        for (one, other), key in self.arranged(pairs):
            yield (one, other), self._turns[self._row[one]] + key

    def arrangement(self, one: int, others: Sequence[int]) -> bytes:
        """A key that is equal for equal definitions at equal poses relative to one of them."""
        return b"".join(key for _, key in self.arranged([(one, other) for other in others]))

    def outline(self, part: int, plane: Face) -> list[Array]:
        """The outlines of a plane of a part in the assembly."""
        X = self.component(part).X_WC
        return [X.apply(ring) for ring in plane.rings]

    def _bounds(self, part: int, directions: Array) -> tuple[Array, Array]:
        """:meth:`_Drawn.bounds` of a part, once for parts that are turned alike."""
        key = self.component(part).body, directions.tobytes()
        if key not in self._bounded:
            if len(self._bounded) >= _MOST_KEPT:
                self._bounded.clear()
            self._bounded[key] = self._drawn_faces(part).bounds(directions)
        return self._bounded[key]

    def _corners(self, part: int) -> tuple[Array, Array]:
        """Lowest and highest corners (n, 3) [m] of the faces of a part in the assembly."""
        if part not in self._corners_of:
            X = self.component(part).X_WC
            low, high = self._bounds(part, X.R.T)
            self._corners_of[part] = low + X.p, high + X.p
        return self._corners_of[part]

    def _drawn_faces(self, part: int) -> _Drawn:
        """The faces of the definition of a part, which occurs more than once in most assemblies."""
        body = self.component(part).body
        if body not in self._drawn:
            faces = self.assembly.bodies[body].faces
            points = np.array([f.point for f in faces]).reshape(-1, 3)
            directions = np.array([f.direction for f in faces]).reshape(-1, 3)
            boxes = np.array([f.box for f in faces]).reshape(-1, 2, 3)
            rows: dict[FaceKind, list[int]] = defaultdict(list)
            for row, face in enumerate(faces):
                rows[face.kind].append(row)
            by_kind = {kind: np.array(of, dtype=np.intp) for kind, of in rows.items()}
            middles, halves = boxes.mean(axis=1), 0.5 * np.ptp(boxes, axis=1)
            turned = np.sort(np.concatenate([by_kind.get(kind, np.zeros(0, dtype=np.intp)) for kind in _ROUND]))
            reach = np.array([(0.5 * faces[row].length, faces[row].radius) for row in turned.tolist()]).reshape(-1, 2)
            flat = np.array([row for row, face in enumerate(faces) if face.rings], dtype=np.intp)
            rings = [faces[row].rings[0] for row in flat.tolist()]
            outlines = np.concatenate([np.zeros((0, 3)), *rings])
            self._drawn[body] = _Drawn(
                *(by_kind, points, directions, middles, halves, turned, reach),
                *(flat, outlines, starts_of([len(ring) for ring in rings])),
            )
        return self._drawn[body]


def _hollow_faces(body: Body) -> tuple[NDArray[np.bool_], Array, Array]:
    """Which faces of a body are planes with little in their box, and the ends (n, 3) [m] of the edges of these."""
    is_hollow, rings = np.zeros(len(body.faces), dtype=bool), [np.zeros((0, 3))]
    for row, face in enumerate(body.faces):
        if face.rings:
            areas = _areas(face.rings)
            across = int(areas[0].argmax())
            sides = np.delete(np.ptp(np.array(face.box), axis=0), across)
            inside = areas[0][across] - exact_sum(hole[across] for hole in areas[1:])
            is_hollow[row] = inside < _FILLED * sides[0] * sides[1]
            rings += face.rings if is_hollow[row] else ()
    return is_hollow, np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])


def _areas(rings: Sequence[Array]) -> list[Array]:
    """The areas (3,) [m^2] of outlines, across each axis."""
    return [0.5 * np.abs(cross(r - r[0], np.roll(r, -1, axis=0) - r[0]).sum(axis=0)) for r in rings]


def own_axes(body: Body) -> Array:
    """Axes (3, 3) that most of a body's faces are along, whatever its frame: its frame's, if these are along them."""
    areas = [_area(face) for face in body.faces]
    heaviest = [row for row in np.argsort(-np.round(areas, 12), kind="stable").tolist() if areas[row]][:_HEAVIEST]
    d = np.array([body.faces[row].direction for row in heaviest]).reshape(-1, 3)
    if not len(d):
        return np.eye(3)
    same = np.abs(d @ d.T) > 1.0 - 0.5 * _EVEN**2
    totals = same @ np.array([areas[row] for row in heaviest])
    z = d[int(np.argmax(np.round(totals, 9)))]
    level = np.flatnonzero(np.abs(d @ z) < _EVEN)
    if len(level):
        x = d[level[int(np.argmax(np.round(totals[level], 9)))]]
    else:
        x = np.eye(3)[int(np.abs(z).argmin())]
    x = unit(x - (x @ z) * z)
    axes = np.column_stack([x, cross(z, x), z])
    return np.eye(3) if np.abs(axes).max(axis=0).min() > 1.0 - 0.5 * _EVEN**2 else axes


def _area(face: Face) -> float:
    """About the area [m^2] of a plane, a cylinder or a cone."""
    if face.rings:
        return float(np.linalg.norm(_areas(face.rings[:1])[0]))
    return face.radius * face.length * face.span if face.kind in _ROUND else 0.0


Indices_of_runs = NDArray[np.int64]

_CHUNK = 1_000_000
"""Number of elements that are looked at at once."""


def starts_of(counts: Sequence[int] | Indices_of_runs) -> Indices_of_runs:
    """Where each of several runs begins."""
    sizes = np.asarray(counts, dtype=np.int64)
    return np.cumsum(sizes) - sizes


def expanded(counts: Indices_of_runs) -> tuple[Indices_of_runs, Indices_of_runs]:
    """For runs of some lengths, the number of the run and the place in it of each element."""
    runs = np.repeat(np.arange(len(counts)), counts)
    return runs, np.arange(len(runs)) - starts_of(counts)[runs]


def chunks(counts: Indices_of_runs) -> Iterator[Indices_of_runs]:
    """Numbers of runs of some lengths, as many at once as memory should hold."""
    yield from np.split(np.arange(len(counts)), np.flatnonzero(np.diff(np.cumsum(counts) // _CHUNK)) + 1)
