"""Which parts are equal: occurrences of one definition, and parts of the same shape, mirrored or not.

Many exports have each occurrence as a product of its own, drawn where it is in the assembly, or mirrored. Shapes are
the same if volumes, moments of inertia and faces are. A kind is all parts that are equal to its first one.
"""

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import islice, product

import numpy as np
from msgspec import Struct

from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import IDENTITY, Array, Pose, cross, matrix_product, perpendicular_frame, rotated, unit
from stepbot.step.assembly import Body
from stepbot.step.faces import FaceKind

_ALIKE = 1e-3
"""Relative difference of volumes and moments of inertia up to which parts are equal."""
_DISTINCT = 5e-3
"""Relative difference of moments of inertia from which principal axes are unique."""
_FACES = 2e-5
"""Distance [m] up to which faces of equal parts are at one place."""
_COMPARED, _MOST_ALIKE, _MOST = 200, 12, 100
"""Faces that are compared, faces alike to which one is carried, and products of equal volumes that are compared, at
most: more are screws or chain links.
"""
_FLIP = np.array([1.0, 1.0, -1.0])
_LABELS = {FaceKind.PLANE: 0.0, FaceKind.CYLINDER: 100.0, FaceKind.CONE: 200.0}
_OFF, _ACROSS = 0.02, 0.1
"""Distance of a face from the centroid, as a share of the farthest one's, and sine of the angle between two, from which
they show how a part is turned.
"""


