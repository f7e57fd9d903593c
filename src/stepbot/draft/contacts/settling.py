"""Moves pieces that are drawn off what they fit to where their faces meet, before anything is decided.

Round faces of two pieces that are nearly coaxial become so, and planes beside them that nearly face each other meet: a
small motion of each body, by least squares. What contradicts the rest is left as it is drawn.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.draft.contacts.contacts import Pair, Patch
from stepbot.draft.contacts.near_fits import ANGLE, OFFSET, NearFit
from stepbot.draft.contacts.planes import Planes
from stepbot.draft.contacts.relations import Relation
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Part, joint_box
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.solids.box_pairs import box_pairs
from stepbot.geometry.spatial import (
    Array,
    Pose,
    cross,
    dot,
    length,
    lengths,
    matrix_product,
    perpendicular_frame,
    rotated,
    rotation_about,
    rotation_angle,
)
from stepbot.step.features.axes import DISTANCE_TOLERANCE

_DRAWN_OFF = 1e-6
"""Angle [rad] from which lines are not drawn parallel."""
_LEVER = 0.02
"""Length [m] by which angles are compared with distances."""
_LOOSE, _HELD = 1e-4, 1.0
"""Weights of not moving a body at all, and of not moving the largest one."""
_IN_PLACE = 5e-6
"""Distance [m] up to which a moved fit is exact: half of what coaxial faces may be off."""
_GAPS, _GAP, _AREA = 2.0, 1.5e-4, 5e-6
"""Distance up to which planes nearly face each other, in medians of how far round faces are off, and without any [m];
the least area [m^2] that they share."""
_TILTED = 5e-5
"""Angle [rad] from which planes are drawn tilted: a placement is rounded to less."""
_ALIKE = 0.99
"""Cosine from which two normals are the same direction."""
_STEPS, _FURTHER, _MOST_BODIES = 4, 8, 300
"""Steps of the iteration, each of which squares what is left of the angles, and of the one that finds what contradicts
the rest; bodies up to which it is tried."""


class _Tie(Struct, frozen=True, eq=False):
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

    @staticmethod
    def of(patch: Patch, *, is_near: bool) -> "_Tie":
        """What two planes show."""
        other = patch.point + patch.gap * patch.normal
        return _Tie(patch.a, patch.b, patch.point, patch.normal, other, patch.other, is_plane=True, is_near=is_near)


def settled(
    scene: Scene,
    parts: Mapping[int, Part],
    small: set[int],
    relations: Mapping[Pair, Relation],
    near: Mapping[Pair, Sequence[NearFit]],
    one_part: Iterable[Sequence[int]],
    cut: dict[str, None],
) -> dict[int, Pose]:
    """How parts move, in the assembly, until faces that are nearly coaxial are so, by their indices.

    Only pieces that nothing else connects move, as little as possible: the contacts within a piece stay, but for planes
    that are not drawn parallel, which only happen to touch. Where round faces or tilted planes show that a pair is
    drawn off, its other planes meet as well. Faces that contradict each other, or a contact, are left as they are,
    planes first, and so are those of two pieces of motors.

    Args:
        small: Those that move with their hosts, such as screws.
        near: Nearly coaxial faces of larger parts.
        one_part: Bodies that stay in place in each other.
        cut: Gets the bound that ended the search, in words, if one did.
    """
    firm = {pair: relation for pair, relation in relations.items() if not any(map(is_tilted, relation.patches))}
    pieces, bodies = Clusters(parts), _bodies(parts, small, firm)
    for pair in firm:
        pieces.join(*pair)
    for pair in (pair for group in one_part for pair in pairwise(group)):
        pieces.join(*pair)
        bodies.join(*pair)
    off = [
        fit
        for (a, b), fits in near.items()
        for fit in fits
        if pieces.find(a) != pieces.find(b)
        and not (Role.MOTOR in parts[a].roles and Role.MOTOR in parts[b].roles)
        and (fit.offset > DISTANCE_TOLERANCE or fit.angle > _DRAWN_OFF)
    ]
    ties = [_Tie(f.a, f.b, f.axis.point, f.axis.d, f.other_axis.point, f.other_axis.d, is_near=True) for f in off]
    if off or len(firm) < len(relations):
        ties += _planes(scene, parts, small, pieces, off)
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
        ties = [tie for tie in ties if tie not in contradictory]
        # Round faces that contradict others show nothing, nor do the planes beside them.
        wrong = {(f.a, f.b) for f in off}.difference((tie.a, tie.b) for tie in ties if not tie.is_plane)
        ties = [tie for tie in ties if (tie.a, tie.b) not in wrong]
    return {}


def is_tilted(patch: Patch) -> bool:
    """Whether two planes are not drawn parallel."""
    return length(cross(patch.normal, patch.other)) > _TILTED


def _planes(
    scene: Scene, parts: Mapping[int, Part], small: set[int], pieces: Clusters, off: Sequence[NearFit]
) -> Iterator[_Tie]:
    """The planes of pieces that nearly face each other, the largest for each direction and pair, if one is drawn off.

    They are no farther apart than round faces are off each other: wider gaps are drawn.

    Args:
        off: The round faces of pieces that are drawn off each other.
    """
    planes, shown = scene.of_all(Planes), {(fit.a, fit.b) for fit in off}
    reach = min(OFFSET, _GAPS * float(np.median([fit.offset for fit in off]))) if off else _GAP
    ids = [i for i in parts if parts[i].size and i not in small]
    boxes = np.array([parts[i].box for i in ids]).reshape(-1, 2, 3)
    rows = box_pairs(boxes[:, 0], boxes[:, 1], -reach)
    for a, b in sorted((min(ids[k], ids[m]), max(ids[k], ids[m])) for k, m in zip(*rows, strict=True)):
        if pieces.find(a) == pieces.find(b):
            continue
        # A tilted plane may be farther from another one at its own point than where both face each other.
        patches = [one.patch for one in planes.facing(a, b, OFFSET, OFFSET, 1.0 - 0.5 * ANGLE**2)]
        chosen: list[Patch] = []
        for patch in sorted(patches, key=lambda one: (-round(one.area, 9), tuple(one.normal))):
            is_off = abs(patch.gap) < reach and patch.area > _AREA and ((a, b) in shown or is_tilted(patch))
            if is_off and all(patch.normal @ one.normal < _ALIKE for one in chosen):
                chosen.append(patch)
        yield from (_Tie.of(patch, is_near=True) for patch in chosen)


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
    for fit in relation.fits:
        yield _Tie(relation.a, relation.b, fit.axis.point, fit.axis.d, fit.axis.point, fit.axis.d)
    for patch in relation.patches:
        if not is_tilted(patch):
            yield _Tie.of(replace(patch, gap=0.0, other=-patch.normal), is_near=False)


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
            systems.join(*self._rows(tie))
        for some in systems.groups().values():
            weights[max(some, key=lambda n: (volumes[n], -n))] = _HELD
        self._stiffness = np.repeat(weights**2, 6) * np.tile([_LEVER**2] * 3 + [1.0] * 3, self.size)
        self._near = np.array([tie.is_near for tie in ties])
        self._planes = np.array([tie.is_plane for tie in ties])
        self._ends = np.array([self._rows(tie) for tie in ties]).T
        self._points = np.array([[tie.point_a for tie in ties], [tie.point_b for tie in ties]])
        self._directions = np.array([[tie.direction_a for tie in ties], [tie.direction_b for tie in ties]])

    @property
    def size(self) -> int:
        """Number of bodies."""
        return len(self._row)

    def _rows(self, tie: _Tie) -> tuple[int, int]:
        return self._row[self._bodies.find(tie.a)], self._row[self._bodies.find(tie.b)]

    def _placed(self) -> tuple[Array, Array]:
        """Points and directions (2, n, 3) of both sides of all ties as moved so far, both directions the same way."""
        R, centres = self._R[self._ends], self._centres[self._ends]
        points = rotated(R, self._points - centres) + centres + self._p[self._ends]
        directions = rotated(R, self._directions)
        directions[1] *= np.where(dot(*directions) > 0.0, 1.0, -1.0)[:, None]
        return points, directions

    def solve(self) -> None:
        """Move the bodies."""
        columns, trust = 6 * self._ends[:, :, None] + np.arange(6), np.ones(len(self._ties))
        for step_number in range(_STEPS + _FURTHER):
            points, directions = self._placed()
            if step_number >= _STEPS:
                # The sum of what is left, not of its squares: the many outvote the few.
                left = self._left()
                if float(left.max()) <= _IN_PLACE:
                    break
                trust = np.where(self._near, np.sqrt(_IN_PLACE / (_IN_PLACE + left)), 1.0)
            arms = points[1] - self._centres[self._ends] - self._p[self._ends]
            frames = np.array([perpendicular_frame(d) for d in directions[0]])
            N, rhs = np.diag(self._stiffness), np.zeros(6 * self.size)
            for k, is_tied in enumerate((~self._planes, ~self._planes, self._planes)):
                u = frames[is_tied, :, k]
                shifts = [np.concatenate([cross(arms[end, is_tied], u), u], axis=1) for end in (0, 1)]
                wanted = dot(u, points[0, is_tied] - points[1, is_tied])
                _add(N, rhs, columns[:, is_tied], shifts, wanted, trust[is_tied])
            for k in (0, 1):
                u = frames[:, :, k]
                turn = np.concatenate([_LEVER * cross(directions[0], u), np.zeros_like(u)], axis=1)
                _add(N, rhs, columns, [turn, turn], _LEVER * dot(u, directions[0] - directions[1]), trust)
            step = np.linalg.solve(N, rhs).reshape(-1, 2, 3)
            for n, (turn, shift) in enumerate(step):
                angle = float(np.linalg.norm(turn))
                if angle > 0.0:
                    self._R[n] = matrix_product(rotation_about(turn / angle, angle), self._R[n])
                self._p[n] += shift

    def contradictory(self) -> set[_Tie]:
        """The near ties that contradict others or contacts most, planes before lines; empty if none do."""
        left = self._left()
        worst = float(left[self._near].max())
        if worst > _IN_PLACE:
            off = self._near & (left > max(_IN_PLACE, 0.5 * worst))
        else:
            broken = self._ends[:, left > max(_IN_PLACE, 0.5 * float(left.max()))]
            off = self._near & np.isin(self._ends, broken).any(axis=0)
            off = self._near if broken.size and not off.any() else off
        off = off & self._planes if (off & self._planes).any() else off
        return {self._ties[k] for k in np.flatnonzero(off).tolist()}

    def _left(self) -> Array:
        """How far each tie is from being satisfied (n,) [m]."""
        points, directions = self._placed()
        apart, tilt = points[1] - points[0], cross(*directions)
        along = dot(apart, directions[0])
        off = np.where(self._planes, np.abs(along), lengths(apart - along[:, None] * directions[0]))
        return np.maximum(off, _LEVER * lengths(tilt))

    def motions(self) -> dict[int, Pose]:
        """The motion of each part of a body that moves."""
        poses: dict[int, Pose] = {}
        for root, n in self._row.items():
            X = Pose.of(self._R[n], self._centres[n] + self._p[n] - rotated(self._R[n], self._centres[n]))
            if max(length(self._p[n]), _LEVER * rotation_angle(self._R[n])) > _IN_PLACE:
                poses |= dict.fromkeys(self._bodies.members(root), X)
        return poses


def _add(N: Array, rhs: Array, columns: NDArray[np.intp], rows: Sequence[Array], wanted: Array, trust: Array) -> None:
    """Add weighted equations, the rows (m, 6) of the second ends less those of the first, to the normal equations."""
    at, row = np.concatenate(columns, axis=1), np.concatenate([-rows[0], rows[1]], axis=1) * trust[:, None]
    np.add.at(rhs, at, (wanted * trust)[:, None] * row)
    np.add.at(N, (at[:, :, None], at[:, None]), row[:, :, None] * row[:, None])
