"""Where a joint is stopped: the positions at which parts of its two links meet.

Only a face that looks along the motion can stop it. A face of revolution about the axis, or one that contains the
direction of a slide, passes along itself and stops nothing, so shafts in bores and rails in grooves do not count.
Points of the faces that lead are followed along their circle or line to the faces of the other link that they run
into, and the other way round. Parts that touch in the drawn pose are left out. What is found is a stop of the
meshes: edges that cross may meet a little earlier, and cables, other links or software may stop the joint before.
"""

from collections.abc import Sequence
from math import degrees

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.draft.draft import Draft, DraftJoint, FoundStop
from stepbot.draft.stops.sweeps import (
    TOUCHING,
    TOUCHING_ANGLE,
    Indices,
    PlacedMeshes,
    Sides,
    meeting,
    radii_and_heights,
    slide,
    touched,
    turn,
    ways_about,
    ways_along,
)
from stepbot.geometry.spatial import Array, perpendicular_frame
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly, BodyKind

_GRID = 3
"""Parts of each edge of a triangle between the points that are followed."""
_WEIGHTS = np.array([(i, k, _GRID - i - k) for i in range(_GRID + 1) for k in range(_GRID + 1 - i)]) / _GRID
_PER_TRIANGLE = len(_WEIGHTS)
_GRAZE = 1.5e-4
"""Distance [m] from its edges that a face must meet another with: twice what coarse meshes are off by."""
_SLACK_ANGLE, _SLACK = 0.05, 1e-3
"""Differences [rad] and [m] up to which a meeting at an edge is that of the face."""
_NARROW_ANGLE, _NARROW = 0.45, 2e-3
"""Ranges [rad] and [m] between stops, below which the sides of a joint may belong together."""
_DECIMALS = 9
"""Decimals [m] up to which points are compared."""
_MOST = 4_000_000
"""Points times triangles that are tried for all joints together."""


_Near = tuple[Indices, Indices]
"""Numbers of pairs of parts, ascending, and of triangles."""


class Shape(Struct, frozen=True, eq=False):
    """The mesh of a part in the assembly."""

    part: int
    vertices: Array
    """Shape (n, 3) [m]."""
    faces: NDArray[np.int32]


class Question(Struct, frozen=True, eq=False):
    """A joint whose stops are looked for."""

    slides: bool
    point: Array
    """On the axis [m]."""
    direction: Array
    still: tuple[Shape, ...]
    """Parts of the parent link."""
    moving: tuple[Shape, ...]
    """Parts of the child link."""

    @property
    def parts(self) -> list[int]:
        """Of either link."""
        return [shape.part for shape in (*self.still, *self.moving)]

    @property
    def key(self) -> bytes:
        """Equal for joints with equal parts that are placed likewise about them."""
        arrays = [np.round(shape.vertices - self.point, _DECIMALS) for shape in (*self.still, *self.moving)]
        counts = np.array([self.slides, len(self.still), *map(len, arrays)])
        faces = [shape.faces for shape in (*self.still, *self.moving)]
        return b"".join(one.tobytes() for one in (counts, np.round(self.direction, _DECIMALS), *arrays, *faces))


class Stop(Struct, frozen=True):
    """A position from the drawn one at which two parts meet."""

    position: float
    """[rad] or [m]; negative against the direction of the axis."""
    still: int
    moving: int


class Stops(Struct, frozen=True):
    """The stops of a joint by collision."""

    stops: tuple[Stop, ...]
    """The first stop in either direction, where there is one."""
    skipped: int = 0
    """Pairs of parts that were not compared, because the work is bounded; one of them may stop the joint earlier."""


