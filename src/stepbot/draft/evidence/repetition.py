"""Repetition and mirror images: what is a joint in one leg or finger is one in the others, built of equal parts.

A joint is expected between two other parts if they are equal to those of a found one, and its axis, carried over by
both of them, is one line again; or by one of them, if the other is the body that all of them are on.
"""

from collections.abc import Iterator, Sequence
from itertools import product

from stepbot.draft.contacts.near_fits import ANGLE, OFFSET
from stepbot.draft.contacts.relations import Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import BY_NAME, BY_SHAPE, ONLY_CONNECTION, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind

REVIEW = "as between equal parts elsewhere; here the faces alone do not show it"
"""What to review of each such joint."""
_TYPES = (JointKind.REVOLUTE, JointKind.PRISMATIC)
_SCORE = 0.79
"""Highest score of a joint by repetition."""
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
    repeated: list[JointEvidence] = []
    for h in joints:
        if h.type not in _TYPES or h.axis.direction is None or _is_guess(h):
            continue
        for a, b, axis in _elsewhere(survey, h):
            sides = frozenset((link_of[a], link_of[b]))
            known = any(
                (evidence.a, evidence.b) == (a, b) and evidence.axis.same(axis, OFFSET) for evidence in repeated
            )
            if known or (len(sides) == 2 and sides in joined):
                continue
            why = f"as between '{survey.parts[h.a].path}' and '{survey.parts[h.b].path}'"
            relation = survey.relation(a, b)
            repeated.append(JointEvidence(min(_SCORE, h.score), a, b, h.type, axis, why, relation, review=REVIEW))
    return repeated


def _is_guess(h: JointEvidence) -> bool:
    """Whether a joint is too weak to be carried over."""
    is_seam = h.relation is not None and h.relation.via == Via.SEAM
    return h.of_roller or is_seam or h.review in (BY_SHAPE, BY_NAME, ONLY_CONNECTION)


def _elsewhere(survey: Survey, h: JointEvidence) -> Iterator[tuple[int, int, Axis]]:
    """The places where the same joint is expected: both parts, the smaller index first, and the axis."""
    others = [list(_carried(survey, i, h.axis)) for i in (h.a, h.b)]
    smaller = min((survey.parts[i] for i in (h.a, h.b)), key=lambda part: (part.volume, part.index))
    along = float((smaller.com - h.axis.point) @ h.axis.d)
    for (a, of_a), (b, of_b) in product(*others):
        if a != b and {a, b} != {h.a, h.b} and _agree(of_a, of_b, along):
            yield (a, b, of_a) if a < b else (b, a, of_a)
    for own, host in ((0, h.b), (1, h.a)):
        for part, axis in others[own]:
            if part not in (h.a, h.b) and _supports(survey, host, part, axis):
                yield min(part, host), max(part, host), axis


def _carried(survey: Survey, part: int, axis: Axis) -> Iterator[tuple[int, Axis]]:
    """The parts equal to one, itself first, each with the axis that is to it as the given one is to the first."""
    yield part, axis
    alike = [i for i in survey.equal.alike(part) if i not in survey.small]
    if len(alike) > _MOST:
        survey.cut[f"joints were not carried over between more than {_MOST} equal parts"] = None
        return
    for other in alike:
        if other != part and survey.equal.kind(other) == survey.equal.kind(part):
            for placed in survey.equal.carried(part, other, axis):
                yield other, placed


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
