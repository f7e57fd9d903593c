"""Knuckle hinges: two parts whose bores alternate along one line, as those of a lid and its box on one pin."""

from collections import Counter
from itertools import pairwise

from stepbot.draft.contacts.contacts import CoaxialLine
from stepbot.draft.contacts.shafts import HALF_ROUND, neighbours_on
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.robot.model import JointKind

REVIEW = "bores that alternate along one line: a hinge, unless something else holds it"
_SCORE = 0.91
"""Above that of faces that lock two parts: a closed lid lies on its box."""
_FEWEST = 4
"""Number of bores that alternate, from which they are knuckles and not a fork with a bolt."""
_FORK = 3
"""Number of bores of one of several equal hinges on one line, which have enough together."""
_EQUAL = 1e-5
"""Difference of radii [m] up to which bores are for one pin."""


def knuckle_evidence(survey: Survey, found: Evidence) -> None:
    """Add a joint for each pair of parts with knuckles on one line, and on no other."""
    for line in survey.contacts.lines:
        parts = {i for i in line.faces if i not in survey.small and survey.parts[i].volume > 0.0}
        parts = {i for i in parts if Role.BEARING not in survey.parts[i].roles}
        # Bores that alternate are beside each other.
        runs = {(a, b): _alternations(line, a, b) for a, b in neighbours_on(line) if parts.issuperset((a, b))}
        kinds = Counter(_kind(survey, a, b) for (a, b), count in runs.items() if count >= _FORK)
        for (a, b), count in runs.items():
            least = _FORK if kinds[_kind(survey, a, b)] > 1 else _FEWEST
            if count < least or _other_lines(survey, line, a, b):
                continue
            middle = min(f.low for f in line.faces[a])
            axis = Axis(line.axis.point + line.axis.d * middle, line.axis.d)
            relation = survey.relation(a, b)
            why = "knuckles that alternate on one line"
            found.joint(JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, axis, why, relation, review=REVIEW))


def _alternations(line: CoaxialLine, a: int, b: int) -> int:
    """Number of runs of bores of one radius along a line, by turns of both parts; none if they overlap."""
    bores = [(f.low, f.high, f.radius, i) for i in (a, b) for f in line.faces[i] if f.bore and f.span > HALF_ROUND]
    bores = [row for row in sorted(bores) if not bores or abs(row[2] - bores[0][2]) < _EQUAL]
    if any(here[1] > after[0] + _EQUAL for here, after in pairwise(bores)):
        return 0
    owners = [row[3] for row in bores]
    return 1 + sum(one != two for one, two in pairwise(owners)) if owners else 0


def _kind(survey: Survey, a: int, b: int) -> tuple[str, ...]:
    return tuple(sorted(f"{survey.parts[i].volume:.4g}" for i in (a, b)))


def _other_lines(survey: Survey, line: CoaxialLine, a: int, b: int) -> bool:
    """Whether fits on other lines hold both parts."""
    relation = survey.relation(a, b)
    return relation is not None and any(not fit.axis.same(line.axis) for fit in relation.fits)
