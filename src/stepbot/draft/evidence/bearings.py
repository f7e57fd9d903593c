"""Joints at bearings: the part that holds the outer ring turns about the part in the bore, screwed on or not."""

import re

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.contacts import FitKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.pivots import in_holes
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Part
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.robot.model import JointKind

_LINEAR = re.compile(r"(?:^|[\W_])(?:lm[a-z]{0,2}|scs)[ _\-]?\d+|linear|直线", re.IGNORECASE)
"""Names of bearings that a shaft slides in."""
_RINGS, _IN_ONE = 0.93, 0.98
"""Scores of rings each bolted to another part: above those of a bearing in its seat, and of bodies of one part."""
_SEATED = 0.87
"""Score of a joint at a bearing."""
_BETWEEN = 0.79
"""Score of a joint at a ring that is known as a bearing by its use alone: above a subassembly, and faces."""
_DISC, _REVIEW = 0.79, "no bolts of the disc are drawn in line with holes of what it carries"
"""Score and review of a disc in the end of a bolted part, with another part on its face alone."""
_CAGED = 4.0
"""How far a bearing with drawn balls may be from symmetric."""
_LONG = 3.0
"""Length in radii from which a plain bearing guides a rod that slides."""
_BESIDE = 0.5
"""Share of the narrower ring's width that is inside of the wider one."""
_SAME_WIDTH = 0.05
"""Share of the width of two rings up to which they are equally wide."""
_BOLTS, _SAME_AXIS, _EXACT = 3, 5e-5, 1e-6
"""Fewest holes in a circle; distance [m] up to which its axis is that of the rings; difference of radii [m] of a press
fit.
"""


class _Seat(Struct, frozen=True, eq=False):
    """A part that a bearing sits in, or that sits in the bearing."""

    part: int
    relation: Relation
    length: float


@rule(110)
def bearing_evidence(survey: Survey, evidence: Evidence) -> None:
    """Add the evidence of all bearings."""
    for i, part in survey.parts.items():
        if i in survey.small:
            continue
        if _is_bearing(part):
            _say(survey, i, evidence)
        elif part.role is None and _is_between(survey, i):
            _say(survey, i, evidence, is_known=False)


def _is_between(survey: Survey, ring: int) -> bool:
    """Whether a turned ring alone is between a shaft and a bore, which it fits exactly, and which do not touch."""
    seats = [seat for some in _seats(survey, ring) for seat in some]
    pair = [seat.part for seat in seats]
    if len(pair) != 2 or len({*pair} - survey.small) != 2 or any(_is_bearing(survey.parts[i]) for i in pair):
        return False
    across = survey.relation(*pair)
    fits = [fit for seat in seats for fit in seat.relation.shafts]
    is_pressed = all(fit.full and fit.clearance < _EXACT for fit in fits) and fits[0].shaft != ring == fits[-1].shaft
    are_pins = all(seat.relation.via == Via.PIN for seat in seats)
    are_held = across is not None and (across.patches or any(fit.clearance < _EXACT for fit in across.shafts))
    return is_pressed and are_pins and not are_held


@rule(120)
def ring_evidence(survey: Survey, evidence: Evidence) -> None:
    """Two rings in each other, of which each is bolted to another part about their axis, turn: a slewing ring."""
    for (a, b), r in survey.pairs():
        are_rings = r.via == Via.BOLT and not r.patches and _is_around(survey, r)
        if r.axis is None or not (are_rings or r.via == Via.PIN):
            continue
        if _are_bolted(survey, a, _Seat(b, r, r.length)):
            why = "rings in each other, each bolted to another part"
            score = _IN_ONE if survey.are_bodies_of_one_part(a, b) else _RINGS
            evidence.joint(JointEvidence(score, a, b, JointKind.REVOLUTE, r.axis, why, r, by_role=True))
        elif are_rings and ((path := _bearing_of(survey, r)) or _are_seated(survey, r)):
            is_named = bool(path) or any(Role.BEARING in survey.parts[i].roles for i in (a, b))
            why = f"rings of the bearing '{path}'" if path else "rings of one width, each in a seat of its own"
            review = "" if is_named else "not named as a bearing"
            evidence.joint(
                JointEvidence(_SEATED, a, b, JointKind.REVOLUTE, r.axis, why, r, by_role=True, review=review)
            )
            for ring in (a, b):
                for other, s in survey.around(ring):
                    if s.via == Via.PIN and s.axis is not None and s.axis.same(r.axis):
                        evidence.weld(_RINGS, ring, other, "ring of a bearing in its seat")
        elif r.via == Via.PIN and (carried := _carried(survey, r, r.axis)) >= 0:
            why = "a disc with play in the end of what is bolted to another part"
            evidence.joint(JointEvidence(_DISC, a, b, JointKind.REVOLUTE, r.axis, why, r, by_role=True, review=_REVIEW))
            evidence.weld(
                _DISC, max(r.shafts, key=lambda f: f.length).shaft, carried, "on the face of a disc that turns"
            )


