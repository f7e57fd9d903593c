"""Twin bars: equal parts beside each other on the same two lines, such as the plates on both sides of a link.

Each may be held by other parts at its ends, but on the same two axes they can only move as one. Legs on both sides of a
torso are drawn on the same lines, too; they are farther apart than twins, and nothing is on two of their lines.
"""

from collections import defaultdict
from itertools import combinations

from stepbot.draft.contacts.contacts import CoaxialLine, Pair
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import Evidence
from stepbot.draft.parts.axis import are_parallel
from stepbot.draft.parts.names import Role

_SCORE = 0.88
_BESIDE, _OF_SIZE = 4.0, 0.5
"""Gap of twins up to which one line with a part on both is enough: in thicknesses, and as a share of their size."""
_THIN, _PATTERN = 0.35, 0.2
"""Shares of the size: thickness of a bar; distance of two lines up to which they are of one pattern of bolts."""
_GUIDED = 3.0
"""Length of a bore in radii, from which it may be a guide."""
_MOST = 24
"""Number of equal parts on a line above which they are chain links or laminations."""


def twin_evidence(survey: Survey, found: Evidence) -> None:
    """Weld all twin bars."""
    lines: dict[Pair, list[CoaxialLine]] = defaultdict(list)
    for line in survey.contacts.lines:
        equal: dict[int, list[int]] = defaultdict(list)
        for i in line.faces:
            if i not in survey.small and survey.parts[i].volume > 0.0:
                equal[survey.parts[i].definition].append(i)
        for members in equal.values():
            if len(members) <= _MOST:
                for pair in combinations(sorted(members), 2):
                    lines[pair].append(line)
    for (a, b), shared in sorted(lines.items()):
        if len(shared) > 1 and _are_twins(survey, a, b, shared):
            found.weld(_SCORE, a, b, "equal bars on the same lines")


def _are_twins(survey: Survey, a: int, b: int, shared: list[CoaxialLine]) -> bool:
    d = shared[0].axis.d
    if not all(are_parallel(d, line.axis.d) for line in shared):
        return False
    if max(shared[0].axis.distance(line.axis.point) for line in shared) < _PATTERN * survey.parts[a].size:
        return False  # one bolt pattern
    if {Role.JAW, Role.SLIDE} & {*survey.parts[a].roles, *survey.parts[b].roles}:
        return False
    fitted = [[r for r in survey.near.get(i, ()) if r.fits] for i in (a, b)]
    if any(fit.length > _GUIDED * fit.radius for of in fitted for r in of for fit in r.shafts):
        return False  # they may slide on rods
    common = set.intersection(*({r.other(i) for r in of} for i, of in zip((a, b), fitted, strict=True)))
    held = sum(any(i in line.faces for i in common) for line in shared)
    (low_a, high_a), (low_b, high_b) = (survey.scene.span(i, d) for i in (a, b))
    gap, thick = max(low_a - high_b, low_b - high_a), high_a - low_a
    if thick > _THIN * survey.parts[a].size:
        return False
    is_beside = gap < _BESIDE * thick and gap < _OF_SIZE * survey.parts[a].size
    return held > 0 and is_beside
