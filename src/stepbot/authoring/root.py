"""Selects the root link: by name, else the trunk with most branches, else the larger and lower end of the chain."""

from collections import Counter
from collections.abc import Sequence

from .decision import Decision
from .mechanism import Link
from .motors import Motor
from .names import Role
from .structure import Structure

_LOOSE = 0.2
"""Share of the assembly's volume below which a cluster without joints is not the root."""
_NAMED_SHARE = 0.05
"""Share of its cluster's volume from which a part's name counts."""
_BRANCHES, _TRUNK = 3, 1.6
"""Number of joints from which a cluster is a trunk, and what that counts: more joints do not count more, since the
platform of a parallel robot has as many as its base, and a hand as many as a torso.
"""


def find_root(made: Decision, structure: Structure, joints: Sequence[Link], motors: Sequence[Motor]) -> int:
    """The representative of the root cluster."""
    degree = Counter(root for j in joints if not j.hinge.of_roller for root in (j.a, j.b))
    cases = {i for motor in motors for i in motor.parts}
    holds: Counter[int] = Counter()
    for j in joints:
        if j.hinge.drives and j.hinge.a in cases:
            holds[made.clusters.find(j.hinge.a)] += 1
            holds[made.clusters.find(j.hinge.b)] -= 1
    ranked = []
    for root, members in made.clusters.groups().items():
        share = made.survey.total_volume(members) / made.survey.volume
        if not degree or root in degree or share >= _LOOSE:
            ranked.append((_rank(made, structure, members, share, degree[root], holds[root]), -members[0], root))
    return max(ranked)[-1] if ranked else next(iter(made.clusters.groups()))


def _rank(
    made: Decision, structure: Structure, members: Sequence[int], share: float, branches: int, holds: int
) -> float:
    survey = made.survey
    least = _NAMED_SHARE * share * survey.volume
    named = any(Role.BASE in survey.parts[i].roles for i in members if survey.parts[i].volume > least)
    named = named or any(Role.BASE in structure.names(i) for i in members)
    low = min(float(survey.parts[i].box[0][2]) for i in members)
    bottom = 1.0 - (low - float(survey.box[0][2])) / max(1e-9, survey.extent)
    rank = 1.5 * named + share + 0.5 * bottom
    if branches >= _BRANCHES:
        rank += _TRUNK
    if branches == 1:
        rank += 0.3 + 0.4 * ((holds > 0) - (holds < 0))
    return round(rank, 9)