def _is_around(survey: Survey, r: Relation) -> bool:
    """Whether one of two coaxial parts is around the other across a gap, as the rings of a bearing with balls are."""
    assert r.axis is not None
    (low, high), (low2, high2) = (survey.scene.span(i, r.axis.d) for i in (r.a, r.b))
    return min(high, high2) - max(low, low2) > _BESIDE * min(high - low, high2 - low2)


def _are_seated(survey: Survey, r: Relation) -> bool:
    """Whether two rings across a gap are turned and equally wide, the inner one on a shaft, the outer one in a bore."""
    assert r.axis is not None
    if survey.are_bodies_of_one_part(r.a, r.b) or not all(
        survey.parts[i].is_balanced(r.axis, _CAGED) for i in (r.a, r.b)
    ):
        return False
    across = perpendicular_frame(r.axis.d)[:, 0]
    inner, outer = sorted((r.a, r.b), key=lambda i: float(np.ptp(survey.scene.span(i, across))))
    widths = [float(np.ptp(survey.scene.span(i, r.axis.d))) for i in (inner, outer)]
    if abs(widths[0] - widths[1]) > _SAME_WIDTH * max(widths):
        return False
    seats = (*_seats(survey, inner)[:1], *_seats(survey, outer)[1:])
    return all(
        any(s.part not in survey.small and s.relation.axis.same(r.axis) for s in some if s.relation.axis)
        for some in seats
    )


def _bearing_of(survey: Survey, r: Relation) -> str:
    """The path of the subassembly that two parts are in, if it is named a bearing; else empty.

    Empty also for bodies of one part, which are welded to each other.
    """
    one, two = (survey.assembly.components[i] for i in (r.a, r.b))
    is_one = survey.sources.tree and one.parent == two.parent > 0 and bool(one.product and two.product)
    is_bearing = is_one and Role.BEARING in survey.node_roles(one.parent)
    return survey.assembly.components[one.parent].path if is_bearing else ""


def _carried(survey: Survey, r: Relation, axis: Axis) -> int:
    """The only part on the face of a disc in the end of a bolted part, such as drawn at another angle; -1 for none."""
    fit = max(r.shafts, key=lambda f: f.length)
    disc, case = fit.shaft, r.other(fit.shaft)
    if fit.clearance <= _EXACT or not survey.parts[disc].is_balanced(axis):
        return -1
    around = [(other, s) for other, s in survey.around(disc) if other not in survey.small and other != case]
    holding = _bolted_to(survey, case, axis)
    on_face = [s.via == Via.FACE and s.turns is not None and s.turns.same(axis, _SAME_AXIS) for _, s in around]
    return around[0][0] if holding and on_face == [True] and around[0][0] not in holding else -1


def _are_bolted(survey: Survey, part: int, seat: _Seat) -> bool:
    """Whether of two parts, one in the other, each has a circle of holes about their axis with a part of its own."""
    one, two = (_bolted_to(survey, i, seat.relation.turns) for i in (part, seat.part))
    return bool(one - two - {seat.part}) and bool(two - one - {part})


def _bolted_to(survey: Survey, i: int, axis: Axis | None) -> set[int]:
    """The parts with bolts on a circle about an axis in common with a part, though some may be left out."""
    bolted = set[int]()
    for other, r in survey.around(i):
        holes = [fit.axis for fit in r.fits if axis and fit.kind == FitKind.HOLES and axis.is_along(fit.axis.d)]
        away = [far for hole in holes if axis and (far := axis.distance(hole.point)) > _SAME_AXIS]
        if any(sum(abs(far - one) < _SAME_AXIS for one in away) >= _BOLTS for far in away):
            bolted.add(other)
    return bolted


