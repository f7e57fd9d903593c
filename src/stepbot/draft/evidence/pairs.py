"""Evidence from two parts in contact: their possible motions, and the likelihood of each."""

from collections.abc import Collection

from stepbot.draft.contacts.concentric import patch_lies_about
from stepbot.draft.contacts.contacts import FitKind
from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import SPIGOT, Relation, Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.subassemblies import Structure, is_guide
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.geometry.spatial import cross, unit
from stepbot.robot.model import JointKind

_REVIEW_BEARING = "a bearing is between two links: one of its sides may belong to it"
"""What to review of a pin at a part named a bearing."""
_REVIEW_ROUND = "round, and as thick as its bore: it may be pressed or screwed in"
"""What to review of a pin that looks the same however it is turned."""
_REVIEW_TUBES = "a round tube in another one: it may turn, too"
_PISTON, _REVIEW_PISTON = 0.82, "a piston with room to travel in its bore: it may turn, too"
"""Score and review of a short shaft with play in a long bore."""
_TUBE, _WALL = 4.0, 0.5
"""Engaged length of tubes, in radii, from which one slides in the other; radius of the bore of a tube, in its own."""
_NEAR, _NEAR_ACROSS = 0.6, 0.72
"""Scores of a hinge about a shaft that is drawn off its bore, within a subassembly and between two."""
_REVIEW_NEAR = "the two are drawn off each other, so that their common axis is a guess"
_OF_LINKAGE = 0.6
"""Maximum score of a linkage's pin: its sides turn on each other, and it is on one of them."""
_RINGS, _TREAD, _AS_WIDE = 0.92, 3.0, 0.25
"""Score of a weld between the rings of one wheel; how far a tread may be from symmetric; share of a width up to which
others are equal.
"""
_DOME, _SEATED = 0.4, 0.55
"""Ratio of the radius of a sphere and the size of a part, from which it is no ball, half of which has 1 / 3; score of
a weld there.
"""
_BORED = 0.86
"""Score of the weld of a bored ball and what is bolted through it."""
_STUD = 4.0
"""Length in radii below which the shaft of a ball is a stud, and does not slide."""
_SERIES = 0.82
"""Score of the weld of an exact fit, if one of its sides turns with play about its axis."""
_SLOT, _OPPOSITE, _ACROSS = 0.35, 0.999, 1e-3
"""Score of a block in a slot; cosines of faces on both sides of it, and of its pin to them."""
_CLAMPED = 0.74
"""Score of the weld of a round body in a clamp."""
_FASTENED = 0.94
"""Score of the weld of a motor's output and what is fastened to it."""
_MIDDLE = 1e-4
"""Distance [m] from the middle of a ball up to which a bore is through it."""
_KEYED = 0.86
"""Score of the weld of a shaft that neither turns nor has play in its bore: it transmits torque."""
_EXACT = 1e-6
"""Difference of radii [m] up to which a shaft fills its bore."""


