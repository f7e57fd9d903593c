"""Slides on two rods and crosses of universal joints: relations that only three bodies together reveal."""

from itertools import combinations

import numpy as np

from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.robot.model import JointKind

_LONGER = 1.3
"""Ratio of the lengths of a rod and its bore, from which a part can slide on it."""
_LONG_BORE = 3.0
"""Length of a bore in radii, above which it guides, below which it clamps."""
_APART = 1e-3
"""Distance [m] from which two rods are distinct."""
_MEET = 1e-5
"""Distance [m] up to which two axes intersect."""
_CROSS_SHARE = 0.02
"""Share of the assembly's volume up to which a part can be a cross."""


def guide_evidence(survey: Survey, found: Evidence) -> None:
    """A part with bores on two parallel rods of one body, not held along them, slides on them."""
    for i in survey.parts:
        if i in survey.small:
            continue
        rods = [(other, r) for other, r in survey.around(i) if _is_rod(survey, other, r)]
        for (one, r), (two, s) in combinations(rods, 2):
            axis = r.axis
            assert axis is not None
            assert s.axis is not None
            if not axis.is_along(s.axis.d) or axis.distance(s.axis.point) < _APART or _is_blocked(survey, i, axis):
                continue
            if not _have_one_holder(survey, i, one, two):
                continue
            for rod in (one, two):
                for holder, q in survey.around(rod):
                    if holder != i and q.via == Via.PIN and q.length <= _LONG_BORE * q.radius:
                        found.weld(0.775, rod, holder, "rod in its holder")
                a, b = sorted((i, rod))
                found.joint(JointEvidence(0.77, a, b, JointKind.PRISMATIC, axis, "slides on two rods", r))


def _is_rod(survey: Survey, other: int, r: Relation) -> bool:
    if r.via != Via.PIN or r.axis is None or not survey.parts[other].is_balanced(r.axis):
        return False
    fit = max(r.shafts, key=lambda f: f.length)
    box = survey.parts[other].box
    along = float((box[1] - box[0]) @ np.abs(r.axis.d))
    is_long = along > _LONGER * fit.length > _LONGER * _LONG_BORE * r.radius
    return fit.shaft == other and is_long and r.freedom.kind == FreedomKind.CYLINDRICAL


def _have_one_holder(survey: Survey, part: int, one: int, two: int) -> bool:
    """Whether another part touches both rods; the pins of a linkage are each in another link."""
    holders = [{other for other, _ in survey.around(rod)} for rod in (one, two)]
    return bool(holders[0] & holders[1] - {part})


def _is_blocked(survey: Survey, part: int, axis: Axis) -> bool:
    """Whether a face blocks a part along an axis."""
    return any(abs(float(p.normal @ axis.d)) > 0.99 for _, r in survey.around(part) for p in r.patches)


def cross_evidence(survey: Survey, structure: Structure, found: Evidence) -> None:
    """A small part that turns in two others about axes that intersect at a right angle is a universal joint's cross."""
    pins: dict[int, list[Relation]] = {}
    for (a, b), r in survey.pairs():
        if r.via == Via.PIN:
            pins.setdefault(a, []).append(r)
            pins.setdefault(b, []).append(r)
    for i, relations in pins.items():
        for r, s in combinations(relations, 2):
            centre = _crossing(r, s)
            one, two = r.other(i), s.other(i)
            if centre is None or one == two:
                continue
            sides = min(survey.parts[one].volume, survey.parts[two].volume)
            if survey.parts[i].volume > min(_CROSS_SHARE * survey.volume, 2.0 * sides):
                continue
            # The cross goes with the side of its subassembly.
            moving, still = (r, s) if structure.are_together(i, two) else (s, r)
            assert moving.axis is not None
            assert still.axis is not None
            a, b = sorted((i, moving.other(i)))
            axes = Axis(centre, moving.axis.d), Axis(centre, still.axis.d)
            why = "a cross with two axes at a right angle"
            found.joint(JointEvidence(0.86, a, b, JointKind.UNIVERSAL, axes[0], why, moving, axes[1]))
            found.weld(0.87, i, still.other(i), "cross of a universal joint")


def _crossing(r: Relation, s: Relation) -> np.ndarray | None:
    """The point where the axes of two relations intersect at a right angle."""
    assert r.axis is not None
    assert s.axis is not None
    if abs(float(r.axis.d @ s.axis.d)) > 1e-3 or are_parallel(r.axis.d, s.axis.d):
        return None
    normal = np.cross(r.axis.d, s.axis.d)
    between = s.axis.point - r.axis.point
    if abs(float(between @ normal)) > _MEET:
        return None
    t = float(np.cross(between, s.axis.d) @ normal) / float(normal @ normal)
    return np.asarray(r.axis.point + t * r.axis.d)
