"""Joints at lone round contacts.

Where all that connects two groups of parts is contacts about one axis, nothing but friction or glue keeps them from
turning on each other. If the mass of neither is symmetric about the axis, as that of a lid, a foot or a knob is, such a
contact is probably a joint: the seam between two shells of an arm, with or without a seal in it.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stepbot.geometry.inertia import MassProperties, combined

from .axis import Axis
from .clusters import Clusters
from .decision import Decision
from .evidence import Fate, Hinge
from .locked import JointKey
from .part import Part, joint_box, largest
from .relations import Relation, Via
from .structure import Structure
from .survey import Survey

REVIEW = "nothing but one round contact holds its two sides together"
"""What to review of such a joint."""
_PIVOTS = (Via.FACE, Via.BOLT)
"""Contacts that may be such a joint: others are found without this."""
_LEAST = 0.01
"""Share of the assembly's volume below which a side of a pivot is a handle, a pin or a cover."""
_CLEARLY = 2.0
"""Multiple of the tolerances of a turned part beyond which a side is lopsided: a lid with a handle is not."""


@dataclass(frozen=True, eq=False)
class _Pivot:
    """Relations of parts of one cluster about one axis."""

    axis: Axis
    relations: list[Relation]


def lone_pivots(made: Decision, structure: Structure) -> list[JointKey]:
    """The joints at lone round contacts within clusters."""
    hinges = {(h.a, h.b): h for h in made.evidence.hinges if h.relation is not None and h.fate != Fate.TAKEN}
    ties = _ties(made)
    found = []
    for root, members in made.clusters.groups().items():
        for pivot in _pivots(made.survey, structure, members):
            hinge = _joint(made.survey, pivot, members, ties[root], hinges)
            if hinge is not None:
                found.append((hinge.a, hinge.b, str(hinge.type)))
    return found


def _ties(made: Decision) -> dict[int, list[tuple[int, int]]]:
    """For each cluster its pairs of parts that are welded, or that one screw fits in."""
    found: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for weld in made.evidence.welds:
        if weld.fate == Fate.TAKEN:
            found[made.clusters.find(weld.a)].append((weld.a, weld.b))
    for screw in made.survey.small:
        hosts = [other for other, r in made.survey.around(screw) if r.fits]
        for a, b in pairwise(hosts):
            if made.clusters.find(a) == made.clusters.find(b):
                found[made.clusters.find(a)].append((a, b))
    return found


def _pivots(survey: Survey, structure: Structure, members: Sequence[int]) -> Iterator[_Pivot]:
    """The axes that parts of a cluster touch each other about, where no screw clamps them."""
    inside, found = set(members), list[_Pivot]()
    for i in members:
        for r in survey.near.get(i, ()):
            axis = r.turns
            is_within = r.a == i and r.b in inside and not structure.are_together(r.a, r.b)
            if not is_within or r.via not in _PIVOTS or axis is None:
                continue
            same = next((pivot for pivot in found if pivot.axis.same(axis)), None)
            if same is None:
                found.append(_Pivot(axis, [r]))
            else:
                same.relations.append(r)
    return (pivot for pivot in found if not survey.has_screw_at(pivot.axis))


def _joint(
    survey: Survey,
    pivot: _Pivot,
    members: Sequence[int],
    ties: Sequence[tuple[int, int]],
    hinges: dict[tuple[int, int], Hinge],
) -> Hinge | None:
    """The joint between the two lopsided sides of a pivot, if there are two."""
    about = {(r.a, r.b) for r in pivot.relations}
    sides = Clusters(members)
    for a, b in ties:
        if (a, b) not in about:
            sides.join(a, b)
    lopsided = [root for root, parts in sides.groups().items() if _is_lopsided(survey, parts, pivot.axis)]
    if len(lopsided) != 2:
        return None
    # What lies between them, such as a seal, goes with one of them: the joint is where least is in contact.
    one, two = lopsided
    path = [r for r in pivot.relations if sides.find(r.a) != sides.find(r.b)]
    chain = Clusters(members)
    for r in sorted(path, key=lambda r: (-round(r.area, 9), r.a, r.b)):
        a, b = sides.find(r.a), sides.find(r.b)
        ends = {chain.find(a), chain.find(b)}
        if ends == {chain.find(one), chain.find(two)}:
            return hinges.get((r.a, r.b))
        chain.join(a, b)
    return None


def _is_lopsided(survey: Survey, members: Sequence[int], axis: Axis) -> bool:
    """Whether the mass of parts is considerable and not symmetric about an axis."""
    whole = _whole([survey.parts[i] for i in members if survey.parts[i].volume])
    return whole is not None and whole.volume > _LEAST * survey.volume and not whole.is_balanced(axis, _CLEARLY)


def _whole(parts: Sequence[Part]) -> Part | None:
    """Several solids as one part."""
    if not parts:
        return None
    whole = combined(MassProperties.of(part.volume, part.com.tolist(), part.inertia) for part in parts)  # of density 1
    low, high = joint_box(parts)
    size = float(np.linalg.norm(high - low))
    return replace(
        largest(parts), volume=whole.mass, com=np.array(whole.com), inertia=np.array(whole.inertia), size=size
    )
