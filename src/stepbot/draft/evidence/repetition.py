"""Repetition and mirror images: what is a joint in one leg or finger is one in the others, built of equal parts.

Two parts are equal if they are of one definition, or if their masses, faces and round faces are the same, mirrored or
not. A joint is expected between two other parts if they are equal to those of a found one, and its axis, carried over
by both of them, is one line again; or by one of them, if the other is the body that all of them are on.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from stepbot.draft.contacts.near_fits import ANGLE, OFFSET
from stepbot.draft.contacts.relations import Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import BY_NAME, BY_SHAPE, ONLY_CONNECTION, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.geometry.spatial import Array
from stepbot.robot.model import JointKind
from stepbot.step.faces import FaceKind

REVIEW = "as between equal parts elsewhere; here the faces alone do not show it"
"""What to review of each such joint."""
_TYPES = (JointKind.REVOLUTE, JointKind.PRISMATIC)
_SCORE = 0.79
"""Highest score of a joint by repetition."""
_ALIKE = 1e-3
"""Relative difference of volumes and moments of inertia up to which parts are equal."""
_DISTINCT = 5e-3
"""Relative difference of moments of inertia from which principal axes are unique."""
_FACES = 2e-5
"""Distance [m] up to which round faces of equal parts are at one place."""
_MOST = 60
"""Number of equal parts up to which joints are carried over; more are screws or chain links."""
_ALONG = 2e-3
"""Distance [m] along the axis up to which equal parts are at equal places of it."""


def repeated_joints(
    survey: Survey, joints: Sequence[JointEvidence], links: Sequence[Sequence[int]]
) -> list[JointEvidence]:
    """Joints like those that were found, between parts that are still in one link or not joined."""
    link_of = {i: n for n, members in enumerate(links) for i in members}
    joined = {frozenset((link_of[h.a], link_of[h.b])) for h in joints}
    equal = _Equal(survey)
    found: list[JointEvidence] = []
    for h in joints:
        if h.type not in _TYPES or h.axis.direction is None or _is_guess(h):
            continue
        for a, b, axis in _elsewhere(survey, equal, h):
            sides = frozenset((link_of[a], link_of[b]))
            known = any((one.a, one.b) == (a, b) and one.axis.same(axis, OFFSET) for one in found)
            if known or (len(sides) == 2 and sides in joined):
                continue
            why = f"as between '{survey.parts[h.a].path}' and '{survey.parts[h.b].path}'"
            relation = survey.relation(a, b)
            found.append(JointEvidence(min(_SCORE, h.score), a, b, h.type, axis, why, relation, review=REVIEW))
    return found


def _is_guess(h: JointEvidence) -> bool:
    """Whether a joint is too weak to be carried over."""
    is_seam = h.relation is not None and h.relation.via == Via.SEAM
    return h.of_roller or is_seam or h.review in (BY_SHAPE, BY_NAME, ONLY_CONNECTION)


def _elsewhere(survey: Survey, equal: "_Equal", h: JointEvidence) -> Iterator[tuple[int, int, Axis]]:
    """The places where the same joint is expected: both parts, the smaller index first, and the axis."""
    others = [list(equal.axes(i, h.axis)) for i in (h.a, h.b)]
    smaller = min((survey.parts[i] for i in (h.a, h.b)), key=lambda part: (part.volume, part.index))
    along = float((smaller.com - h.axis.point) @ h.axis.d)
    for (a, of_a), (b, of_b) in product(*others):
        if a != b and {a, b} != {h.a, h.b} and _agree(of_a, of_b, along):
            yield (a, b, of_a) if a < b else (b, a, of_a)
    for own, host in ((0, h.b), (1, h.a)):
        for part, axis in others[own]:
            if part not in (h.a, h.b) and _supports(survey, host, part, axis):
                yield min(part, host), max(part, host), axis


def _agree(one: Axis, two: Axis, along: float) -> bool:
    """Whether two axes are one, and the places at a distance [m] along each, beside the joint, too."""
    close = one.distance(two.point) < OFFSET and one.is_along(two.d, ANGLE)
    return close and abs(float((two.point + along * two.d - one.point - along * one.d) @ one.d)) < _ALONG


def _supports(survey: Survey, host: int, part: int, axis: Axis) -> bool:
    """Whether a body touches or nearly fits another one about a line, and not elsewhere."""
    pair = min(host, part), max(host, part)
    near = survey.near_fits.get(pair, ())
    if any(fit.axis.distance(axis.point) < OFFSET and fit.axis.is_along(axis.d, ANGLE) for fit in near):
        return True
    relation = survey.relations.get(pair)
    return relation is not None and relation.turns is not None and relation.turns.same(axis, OFFSET)


class _Equal:
    """Parts in classes of equal ones."""

    def __init__(self, survey: Survey) -> None:
        self._survey = survey
        self._class_of: dict[int, int] = {}
        self._members: dict[int, list[int]] = defaultdict(list)
        self._maps: dict[tuple[int, int], list[Array]] = {}
        keys: list[tuple[int, float, Array]] = []
        bodies: dict[int, int] = {}
        for i, part in survey.parts.items():
            if i in survey.small or part.volume <= 0.0:
                continue
            body = survey.assembly.components[i].body
            if body not in bodies:
                moments = np.asarray(np.linalg.eigvalsh(part.inertia), dtype=np.float64)
                key = len(survey.scene.body(i).faces), part.volume, moments
                alike = (n for n, other in enumerate(keys) if _same(key, other))
                bodies[body] = next(alike, len(keys))
                keys.append(key)
            self._class_of[i] = bodies[body]
            self._members[bodies[body]].append(i)

    def axes(self, part: int, axis: Axis) -> Iterator[tuple[int, Axis]]:
        """The parts equal to one, itself first, each with the axis that is to it as the given one is to the first."""
        if part not in self._class_of:
            return
        yield part, axis
        members = self._members[self._class_of[part]]
        if len(members) > _MOST:
            self._survey.cut[f"joints were not carried over between more than {_MOST} equal parts"] = None
            return
        components = self._survey.assembly.components
        for other in members:
            if other != part:
                for X in self._carried(components[part].body, components[other].body, part, other):
                    turned = X[:3, :3] @ axis.d
                    yield other, Axis(X[:3, :3] @ axis.point + X[:3, 3], turned / np.linalg.norm(turned))

    def _carried(self, body: int, other_body: int, part: int, other: int) -> list[Array]:
        """Transforms (4, 4) in the assembly that carry a part onto an equal one, mirrored ones included."""
        X, Y = (self._survey.assembly.components[i].X_WC for i in (part, other))
        if body == other_body:
            return [Y.matrix @ X.inverse().matrix]
        if (body, other_body) not in self._maps:
            self._maps[body, other_body] = self._between(part, other)
        return [Y.matrix @ M @ X.inverse().matrix for M in self._maps[body, other_body]]

    def _between(self, part: int, other: int) -> list[Array]:
        """Transforms (4, 4) from the frame of one part's component to that of an equal one, proper or mirrored."""
        frames = [self._principal(i) for i in (part, other)]
        if frames[0] is None or frames[1] is None:
            return []
        (p, R), (q, S) = frames[0], frames[1]
        found = []
        for signs in product((1.0, -1.0), repeat=3):
            M = np.eye(4)
            M[:3, :3] = S @ np.diag(signs) @ R.T
            M[:3, 3] = q - M[:3, :3] @ p
            if self._is_equal(part, other, M):
                found.append(M)
        return found

    def _principal(self, i: int) -> tuple[Array, Array] | None:
        """Centroid (3,) and principal axes (3, 3) of a part in its component's frame; None if these are not unique."""
        part, X = self._survey.parts[i], self._survey.assembly.components[i].X_WC.inverse()
        moments, axes = np.linalg.eigh(X.R @ part.inertia @ X.R.T)
        if float(np.diff(moments).min()) < _DISTINCT * float(moments[2]):
            return None
        return X.apply(part.com), axes

    def _is_equal(self, part: int, other: int, M: Array) -> bool:
        """Whether all round faces of a part are carried to round faces of another one."""
        mine, theirs = (self._rounds(i) for i in (part, other))
        if len(mine) != len(theirs):
            return False
        if not len(mine):
            return float(np.linalg.det(M)) > 0.0
        moved = mine[:, :3] @ M[:3, :3].T + M[:3, 3]
        gaps = np.linalg.norm(moved[:, None] - theirs[None, :, :3], axis=2)
        gaps += np.abs(mine[:, None, 3] - theirs[None, :, 3])
        return bool((gaps.min(axis=1) < _FACES).all())

    def _rounds(self, i: int) -> Array:
        """Points and radii (n, 4) [m] of the cylinders of a part in its component's frame."""
        faces = [face for face in self._survey.scene.body(i).faces if face.kind == FaceKind.CYLINDER]
        return np.array([[*np.asarray(face.point, float), face.radius] for face in faces]).reshape(-1, 4)


def _same(one: tuple[int, float, Array], two: tuple[int, float, Array]) -> bool:
    """Whether numbers of faces, volumes [m^3] and principal moments of inertia are equal."""
    has_moments = bool(np.abs(one[2] - two[2]).max() < _ALIKE * two[2].max())
    return one[0] == two[0] and abs(one[1] - two[1]) < _ALIKE * two[1] and has_moments