class PairEvidence:
    """Adds the evidence of pairs of larger parts, except within one motor."""

    def __init__(self, survey: Survey, structure: Structure, evidence: Evidence) -> None:
        self._survey, self._structure, self._evidence = survey, structure, evidence
        self._pivots = evidence.mechanisms
        """Pairs that a linkage needs to turn: an exact fit does not tell."""
        self._draws_play = any(relation.journals for _, relation in survey.pairs())
        strong = [{w.a, w.b} for w in evidence.welds if w.score >= _FASTENED]
        drives = [h for h in evidence.joints if h.drives]
        fastened = {i: {i}.union(*(pair for pair in strong if i in pair)) for h in drives for i in (h.a, h.b)}
        self._driven = [(h.axis, fastened[h.a], fastened[h.b]) for h in drives]
        """Axes of motors; their cases and outputs, each with what is fastened to it, such as a coupling."""
        self._in_motor: Collection[int] = ()

    def collect(self, motors: list[Motor]) -> None:
        """Go through all pairs."""
        motor_of = {i: n for n, motor in enumerate(motors) for i in motor.parts}
        self._in_motor = motor_of.keys()
        for (a, b), relation in self._survey.pairs():
            if a not in motor_of or motor_of[a] != motor_of.get(b):
                self._say(relation)

    def _say(self, r: Relation) -> None:
        by_via = {
            Via.BALL: self._ball,
            Via.SLIDE: self._slide,
            Via.PIN: self._pin,
            Via.FACE: self._face,
            Via.BOLT: self._bolt,
            Via.RING: self._ring,
        }
        if r.via in by_via:
            by_via[r.via](r)
        elif r.is_rigid:
            self._weld(r, *((0.92, f"{r.holes} coaxial holes") if r.holes >= 2 else (0.9, "interlocking faces")))
        elif r.via == Via.GROOVE:
            across = self._across(r)
            self._joint(r, 0.45 if across else 0.2, JointKind.PRISMATIC, "planes that leave one direction free")
            self._weld(r, 0.44 if across else 0.66, "interlocking faces with one free direction")
        elif r.patches:
            parts = self._survey.parts
            share = r.area / max(1e-9, min(parts[r.a].size, parts[r.b].size) ** 2)
            self._weld(r, (0.46 if self._across(r) else 0.55) + min(0.04, share), "plane faces in contact")
            self._in_slot(r)
            self._near_fit(r)
        elif r.holes >= 2:
            self._weld(r, 0.6, f"{r.holes} coaxial holes")
        else:
            self._weld(r, 0.42, "coaxial")

    def _near_fit(self, r: Relation) -> None:
        """A hinge about a shaft that is drawn a little off its bore: the faces in contact alone do not hold it."""
        shafts = [fit for fit in self._survey.near_fits.get((r.a, r.b), ()) if fit.kind == FitKind.SHAFT]
        if len(shafts) == 1 and all(abs(float(patch.normal @ shafts[0].axis.d)) > _OPPOSITE for patch in r.patches):
            fit, score = shafts[0], _NEAR_ACROSS if self._across(r) else _NEAR
            why = f"shaft of r {_mm(fit.radius)} in a bore, {_mm(fit.offset)} off its axis"
            self._evidence.joint(
                JointEvidence(score, r.a, r.b, JointKind.REVOLUTE, fit.axis, why, r, review=_REVIEW_NEAR)
            )

    def _in_slot(self, r: Relation) -> None:
        """Offer a slide of a block on a pin between two faces, across the pin: a loop may need it."""
        normal = r.patches[0].normal
        dots = [float(patch.normal @ normal) for patch in r.patches]
        if min(dots) > -_OPPOSITE or any(abs(dot) < _OPPOSITE for dot in dots):
            return
        for block in (r.a, r.b):
            for _, s in self._survey.around(block):
                if s is not r and s.via == Via.PIN and s.axis is not None and abs(float(s.axis.d @ normal)) < _ACROSS:
                    along = Axis(self._survey.parts[block].com, unit(cross(normal, s.axis.d)))
                    why = "between two faces, across its pin"
                    self._evidence.joint(JointEvidence(_SLOT, r.a, r.b, JointKind.PRISMATIC, along, why, r))
                    return

    def _ball(self, r: Relation) -> None:
        if r.radius > _DOME * min(self._survey.parts[i].size for i in (r.a, r.b)):
            self._weld(r, _SEATED, "a dome in a hollow that is wider than they are")
            return
        score = 0.8 if self._structure.are_together(r.a, r.b) else 0.9
        self._joint(r, score, JointKind.BALL, f"ball of r {_mm(r.radius)} in a socket")
        for ball in (r.a, r.b):
            for other in self._bolted_through(ball, r):
                self._evidence.weld(_BORED, ball, other, "a ball, and what is bolted through it or holds its stud")

    def _bolted_through(self, ball: int, socket: Relation) -> set[int]:
        """The larger parts that a shaft or screw through the middle of a ball is, or is in, or that hold its stud.

        A long shaft of a ball without a shoulder may slide.
        """
        survey, bolted = self._survey, set[int]()
        for r in survey.near.get(ball, ()):
            through = [
                fit.axis
                for fit in r.shafts
                if _is_centred(fit.axis, socket)
                and (fit.shaft == r.other(ball) or r.patches or fit.length < _STUD * fit.radius)
            ]
            if through and r.other(ball) not in survey.small:
                bolted.add(r.other(ball))
            elif through:
                on = (t for t in survey.near.get(r.other(ball), ()) if any(f.axis.same(through[0]) for f in t.shafts))
                bolted |= {t.other(r.other(ball)) for t in on} - survey.small
        return bolted - {socket.a, socket.b}

    def _slide(self, r: Relation) -> None:
        first = r.shafts[0].axis if r.shafts else None
        if first is not None and all(fit.axis.same(first) and fit.clearance < _EXACT for fit in r.shafts):
            self._weld(r, _KEYED, "a shaft with a flat or key in a bore of its form, without play")
            return
        if all(fit.length < SPIGOT * fit.radius for fit in r.shafts):
            self._weld(r, 0.82, "centred by spigots on several lines")
            return
        across = self._across(r)
        guides = across or is_guide(self._survey, r.a, r.b)
        score = 0.82 if across else 0.78 if guides else 0.4
        self._joint(r, score, JointKind.PRISMATIC, f"guided by parallel shafts, {_mm(r.length)} engaged")
        if not guides:
            self._weld(r, 0.62, "parallel shafts in bores")

    def _pin(self, r: Relation) -> None:
        if self._are_rings(r):
            self._weld(r, _RINGS, "rings of one wheel")
            return
        if self._is_ball_stud(r):
            self._weld(r, _BORED, "the stem of a ball stud, with a nut")
            return
        across = self._across(r)
        score = 0.82 if across else 0.3 if self._structure.are_together(r.a, r.b) else 0.7
        roles = self._roles(r)
        if r.length < SPIGOT * r.radius and Role.WHEEL not in roles:
            score -= 0.25
            self._weld(r, 0.5, "centred by a spigot")
        is_exact = max(fit.clearance for fit in r.shafts) < _EXACT
        if not any(fit.full for fit in r.shafts):
            score -= 0.1
            if is_exact and self._is_clamped(r):
                self._weld(r, _CLAMPED, "between two halves of a clamp of its own radius")
        if r.freedom.kind == FreedomKind.REVOLUTE:
            score += 0.03
        if Role.WHEEL in roles:
            score += 0.1
        if r.axis is not None and not all(patch_lies_about(r.axis, patch) for patch in r.patches):
            score -= 0.1
        if self._is_electric(r) or Role.SEAL in roles:
            score -= 0.3
        if not self._evidence.pins.isdisjoint((r.a, r.b)):
            score = min(score, _OF_LINKAGE)
        if not across and r.axis is not None and self._survey.has_screw_at(r.axis):
            score -= 0.25
            self._weld(r, 0.51, "clamped by a screw on its axis")
        if is_exact and self._turns_with(r):
            score -= 0.3
            self._weld(r, _SERIES, "as thick as its bore, and on a line with what turns with play")
        elif not across and self._draws_play and is_exact and (r.a, r.b) not in self._pivots:
            self._weld(r, 0.74, "shaft as thick as its bore, where others have play")
        shoulder = " with a shoulder" if r.freedom.kind == FreedomKind.REVOLUTE else ""
        kind, review = JointKind.REVOLUTE, _REVIEW_BEARING if Role.BEARING in roles else ""
        if _is_telescope(r):
            kind, review = JointKind.PRISMATIC, _REVIEW_TUBES
        elif r.is_piston:
            kind, review, score = JointKind.PRISMATIC, _REVIEW_PISTON, max(score, _PISTON)
        elif not review and is_exact and Role.WHEEL not in roles and self._is_round(r):
            review = _REVIEW_ROUND
        self._joint(r, score, kind, f"{_engaged(r)}{shoulder}", review)

    def _is_round(self, r: Relation) -> bool:
        """Whether one of two parts is symmetric about their axis, so that turning it would show nothing."""
        return r.axis is not None and any(self._survey.parts[i].is_balanced(r.axis) for i in (r.a, r.b))

    def _is_ball_stud(self, r: Relation) -> bool:
        """Whether a nut or the like is on both parts, and one has a ball on the line: it turns in its socket."""
        axis, near = r.axis, [self._survey.near[i] for i in (r.a, r.b)]
        if axis is None or not any(s.via == Via.BALL and _is_centred(axis, s) for some in near for s in some):
            return False
        about = [{i for s in some if s.turns and s.turns.same(axis) for i in (s.a, s.b)} for some in near]
        return not self._survey.small.isdisjoint(about[0] & about[1])

    def _turns_with(self, r: Relation) -> bool:
        """Whether one of two parts turns with play on a third, about the same line: a rim on its hub turns with it.

        So does a shaft in a coupling on a motor. No part is a bearing, whose seats turn though they are exact, nor
        turns about the line in a linkage: there the fit does not tell.
        """
        parts, pair = self._survey.parts, (r.a, r.b)
        if r.axis is None or any(Role.BEARING in parts[i].roles for i in pair) or self._evidence.links_on(r.axis, pair):
            return False
        if self._is_in_coupling(r, r.axis) or self._is_on_spindle(r, r.axis):
            return True
        return any(
            s is not r
            and s.journals
            and s.turns is not None
            and s.turns.same(r.axis)
            and Role.BEARING not in parts[other].roles
            for i in (r.a, r.b)
            for other, s in self._survey.around(i)
        )

    def _is_in_coupling(self, r: Relation, axis: Axis) -> bool:
        """Whether one part is on the output of a motor, and the other ends in it or around it, about the same line."""
        pair = {r.a, r.b}
        return not self._is_through(r, axis) and any(
            pair & outputs and not pair & case and line.same(axis) for line, case, outputs in self._driven
        )

    def _is_on_spindle(self, r: Relation, axis: Axis) -> bool:
        """Whether a shaft is in a bearing on the same line: what else it fits turns with it, but for a nut."""
        shaft = max(r.shafts, key=lambda fit: fit.length).shaft
        return not (Role.SLIDE in self._roles(r) and self._is_through(r, axis)) and any(
            Role.BEARING in self._survey.parts[other].roles
            and s.turns is not None
            and s.turns.same(axis)
            and any(fit.shaft == shaft for fit in s.shafts)
            for other, s in self._survey.around(shaft)
            if shaft not in self._in_motor
        )

    def _is_through(self, r: Relation, axis: Axis) -> bool:
        """Whether a shaft reaches out of both ends of what is around it, as a screw does out of its nut."""
        shaft = max(r.shafts, key=lambda fit: fit.length).shaft
        (start, end), (low, high) = (self._survey.scene.span(i, axis.d) for i in (shaft, r.other(shaft)))
        return start < low and high < end

    def _is_clamped(self, r: Relation) -> bool:
        """Whether a round body lies in half a bore of two parts that touch each other, as a cradle and its strap."""
        shaft = max(r.shafts, key=lambda fit: fit.length).shaft
        return any(
            r.axis is not None
            and other != r.other(shaft)
            and any(not fit.full and fit.shaft == shaft and fit.axis.same(r.axis) for fit in s.shafts)
            and self._survey.relation(other, r.other(shaft)) is not None
            for other, s in self._survey.around(shaft)
        )

    def _are_rings(self, r: Relation) -> bool:
        """Whether two parts are hub, rim or tyre of one wheel: turned about one axis and fitted, by name or as wide."""
        one, two = self._survey.parts[r.a], self._survey.parts[r.b]
        if r.axis is None:
            return False
        balanced = [part.is_balanced(r.axis, _TREAD) for part in (one, two)]
        if Role.PIN in (*one.roles, *two.roles):
            return False  # the axle of a wheel
        if any(balanced) and Role.WHEEL in one.roles and Role.WHEEL in two.roles:  # a rim may have two spokes
            return True
        if not all(balanced):
            return False
        if self._roles(r) & {Role.BEARING, Role.MOTOR, Role.SEAL}:
            return False
        widths = [self._survey.scene.span(i, r.axis.d) for i in (r.a, r.b)]
        is_exact = max(fit.clearance for fit in r.shafts) < _EXACT
        return is_exact and all(abs((high - low) - r.length) < _AS_WIDE * r.length for low, high in widths)

    def _face(self, r: Relation) -> None:
        across = self._across(r)
        score = 0.76 if across else 0.2 if self._structure.are_together(r.a, r.b) else 0.4
        score = max(0.0, score + 0.1 * (Role.WHEEL in self._roles(r)) - 0.3 * self._is_electric(r))
        self._joint(r, score, JointKind.REVOLUTE, f"round face of r {_mm(r.radius)} on a face")
        if not across:
            self._weld(r, 0.52, "round face on a face")

    def _bolt(self, r: Relation) -> None:
        across = self._across(r)
        screwed = r.axis is not None and self._survey.has_screw_at(r.axis)
        score = 0.45 if across else 0.15 if self._structure.are_together(r.a, r.b) else 0.35
        self._joint(r, score - 0.15 * screwed, JointKind.REVOLUTE, "a pair of coaxial holes")
        if screwed:
            self._weld(r, 0.53, "one screw through both")
        elif not across:
            self._weld(r, 0.5, "a pair of coaxial holes")

    def _ring(self, r: Relation) -> None:
        why = f"flange with {r.ring} holes in a circle of r {_mm(r.ring_radius)}"
        self._joint(r, 0.3, JointKind.REVOLUTE, why)
        self._weld(r, 0.88, why)

    def _across(self, r: Relation) -> bool:
        return self._structure.are_across(r.a, r.b)

    def _roles(self, r: Relation) -> set[Role]:
        return {*self._survey.parts[r.a].roles, *self._survey.parts[r.b].roles}

    def _is_electric(self, r: Relation) -> bool:
        return Role.ELECTRIC in (self._survey.parts[r.a].role, self._survey.parts[r.b].role)

    def _weld(self, r: Relation, score: float, why: str) -> None:
        self._evidence.weld(score, r.a, r.b, why)

    def _joint(self, r: Relation, score: float, kind: JointKind, why: str, review: str = "") -> None:
        assert r.axis is not None
        self._evidence.joint(JointEvidence(score, r.a, r.b, kind, r.axis, why, r, review=review))