def find_stops(questions: Sequence[Question]) -> tuple[Stops, ...]:
    """For each joint the first stop in either direction, where one is found.

    Joints with equal parts that are placed likewise about them are one. The work is bounded: each has its share of a
    fixed number of pairs of points and triangles.
    """
    keys = [question.key for question in questions]
    firsts = dict(reversed([*zip(keys, questions, strict=True)]))
    known = {key: _stops(first, _MOST // (2 * len(firsts))) for key, first in firsts.items()}
    answers = []
    for key, question in zip(keys, questions, strict=True):
        part = dict(zip(firsts[key].parts, question.parts, strict=True))
        stops = (Stop(stop.position, part[stop.still], part[stop.moving]) for stop in known[key].stops)
        answers.append(Stops(tuple(stops), known[key].skipped))
    return tuple(answers)


def _stops(question: Question, share: int) -> Stops:
    touching, least = (TOUCHING, _SLACK) if question.slides else (TOUCHING_ANGLE, 2.0 * _SLACK_ANGLE)
    still, moving = (_placed(question, shapes) for shapes in (question.still, question.moving))
    still, moving = still.within_reach(moving), moving.within_reach(still)
    both, skipped = {}, set[tuple[int, int]]()
    for sign in (-1.0, 1.0):
        sweep = _Sweep(still.facing(-sign), moving.facing(sign), sign, question.slides, least + 2.0 * touching)
        both[sign], left = sweep.ways(share)
        skipped |= left
    # A pair that leaves the joint no motion at all is a fit with play, and no stop.
    fits = {pair for pair, way in both[1.0].items() if way + both[-1.0].get(pair, np.inf) < least}
    stops = []
    for sign, ways in both.items():
        free = [(way, *pair) for pair, way in ways.items() if touching < way < np.inf and pair not in fits]
        if free:
            way, a, b = min(free)
            stops.append(Stop(sign * way, a, b))
    return Stops(tuple(stops), len(skipped))


def _placed(question: Question, shapes: Sequence[Shape]) -> PlacedMeshes:
    """Parts in a frame whose z axis is that of the joint."""
    frame = perpendicular_frame(question.direction)
    vertices = [(shape.vertices - question.point) @ frame for shape in shapes]
    return PlacedMeshes(
        [shape.part for shape in shapes], vertices, [shape.faces for shape in shapes], slides=question.slides
    )


class _Sweep(Struct, frozen=True, eq=False):
    """The motion of triangles in one direction."""

    still: Sides
    moving: Sides
    sign: float
    slides: bool
    least: float
    """Way beyond which a pair is no fit with play [rad] or [m]."""

    def ways(self, share: int) -> tuple[dict[tuple[int, int], float], set[tuple[int, int]]]:
        """For pairs of parts how far the moving one goes until they meet, and pairs beyond the share.

        A way is infinite if it is longer than that of a pair that can only be a stop. Cheap pairs come first.
        """
        work = self.moving.counts_near(self.still).T * self.still.counts_near(self.moving)
        m, s = np.nonzero(work)
        order = np.argsort(work[m, s], kind="stable")
        m, s = m[order], s[order]
        taken = int(np.searchsorted(np.cumsum(2 * _PER_TRIANGLE * work[m, s]), share, side="right"))
        names = [(self.still.parts[k], self.moving.parts[n]) for k, n in zip(s.tolist(), m.tolist(), strict=True)]
        still, moving = (
            self.still.near(s[:taken], self.moving, m[:taken]),
            self.moving.near(m[:taken], self.still, s[:taken]),
        )
        shortest = self._shortest_of_pairs(taken, still, moving)
        ways, most = {}, np.inf
        for pair, (name, exact) in enumerate(zip(names, shortest.tolist(), strict=False)):
            ways[name] = np.inf
            if exact < np.inf and exact <= most:
                ways[name] = self._way(exact, still[1][still[0] == pair], moving[1][moving[0] == pair], most)
            if ways[name] > self.least:
                most = min(most, ways[name])
        return ways, set(names[taken:])

    def _shortest_of_pairs(self, count: int, still: _Near, moving: _Near) -> Array:
        """Shape (count,): how far each moving part goes until triangles meet."""
        pairs, i, j = meeting(self.still, self.moving, still, moving)
        shortest = np.full(count, np.inf)
        for (sides, rows), (others, hit), sign in (
            ((self.moving, j), (self.still, i), self.sign),
            ((self.still, i), (self.moving, j), -self.sign),
        ):
            used, at = np.unique(rows, return_inverse=True)
            points = _points(sides.corners[used], 0.0)
            used, row = np.unique(hit, return_inverse=True)
            triangles = others.triangles(used)
            point = (at[:, None] * _PER_TRIANGLE + np.arange(_PER_TRIANGLE)).reshape(-1)
            row, owner = np.repeat(row, _PER_TRIANGLE), np.repeat(pairs, _PER_TRIANGLE)
            kept = touched(points[:, :2] if self.slides else radii_and_heights(points), triangles, point, row)
            follow = ways_along if self.slides else ways_about
            np.minimum.at(shortest, owner[kept], follow(points, triangles, point[kept], row[kept], sign))
        return shortest

    def _way(self, exact: float, still: Indices, moving: Indices, most: float) -> float:
        """The way of a pair of parts whose triangles meet after ``exact``; infinite beyond ``most``.

        What only grazes is none: meshes of a shaft and its bore cut into each other.
        """
        slack = _SLACK if self.slides else _SLACK_ANGLE
        follow = slide if self.slides else turn
        points, others = (
            _points(side.corners[rows], _GRAZE) for side, rows in ((self.moving, moving), (self.still, still))
        )
        inner = follow(points, self.still.triangles(still), self.sign, most + slack)
        inner = min(inner, follow(others, self.moving.triangles(moving), -self.sign, min(inner, most + slack)))
        return exact if inner - exact < slack else inner


def _points(corners: Array, inset: float) -> Array:
    """Points all over triangles (n, 3, 3), as far from their edges as ``inset`` [m], where they are that large."""
    middles = corners.mean(axis=1, keepdims=True)
    reach = np.linalg.norm(corners - middles, axis=2, keepdims=True)
    inner = corners + (middles - corners) * np.minimum(1.0, 2.0 * inset / np.maximum(reach, 1e-12))
    return np.asarray((_WEIGHTS @ inner).reshape(-1, 3))


def with_stops(draft: Draft, assembly: Assembly) -> Draft:
    """The draft with the stops of its joints that have no limits, where parts of their two links meet."""
    members = {link.name: link.components for link in draft.links}
    asked = [joint for joint in draft.joints if _is_open(joint)]
    shapes, paths = Shapes(assembly), [component.path for component in assembly.components]
    answers = find_stops([_question(joint, members[joint.parent], members[joint.child], shapes) for joint in asked])
    stopped = {
        joint.name: _stopped(replace(joint, stops=_named(stops.stops, joint, paths), stops_skipped=stops.skipped))
        for joint, stops in zip(asked, answers, strict=True)
    }
    return replace(draft, joints=tuple(stopped.get(joint.name, joint) for joint in draft.joints))


def _stopped(joint: DraftJoint) -> DraftJoint:
    """A joint with its stops, to be reviewed if they leave it a narrow range."""
    slides = joint.type is JointKind.PRISMATIC
    positions = [stop.position for stop in joint.stops]
    if len(positions) < 2 or max(positions) - min(positions) >= (_NARROW if slides else _NARROW_ANGLE):
        return joint
    low, high = (f"{1e3 * at:.3g} mm" if slides else f"{degrees(at):.3g} deg" for at in sorted(positions))
    narrow = f"its stops leave it only {low} to {high}"
    return replace(joint, review=f"{joint.review}; {narrow}" if joint.review else narrow)


def _is_open(joint: DraftJoint) -> bool:
    is_drafted = joint.confidence.is_chosen and joint.direction is not None
    return is_drafted and joint.limits is None and joint.type.bounded


def _question(joint: DraftJoint, still: Sequence[int], moving: Sequence[int], shapes: "Shapes") -> Question:
    is_slide, point, direction = joint.type is JointKind.PRISMATIC, np.array(joint.point), np.array(joint.direction)
    return Question(is_slide, point, direction, shapes.of(still), shapes.of(moving))


class Shapes:
    """Solid parts in the assembly; a link with several joints is placed once."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._known: dict[int, Shape] = {}

    def of(self, parts: Sequence[int]) -> tuple[Shape, ...]:
        """The solids among some parts."""
        return tuple(self._shape(part) for part in parts if self._is_solid(part))

    def _is_solid(self, part: int) -> bool:
        body = self._assembly.components[part].body
        if body < 0:
            return False
        return self._assembly.bodies[body].kind is BodyKind.SOLID and len(self._assembly.bodies[body].mesh.faces) > 0

    def _shape(self, part: int) -> Shape:
        if part not in self._known:
            component = self._assembly.components[part]
            mesh = self._assembly.bodies[component.body].mesh
            faces = np.asarray(mesh.faces, dtype=np.int32)
            self._known[part] = Shape(part, component.X_WC.apply(mesh.vertices), faces)
        return self._known[part]


def _named(stops: Sequence[Stop], joint: DraftJoint, paths: Sequence[str]) -> tuple[FoundStop, ...]:
    return tuple(
        FoundStop(round(joint.zero + stop.position, 4), (paths[stop.still], paths[stop.moving])) for stop in stops
    )