class EqualParts:
    """The parts of a scene by their kinds."""

    def __init__(self, scene: Scene, cut: dict[str, None]) -> None:
        self._scene, self._assembly = scene, scene.assembly
        self._cut = cut
        self._resolved: dict[int, dict[int, tuple[int, list[Pose]]]] = {}
        self._shapes: dict[int, _Shape] = {}

    def kind(self, part: int) -> int:
        """A number that equal parts have in common."""
        return self._kind(part)[0]

    def kinds(self, parts: Iterable[int]) -> tuple[int, ...]:
        """The kinds of several parts, ascending: equal for equal groups of parts."""
        return tuple(sorted(map(self.kind, parts)))

    def turned_kind(self, part: int) -> tuple[int, bool]:
        """The same, but for mirror images: whether a part is one of the first of its kind, and is not equal to it."""
        kind, maps = self._kind(part)
        return kind, _is_reflection(maps[0].R)

    def alike(self, part: int) -> list[int]:
        """The parts that may be equal to one by volume, moments and number of faces, itself included."""
        return [i for body in self._groups[self._scene.component(part).body] for i in self._occurrences[body]]

    def axes(self, part: int, axis: Axis) -> list[Axis]:
        """An axis at a part in the frame of its kind: one for each way in which a symmetric shape fits onto it."""
        X = self._scene.component(part).X_WC.inverse()
        return [_carried(M.inverse(), _carried(X, axis)) for M in self._kind(part)[1]]

    def placed(self, part: int, axis: Axis) -> list[Axis]:
        """An axis in the frame of a part's kind, at the part: one for each way in which a symmetric shape fits."""
        X = self._scene.component(part).X_WC
        return [_carried(X, _carried(M, axis)) for M in self._kind(part)[1]]

    def carried(self, part: int, other: int, axis: Axis) -> list[Axis]:
        """The axes that are to a part as one is to an equal part: several for symmetric shapes of other definitions."""
        own = self.axes(part, axis)
        if self._scene.component(part).body == self._scene.component(other).body:
            return self.placed(other, own[0])[:1]
        placed = self.placed(other, own[0])
        return placed if len(placed) >= len(own) else [self.placed(other, one)[0] for one in own]

    def _kind(self, part: int) -> tuple[int, list[Pose]]:
        """The first body of a part's kind, and the transforms from its frame to that of the part's body."""
        body = self._scene.component(part).body
        group = self._groups[body]
        if group[0] not in self._resolved:
            self._resolved[group[0]] = self._resolve(group)
        return self._resolved[group[0]][body]

    def _resolve(self, group: Sequence[int]) -> dict[int, tuple[int, list[Pose]]]:
        kinds: dict[int, tuple[int, list[Pose]]] = {}
        first: list[int] = []
        if len(group) > _MOST:
            self._cut[f"more than {_MOST} products of one volume were not compared"] = None
            return {body: (body, [IDENTITY]) for body in group}
        for body in group:
            carried = ((one, self._between(one, body)) for one in first)
            kinds[body] = next(((one, maps) for one, maps in carried if maps), (body, [IDENTITY]))
            if kinds[body][0] == body:
                first.append(body)
        return kinds

    @cached_property
    def _occurrences(self) -> dict[int, list[int]]:
        """The parts with each body, in file order."""
        occurrences: dict[int, list[int]] = defaultdict(list)
        for part in self._scene.parts:
            occurrences[self._scene.component(part).body].append(part)
        return occurrences

    @cached_property
    def _groups(self) -> dict[int, list[int]]:
        """For each body those that may be equal to it, itself included, in file order."""
        bodies = self._assembly.bodies
        rows: dict[tuple[int, int], list[tuple[float, int, Array]]] = defaultdict(list)
        groups: dict[int, list[int]] = {}
        for number in self._occurrences:
            body, exact = bodies[number], bodies[number].exact
            if exact is None or exact.volume <= 0.0:
                groups[number] = [number]
                continue
            moments = np.linalg.eigvalsh(np.array(exact.unit_density.inertia))
            rounds = sum(face.kind == FaceKind.CYLINDER for face in body.faces)
            rows[len(body.faces), rounds].append((exact.volume, number, moments))
        for some in rows.values():
            some.sort(key=lambda row: row[:2])
            volumes = [row[0] for row in some]
            for volume, number, moments in sorted(some, key=lambda row: row[1]):
                low, high = (bisect_left(volumes, volume * factor) for factor in (1.0 - _ALIKE, 1.0 + _ALIKE))
                near = sorted((row for row in some[low:high] if row[1] in groups), key=lambda row: row[1])
                home = next((groups[of] for _, of, m in near if _are_alike(m, moments)), None)
                groups[number] = [] if home is None else home
                groups[number].append(number)
        return groups

    def _between(self, one: int, two: int) -> list[Pose]:
        """Transforms from the frame of one body to that of an equal one, reflections last."""
        mine, theirs = (self._shape(body) for body in (one, two))
        poses: list[Pose] = []
        for R in _turns(mine, theirs):
            M = Pose.of(R, theirs.com - rotated(R, mine.com))
            is_new = not any(np.abs(M.matrix - pose.matrix).max() < _FACES for pose in poses)
            if is_new and (mine.is_round or not _is_reflection(R)) and _is_at(mine, theirs, R):
                poses.append(M)
        return sorted(poses, key=lambda M: _is_reflection(M.R))

    def _shape(self, body: int) -> "_Shape":
        if body not in self._shapes:
            self._shapes[body] = _shape(self._assembly.bodies[body])
        return self._shapes[body]


class _Shape(Struct, frozen=True, eq=False, dict=True):
    """Where the faces of a body are about its centroid, whatever its frame is."""

    com: Array
    inertia: Array
    places: Array
    """Shape (n, 3) [m]: the foot of the centroid on each plane, the middle of each cylinder and cone."""
    labels: Array
    """Shape (n,) [m]: what faces at one place have in common, by kind and radius."""
    is_round: bool
    """Whether some are round: what is only flat is its own mirror image, too, but for a few shapes."""

    @cached_property
    def far(self) -> Array:
        """Distances (n,) [m] of the places from the centroid."""
        return np.asarray(np.linalg.norm(self.places, axis=1))

    @cached_property
    def anchors(self) -> list[int]:
        """The faces, two at most, that few others are like, and that show how the shape is turned."""
        far = self.far
        usable = [row for row in range(len(far)) if far[row] > _OFF * far.max()]
        order = sorted(usable, key=lambda row: (len(self.like(self, row)), -round(float(far[row]), 5), row))
        if not order:
            return []
        sines = ((row, cross(self.places[order[0]], self.places[row])) for row in order[1:])
        two = (row for row, x in sines if np.linalg.norm(x) > _ACROSS * far[order[0]] * far[row])
        return [order[0], *islice(two, 1)]

    def like(self, other: "_Shape", row: int) -> list[Array]:
        """The places of faces that are like one of another shape, as far from the centroid; each once."""
        alike = np.abs(self.far - other.far[row]) < _FACES
        alike &= np.abs(self.labels - other.labels[row]) < _FACES
        places: list[Array] = []
        for place in self.places[alike]:
            if len(places) < _MOST_ALIKE and not any(np.abs(place - known).max() < _FACES for known in places):
                places.append(place)
        return places