@rule(80)
def pair_evidence(survey: Survey, motors: list[Motor], structure: Structure, evidence: Evidence) -> None:
    """Add the evidence of all pairs of larger parts."""
    PairEvidence(survey, structure, evidence).collect(motors)


def _is_telescope(r: Relation) -> bool:
    """Whether one tube is in another one with play, over two diameters, and free along it."""
    tubes = [fit for fit in r.fits if fit.kind == FitKind.HOLES]
    return r.freedom.kind == FreedomKind.CYLINDRICAL and any(
        fit.clearance > _EXACT and fit.length > _TUBE * fit.radius and hollow.radius > _WALL * fit.radius
        for fit in r.journals
        for hollow in tubes
    )


def _is_centred(axis: Axis, socket: Relation) -> bool:
    return socket.axis is not None and axis.distance(socket.axis.point) < _MIDDLE


def _engaged(r: Relation) -> str:
    fit = max(r.shafts, key=lambda f: f.length)
    shaft, bore = (fit.radius_a, fit.radius_b) if fit.shaft == fit.a else (fit.radius_b, fit.radius_a)
    return f"shaft of r {_mm(shaft)} in a bore of r {_mm(bore)}, {_mm(r.length)} engaged"


def _mm(length: float) -> str:
    return f"{round(length * 1e3, 3) + 0.0:.6g} mm"