def _say(survey: Survey, bearing: int, evidence: Evidence, *, is_known: bool = True) -> None:
    inner, outer = _seats(survey, bearing)
    held = next((seat for seat in outer if seat.part not in survey.small), None)
    if held is None or _are_bolted(survey, bearing, held):
        return
    evidence.weld(0.93, bearing, held.part, "bearing in its seat")
    turning = [x for x in _turning(survey, bearing, held, inner) if x != held.part]
    turning = [x for x in turning if not _is_bearing(survey.parts[x])]
    if turning:
        a, b = sorted((held.part, turning[0]))
        axis = held.relation.axis
        assert axis is not None
        path, is_named = survey.parts[bearing].path, Role.BEARING in survey.parts[bearing].roles
        why = f"the bearing '{path}' is between them" if is_named else f"'{path}' has the dimensions of a bearing"
        why = why if is_known else f"the ring '{path}' alone is between them"
        review = "" if is_named else "not named as a bearing"
        kind = JointKind.REVOLUTE
        if survey.parts[bearing].is_linear or (is_named and _LINEAR.search(survey.parts[bearing].name)):
            why = why.replace("a bearing", "a linear bearing")
            kind, review = JointKind.PRISMATIC, "slides in a linear bearing; may turn, too, if nothing else holds it"
        elif is_named and _slides_through(survey, bearing, turning[0]):
            kind, review = JointKind.PRISMATIC, "nothing holds the rod along its plain bearing; it may turn, too"
        score = _SEATED if is_known else _BETWEEN
        hinge = JointEvidence(score, a, b, kind, axis, why, held.relation, by_role=is_named, review=review)
        hinge.through = bearing
        evidence.joint(hinge)


def _around_pin(survey: Survey, pin: int, seat: int, axis: Axis) -> list[int]:
    """What a pin that only bearings touch goes through with the clearance of a hole, but for their seat."""
    in_bearings = all(_is_bearing(survey.parts[other]) for other, _ in survey.around(pin))
    is_pin = in_bearings and survey.parts[pin].is_balanced(axis)
    around = in_holes(survey, pin, axis) if is_pin else []
    return [other for other in around if other != seat and not _is_bearing(survey.parts[other])]


def _slides_through(survey: Survey, bearing: int, rod: int) -> bool:
    """Whether a rod reaches far out of both ends of a long plain bearing, and is nowhere else in a bearing."""
    r = survey.relation(bearing, rod)
    if r is None or r.axis is None or r.length < _LONG * r.radius or r.patches:
        return False
    (low, high), (start, end) = (survey.scene.span(i, r.axis.d) for i in (bearing, rod))
    others = (other for other, s in survey.around(rod) if other != bearing and s.via == Via.PIN)
    return min(low - start, end - high) > r.length and not any(_is_bearing(survey.parts[i]) for i in others)


def _is_bearing(part: Part) -> bool:
    return part.role == Role.BEARING or Role.BEARING in part.roles


def _seats(survey: Survey, bearing: int) -> tuple[list[_Seat], list[_Seat]]:
    """The parts in a bearing's bore and those around it, the longest fit first."""
    inner: list[_Seat] = []
    outer: list[_Seat] = []
    for r in survey.near.get(bearing, ()):
        if r.turns is None or not r.shafts or not survey.parts[bearing].is_balanced(r.turns, _CAGED):
            continue
        fit = max(r.shafts, key=lambda f: f.length)
        (outer if fit.shaft == bearing else inner).append(_Seat(r.other(bearing), r, fit.length))
    return sorted(inner, key=_longest_first), sorted(outer, key=_longest_first)


def _longest_first(seat: _Seat) -> tuple[float, int]:
    return -round(seat.length, 9), seat.part


def _turning(survey: Survey, bearing: int, held: _Seat, inner: list[_Seat]) -> list[int]:
    """The parts that turn in a bearing: those in its bore, those held by a screw in its bore, those on its face."""
    axis = held.relation.axis
    assert axis is not None
    turning: list[int] = []
    for seat in inner:
        if seat.part not in survey.small:
            turning += _around_pin(survey, seat.part, held.part, axis) or [seat.part]
            continue
        on_screw = [other for other, r in survey.around(seat.part) if r.turns is not None and r.turns.same(axis)]
        on_screw = [other for other in on_screw if other not in (bearing, held.part)]
        turning += on_screw or [other for other in in_holes(survey, seat.part, axis) if other != held.part]
    turning += [
        other
        for other, r in survey.around(bearing)
        if r.via in (Via.BOLT, Via.FACE) and r.axis is not None and r.axis.same(axis)
    ]
    return list(dict.fromkeys(turning))