def _shape(body: Body) -> _Shape:
    assert body.exact is not None
    com = np.array(body.exact.unit_density.com)
    places, labels = [np.zeros((0, 3))], []
    for face in body.faces:
        if face.kind in _LABELS:
            off = np.array(face.point) - com
            d = np.array(face.direction)
            places.append(((off @ d) * d if face.kind == FaceKind.PLANE else off)[None])
            labels.append(_LABELS[face.kind] + (-1.0 if face.bore else 1.0) * face.radius)
    is_round = any(face.kind == FaceKind.CYLINDER for face in body.faces)
    return _Shape(com, np.array(body.exact.unit_density.inertia), np.concatenate(places), np.array(labels), is_round)


def _turns(mine: _Shape, theirs: _Shape) -> Iterator[Array]:
    """Rotations and reflections (3, 3) that may carry one shape to the other: those of two faces to two like them."""
    if not mine.anchors:
        yield from _principal_turns(mine, theirs)
        return
    one, *more = mine.anchors
    u = mine.places[one]
    if not more:
        across = perpendicular_frame(unit(u)).T
        yield from (matrix_product(perpendicular_frame(unit(p)), across) for p in theirs.like(mine, one))
        return
    v = mine.places[more[0]]
    seconds = theirs.like(mine, more[0])
    inverse, within = _frame(u, v).T, _FACES * float(mine.far[one] + mine.far[more[0]])
    for p, q in product(theirs.like(mine, one), seconds):
        if abs(float(p @ q - u @ v)) < within:
            F = _frame(p, q)
            yield matrix_product(F, inverse)
            yield matrix_product(F * _FLIP, inverse)


def _frame(u: Array, v: Array) -> Array:
    """Unit vectors (3, 3) along one vector, across it towards another one, and across both."""
    x, z = unit(u), unit(cross(u, v))
    return np.column_stack([x, cross(z, x), z])


def _principal_turns(mine: _Shape, theirs: _Shape) -> Iterator[Array]:
    """Rotations (3, 3) of principal axes, of shapes without faces that show how they are turned."""
    (moments, R), (_, S) = (np.linalg.eigh(shape.inertia) for shape in (mine, theirs))
    if float(np.diff(moments).min()) >= _DISTINCT * float(moments[2]):
        yield from (S @ np.diag(signs) @ R.T for signs in product((1.0, -1.0), repeat=3))


def _is_at(mine: _Shape, theirs: _Shape, R: Array) -> bool:
    """Whether faces of one shape, turned, are where faces of the other one are."""
    step = max(1, len(mine.places) // _COMPARED)
    moved, labels = mine.places[::step] @ R.T, mine.labels[::step]
    gaps = np.abs(moved[:, None] - theirs.places[None]).max(axis=2, initial=0.0)
    gaps += np.abs(labels[:, None] - theirs.labels[None])
    return not gaps.size or bool((gaps.min(axis=1) < _FACES).all())


def _are_alike(one: Array, two: Array) -> bool:
    """Whether principal moments of inertia (3,) are equal."""
    return bool(np.abs(one - two).max() < _ALIKE * two[2])


def _is_reflection(R: Array) -> bool:
    return float(cross(R[:, 0], R[:, 1]) @ R[:, 2]) < 0.0


def _carried(M: Pose, axis: Axis) -> Axis:
    return Axis(M.apply(axis.point), None if axis.direction is None else unit(M.turn(axis.direction)))
