"""Round faces of two parts that are nearly coaxial: parts that were placed by hand, or whose holes do not agree.

Such faces are no contacts: the freedom that they leave cannot be computed. Where nothing else connects two pieces,
these are moved until the faces are coaxial; elsewhere nearly coaxial faces are evidence of last resort. What they show
is to be reviewed.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepbot.draft.contacts.contacts import Contacts, FitKind, Pair
from stepbot.draft.contacts.relations import Relation
from stepbot.draft.contacts.shafts import HALF_ROUND, HOLE_RATIO, LINE_DISTANCE
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Part, box_gap, joint_box
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.solids.box_pairs import box_pairs
from stepbot.geometry.spatial import (
    Array,
    Pose,
    cross,
    length,
    matrix_product,
    perpendicular_frame,
    rotated,
    rotation_about,
    rotation_angle,
)
from stepbot.step.features.axis_contacts import LOOSEST, SLACK_SHARE

OFFSET, ANGLE = 6e-4, 0.021
"""Distance [m] and angle [rad], 1.2 degrees, up to which lines are nearly the same."""
_BESIDE = 1e-3
"""Gap [m] between two parts, and between two holes along their axis, up to which they are compared."""
_OTHER_LINE = 1e-3
"""Distance [m] from which fits of two parts are on two lines."""
_DRAWN_OFF = 1e-6
"""Angle [rad] from which lines are not drawn parallel."""
_LEVER = 0.02
"""Length [m] by which angles are compared with distances."""
_LOOSE, _HELD = 1e-4, 1.0
"""Weights of not moving a body at all, and of not moving the largest one."""
_IN_PLACE = 5e-6
"""Distance [m] up to which a moved fit is exact: half of what coaxial faces may be off."""
_STEPS, _MOST_BODIES = 4, 300
"""Steps of the iteration, each of which squares what is left of the angles; bodies up to which it is tried."""


@dataclass(frozen=True, eq=False)
class NearFit:
    """Nearly coaxial cylinders of two parts."""

    a: int
    b: int
    kind: FitKind
    axis: Axis
    """That of the face of ``a``, as ``other_axis`` of ``b``."""
    other_axis: Axis
    offset: float
    """[m]."""
    angle: float
    """[rad]."""
    radius: float
    """Of the narrower face [m]."""
    shaft: int
    """The inner part; -1 for two holes."""

    def of(self, part: int) -> Axis:
        """The axis of the face of a part."""
        return self.axis if part == self.a else self.other_axis


@dataclass(frozen=True, eq=False)
class _Round:
    """The cylinders of a part, as arrays."""

    points: Array
    """Shape (n, 3) [m]: their middles."""
    directions: Array
    radii: Array
    halves: Array
    """Shape (n,) [m]: half of their lengths."""
    bores: NDArray[np.bool_]

    def beside(self, box: Array) -> "_Round":
        """Those that may reach a box (2, 3) [m]."""
        reach = (self.halves + _BESIDE + OFFSET)[:, None]
        rows = ((self.points > box[0] - reach) & (self.points < box[1] + reach)).all(axis=1)
        return _Round(*(column[rows] for column in vars(self).values()))


def find_near_fits(
    scene: Scene, parts: Mapping[int, Part], small: set[int], found: Contacts
) -> dict[Pair, list[NearFit]]:
    """The nearly coaxial faces of larger parts beside each other, one for each line and pair, the closest.

    Args:
        small: Those that move with their hosts, such as screws.
        found: Lines with exactly coaxial faces; what has a fit on one is left out.
    """
    rounds = _rounds(small, found)
    ids = [i for i in rounds if parts[i].size]
    boxes = np.array([parts[i].box for i in ids]).reshape(-1, 2, 3)
    near: dict[Pair, list[NearFit]] = {}
    apart: set[bytes] = set()  # what equal parts elsewhere have shown
    rows = box_pairs(boxes[:, 0], boxes[:, 1], -_BESIDE)
    for pair, arrangement in scene.arranged([(ids[k], ids[m]) for k, m in zip(*rows, strict=True)]):
        if arrangement in apart:
            continue
        one, two = (rounds[i].beside(parts[j].box) for i, j in (pair, pair[::-1]))
        fits = _between(pair, one, two) if box_gap(parts[pair[0]].box, parts[pair[1]].box) < _BESIDE else []
        exact = found.fits.get(pair, ())
        fits = [fit for fit in fits if not any(fit.axis.same(one.axis, OFFSET) for one in exact)]
        if fits:
            near[pair] = fits
        else:
            apart.add(arrangement)
    return near


def _rounds(small: set[int], found: Contacts) -> dict[int, _Round]:
    rows: dict[int, list[tuple[Array, Array, float, float, bool]]] = defaultdict(list)
    for line in found.lines:
        for part, faces in line.faces.items():
            for f in faces if part not in small else ():
                if not f.cone and f.span > HALF_ROUND:
                    middle = line.axis.point + line.axis.d * (0.5 * (f.low + f.high))
                    rows[part].append((middle, line.axis.d, f.radius, 0.5 * (f.high - f.low), f.bore))
    return {i: _Round(*(np.array(column) for column in zip(*of, strict=True))) for i, of in sorted(rows.items())}


def _between(pair: Pair, one: _Round, two: _Round) -> list[NearFit]:
    sines = np.linalg.norm(cross(one.directions[:, None], two.directions[None]), axis=2)
    offsets = two.points[None] - one.points[:, None]
    along = (offsets * one.directions[:, None]).sum(axis=2)
    apart = np.linalg.norm(offsets - along[..., None] * one.directions[:, None], axis=2)
    gaps = np.abs(along) - one.halves[:, None] - two.halves[None]
    radii = np.stack(np.broadcast_arrays(one.radii[:, None], two.radii[None]))
    wide, thin = radii.max(axis=0), radii.min(axis=0)
    bores = one.bores[:, None] & two.bores[None]
    slack = np.maximum(LOOSEST, SLACK_SHARE * wide)
    shafts = (one.bores[:, None] ^ two.bores[None]) & (gaps < 0.0) & (wide - thin < slack)
    holes = bores & (gaps < _BESIDE) & (wide < HOLE_RATIO * thin)
    close = (sines < ANGLE) & (apart < OFFSET) & (shafts | holes)
    best: list[NearFit] = []
    for n, m in sorted(np.argwhere(close).tolist(), key=lambda k: (round(float(apart[k[0], k[1]]), 9), k)):
        axis = Axis(one.points[n], one.directions[n])
        if all(
            axis.distance(known.axis.point) > _OTHER_LINE or not axis.is_along(known.axis.d, ANGLE) for known in best
        ):
            kind = FitKind.SHAFT if shafts[n, m] else FitKind.HOLES
            other = Axis(two.points[m], two.directions[m])
            inner = pair[int(one.bores[n])] if kind == FitKind.SHAFT else -1
            off = float(apart[n, m]), float(sines[n, m]), float(thin[n, m])
            best.append(NearFit(*pair, kind, axis, other, *off, inner))
    return best


@dataclass(frozen=True, eq=False)
class _Tie:
    """Two lines that are to coincide, or two planes that are to face each other."""

    a: int
    b: int
    point_a: Array
    direction_a: Array
    """Of the line, or the outward normal of the plane."""
    point_b: Array
    direction_b: Array
    is_plane: bool = False
    is_near: bool = False
    """Whether they do not coincide as drawn."""


def settled(
    parts: Mapping[int, Part],
    small: set[int],
    relations: Mapping[Pair, Relation],
    near: Mapping[Pair, Sequence[NearFit]],
    cut: dict[str, None],
) -> dict[int, Pose]:
    """How parts move, in the assembly, until faces that are nearly coaxial are so, by their indices.

    Only pieces that nothing else connects move, as little as possible: the contacts within a piece stay. Nearly coaxial
    faces that contradict each other, or a contact, are left as they are, and so are those of two pieces of motors.

    Args:
        small: Those that move with their hosts, such as screws.
        near: Nearly coaxial faces of larger parts.
        cut: Gets the bound that ended the search, in words, if one did.
    """
    pieces, bodies = Clusters(parts), _bodies(parts, small, relations)
    for pair in relations:
        pieces.join(*pair)
    ties = [
        _Tie(fit.a, fit.b, fit.axis.point, fit.axis.d, fit.other_axis.point, fit.other_axis.d, is_near=True)
        for (a, b), fits in near.items()
        for fit in fits
        if pieces.find(a) != pieces.find(b)
        and not (Role.MOTOR in parts[a].roles and Role.MOTOR in parts[b].roles)
        and (fit.offset > LINE_DISTANCE or fit.angle > _DRAWN_OFF)
    ]
    contacts = [
        tie
        for pair, relation in relations.items()
        if not small.intersection(pair) and bodies.find(pair[0]) != bodies.find(pair[1])
        for tie in _contacts(relation)
    ]
    while ties:
        system = _System(parts, bodies, [*ties, *_reached(bodies, ties, contacts)])
        if system.size > _MOST_BODIES:
            cut[f"more than {_MOST_BODIES} bodies were compared as drawn, though some are off what they fit"] = None
            break
        system.solve()
        contradictory = system.contradictory()
        if not contradictory:
            return system.motions()
        ties = [tie for tie in ties if (tie.a, tie.b) not in contradictory]
    return {}


def _bodies(parts: Mapping[int, Part], small: set[int], relations: Mapping[Pair, Relation]) -> Clusters:
    """Parts that contacts hold rigidly to each other, and small ones with the largest part that they touch."""
    bodies = Clusters(parts)
    hosts: dict[int, list[tuple[float, int]]] = defaultdict(list)
    for (a, b), relation in relations.items():
        if not small.intersection((a, b)):
            if relation.is_rigid:
                bodies.join(a, b)
        elif not small.issuperset((a, b)):
            trifle, host = (a, b) if a in small else (b, a)
            hosts[trifle].append((parts[host].volume, -host))
    for trifle, of in sorted(hosts.items()):
        bodies.join(-max(of)[1], trifle)
    return bodies


def _contacts(relation: Relation) -> Iterator[_Tie]:
    """What the contacts of two parts keep in place."""
    a, b = relation.a, relation.b
    for fit in relation.fits:
        yield _Tie(a, b, fit.axis.point, fit.axis.d, fit.axis.point, fit.axis.d)
    for patch in relation.patches:
        yield _Tie(a, b, patch.point, patch.normal, patch.point, -patch.normal, is_plane=True)


def _reached(bodies: Clusters, ties: Sequence[_Tie], contacts: Sequence[_Tie]) -> list[_Tie]:
    """The contacts of bodies that ties move, and of those that these touch."""
    systems = Clusters({bodies.find(i) for tie in (*ties, *contacts) for i in (tie.a, tie.b)})
    for tie in (*ties, *contacts):
        systems.join(bodies.find(tie.a), bodies.find(tie.b))
    moved = {systems.find(bodies.find(tie.a)) for tie in ties}
    return [tie for tie in contacts if systems.find(bodies.find(tie.a)) in moved]


class _System:
    """Small motions of bodies that satisfy ties: least squares of what is left, and of the motions, by Gauss-Newton."""

    def __init__(self, parts: Mapping[int, Part], bodies: Clusters, ties: Sequence[_Tie]) -> None:
        self._bodies, self._ties = bodies, ties
        roots = sorted({bodies.find(i) for tie in ties for i in (tie.a, tie.b)})
        self._row = {root: n for n, root in enumerate(roots)}
        members = [bodies.members(root) for root in roots]
        self._centres = np.array([joint_box(parts[i] for i in some).mean(axis=0) for some in members])
        self._R, self._p = np.tile(np.eye(3), (self.size, 1, 1)), np.zeros((self.size, 3))
        volumes = [exact_sum(parts[i].volume for i in some) for some in members]
        weights = np.full(self.size, _LOOSE)
        systems = Clusters(range(self.size))
        for tie in ties:
            systems.join(*self._ends(tie))
        for some in systems.groups().values():
            weights[max(some, key=lambda n: (volumes[n], -n))] = _HELD
        self._stiffness = np.repeat(weights**2, 6) * np.tile([_LEVER**2] * 3 + [1.0] * 3, self.size)

    @property
    def size(self) -> int:
        """Number of bodies."""
        return len(self._row)

    def _ends(self, tie: _Tie) -> tuple[int, int]:
        return self._row[self._bodies.find(tie.a)], self._row[self._bodies.find(tie.b)]

    def _placed(self, tie: _Tie) -> tuple[Array, Array, Array, Array]:
        """Points and directions of both sides as moved so far, both directions the same way."""
        placed = []
        for n, point, d in zip(
            self._ends(tie), (tie.point_a, tie.point_b), (tie.direction_a, tie.direction_b), strict=True
        ):
            placed += [rotated(self._R[n], point - self._centres[n]) + self._centres[n] + self._p[n]]
            placed += [rotated(self._R[n], d)]
        p, d, q, e = placed
        return p, d, q, e if d @ e > 0.0 else -e

    def solve(self) -> None:
        """Move the bodies."""
        for _ in range(_STEPS):
            N, rhs = np.diag(self._stiffness), np.zeros(6 * self.size)
            for tie in self._ties:
                p, d, q, e = self._placed(tie)
                (x, y, _), ends = perpendicular_frame(d).T, self._ends(tie)
                for u in (d,) if tie.is_plane else (x, y):
                    arms = [cross(q - self._centres[n] - self._p[n], u) for n in ends]
                    _add(N, rhs, ends, [np.concatenate([arm, u]) for arm in arms], float(u @ (p - q)))
                for u in (x, y):
                    turn = np.concatenate([_LEVER * cross(d, u), np.zeros(3)])
                    _add(N, rhs, ends, [turn, turn], _LEVER * float(u @ (d - e)))
            step = np.linalg.solve(N, rhs).reshape(-1, 2, 3)
            for n, (turn, shift) in enumerate(step):
                angle = float(np.linalg.norm(turn))
                if angle > 0.0:
                    self._R[n] = matrix_product(rotation_about(turn / angle, angle), self._R[n])
                self._p[n] += shift

    def contradictory(self) -> set[Pair]:
        """The parts of the nearly coaxial faces that contradict others or contacts most; empty if none do."""
        left = [self._left(tie) for tie in self._ties]
        near = [(off, tie) for off, tie in zip(left, self._ties, strict=True) if tie.is_near]
        worst = max(off for off, _ in near)
        if worst > _IN_PLACE:
            return {(tie.a, tie.b) for off, tie in near if off > max(_IN_PLACE, 0.5 * worst)}
        worst = max(left)
        if worst <= _IN_PLACE:
            return set()
        broken = {n for off, tie in zip(left, self._ties, strict=True) if off > 0.5 * worst for n in self._ends(tie)}
        return {(tie.a, tie.b) for _, tie in near if broken.intersection(self._ends(tie))} or {
            (tie.a, tie.b) for _, tie in near
        }

    def _left(self, tie: _Tie) -> float:
        """How far a tie is from being satisfied [m]."""
        p, d, q, e = self._placed(tie)
        along = float((q - p) @ d)
        off = abs(along) if tie.is_plane else float(np.linalg.norm(q - p - along * d))
        return max(off, _LEVER * float(np.linalg.norm(cross(d, e))))

    def motions(self) -> dict[int, Pose]:
        """The motion of each part of a body that moves."""
        found: dict[int, Pose] = {}
        for root, n in self._row.items():
            X = Pose.of(self._R[n], self._centres[n] + self._p[n] - rotated(self._R[n], self._centres[n]))
            if max(length(self._p[n]), _LEVER * rotation_angle(self._R[n])) > _IN_PLACE:
                found |= dict.fromkeys(self._bodies.members(root), X)
        return found


def _add(N: Array, rhs: Array, ends: tuple[int, int], rows: Sequence[Array], wanted: float) -> None:
    """Add an equation, the row of the second end less that of the first, to the normal equations."""
    (a, b), (one, two) = (slice(6 * n, 6 * n + 6) for n in ends), (-rows[0], rows[1])
    for here, row in ((a, one), (b, two)):
        rhs[here] += wanted * row
        for there, other in ((a, one), (b, two)):
            N[here, there] += np.outer(row, other)
