"""The parts of an assembly with their faces in the assembly's frame."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from stepbot.draft.parts.parts import least_gap
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array
from stepbot.step.assembly import Assembly, Body, Component
from stepbot.step.faces import Face, FaceKind

Indices = NDArray[np.intp]
T = TypeVar("T")


_EQUAL_POSE = 1e-9
"""Steps [1, m] of relative poses that are taken for equal."""
_PAIRS_AT_ONCE = 10_000
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


@dataclass(frozen=True, eq=False)
class _Drawn:
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


class Scene:
    """Input of the inference: parts are the indices of all components with a body, in file order."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.parts = tuple(c.index for c in assembly.components if c.body >= 0)
        self._drawn: dict[int, _Drawn] = {}
        self._known: dict[tuple[int, Callable[[Body], Any]], Any] = {}
        self._corners_of: dict[int, tuple[Array, Array]] = {}
        self._gaps: dict[bytes, float] = {}
        self._last: tuple[int, ...] = ()
        self._along: dict[bytes, Array] = {}
        self._faces: dict[FaceKind, list[PlacedFace]] = {}
        placed = [assembly.components[part] for part in self.parts]
        self._row = {part: row for row, part in enumerate(self.parts)}
        self._bodies = np.array([c.body for c in placed], dtype=np.int64)
        self._turned = np.array([c.X_WC.R for c in placed]).reshape(-1, 3, 3)
        self._moved = np.array([c.X_WC.p for c in placed]).reshape(-1, 3)

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

    def faces(self, kind: FaceKind) -> list[PlacedFace]:
        """All faces of a kind, in file order."""
        if kind not in self._faces:
            self._faces[kind] = [placed for part in self.parts for placed in self.faces_of(part, kind)]
        return self._faces[kind]

    def faces_of(self, part: int, kind: FaceKind) -> list[PlacedFace]:
        """The faces of a kind of a part."""
        return [PlacedFace(part, *row) for row in zip(*self.columns(part, kind), strict=True)]

    def columns(self, part: int, kind: FaceKind) -> Columns:
        """The faces of a kind of a part, as arrays."""
        drawn, X, faces = self._drawn_faces(part), self.component(part).X_WC, self.body(part).faces
        rows = drawn.rows.get(kind)
        if rows is None:
            nothing = np.zeros((0, 3))
            return Columns((), nothing, nothing, nothing, nothing)
        low, high = self._corners(part)
        chosen = tuple(faces[row] for row in rows.tolist())
        return Columns(chosen, X.apply(drawn.points[rows]), X.turn(drawn.directions[rows]), low[rows], high[rows])

    @cached_property
    def boxes(self) -> dict[int, Array]:
        """Bounding box (2, 3) [m] of each part in the assembly; parts without extent are left out."""
        found = {}
        for part in self.parts:
            low, high = self._corners(part)
            if len(low):
                found[part] = np.array([low.min(axis=0), high.max(axis=0)])
        return found

    def face_boxes(self, part: int) -> Array:
        """Bounding boxes (n, 2, 3) [m] of the faces of a part in the assembly."""
        return np.stack(self._corners(part), axis=1)

    def gap(self, members: Sequence[int], other: int) -> float:
        """Distance [m] of another part from some parts, at least, by boxes of their faces.

        Boxes along the axes of the assembly are wide around faces of a limb that is drawn turned, so those along the
        axes of the first and of the other part count, too. It is found once for equal parts that are placed alike.
        """
        turned = np.rint(self.component(other).X_WC.R / _EQUAL_POSE).astype(np.int64).tobytes()
        key = turned + self.arrangement(other, members)
        if key not in self._gaps:
            self._gaps[key] = self._least_gap(members, other)
        return self._gaps[key]

    def _least_gap(self, members: Sequence[int], other: int) -> float:
        turns = {R.tobytes(): R for R in (np.eye(3), *(self.component(i).X_WC.R for i in (members[0], other)))}
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
        """Boxes (n, 2, 3) [m] of the faces of a part along turned axes."""
        boxes, X = self.of_definition(part, _thin_boxes), self.component(part).X_WC
        middles, halves = X.apply(boxes.mean(axis=1)) @ R, 0.5 * np.ptp(boxes, axis=1) @ np.abs(R.T @ X.R).T
        return np.stack([middles - halves, middles + halves], axis=1)

    def span(self, part: int, direction: Array) -> tuple[float, float]:
        """Where a part begins and ends along a direction [m], by the boxes of its faces in its own frame."""
        drawn, X = self._drawn_faces(part), self.component(part).X_WC
        along = X.R.T @ direction
        middles, halves = drawn.middles @ along + float(X.p @ direction), drawn.halves @ np.abs(along)
        return float((middles - halves).min()), float((middles + halves).max())

    def extent(self, part: int) -> Array:
        """Size (3,) [m] of a part's bounding box along its own axes."""
        boxes = [face.box for face in self.body(part).faces]
        return np.asarray(np.ptp(np.array(boxes).reshape(-1, 3), axis=0)) if boxes else np.zeros(3)

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

    def arrangement(self, one: int, others: Sequence[int]) -> bytes:
        """A key that is equal for equal definitions at equal poses relative to one of them."""
        return b"".join(key for _, key in self.arranged([(one, other) for other in others]))

    def outline(self, part: int, plane: Face) -> list[Array]:
        """The outlines of a plane of a part in the assembly."""
        X = self.component(part).X_WC
        return [X.apply(ring) for ring in plane.rings]

    def _corners(self, part: int) -> tuple[Array, Array]:
        """Lowest and highest corners (n, 3) [m] of the faces of a part in the assembly."""
        if part not in self._corners_of:
            drawn, X = self._drawn_faces(part), self.component(part).X_WC
            middles, halves = X.apply(drawn.middles), drawn.halves @ np.abs(X.R).T
            self._corners_of[part] = middles - halves, middles + halves
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
            self._drawn[body] = _Drawn(by_kind, points, directions, boxes.mean(axis=1), 0.5 * np.ptp(boxes, axis=1))
        return self._drawn[body]


def _thin_boxes(body: Body) -> Array:
    """Boxes (n, 2, 3) [m] of the faces of a body; of the edges of a plane with little in its box."""
    rows = [np.zeros((0, 2, 3))]
    for face in body.faces:
        box, edges = np.array(face.box).reshape(1, 2, 3), [(ring, np.roll(ring, -1, axis=0)) for ring in face.rings]
        outer, *holes = [0.5 * np.abs(np.cross(a - a[0], b - a[0]).sum(axis=0)) for a, b in edges] or [np.zeros(3)]
        across = int(outer.argmax())
        sides = np.delete(np.ptp(box[0], axis=0), across)
        if edges and outer[across] - exact_sum(hole[across] for hole in holes) < _FILLED * sides[0] * sides[1]:
            rows += [np.stack([np.minimum(a, b), np.maximum(a, b)], axis=1) for a, b in edges]
        else:
            rows.append(box)
    return np.concatenate(rows)


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
