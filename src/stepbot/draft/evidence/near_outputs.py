"""What a motor turns that nothing touches at its output: parts placed by hand beside it, nearly on its axis."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np

from stepbot.draft.contacts.contacts import FitKind
from stepbot.draft.contacts.near_fits import ANGLE, OFFSET
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import Evidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.parts.axis import SAME_LINE, Axis
from stepbot.draft.parts.parts import least_gap
from stepbot.geometry.spatial import Array, perpendicular_frame

_NEARLY_HELD, _NEARLY = 0.86, 0.75
"""Scores of what carries a motor and of what it turns, if their holes are only nearly in line with its own."""
_BEYOND = 4e-3
"""Gap [m] from the end of a motor's output up to which a round face on its line belongs to what it turns."""
_BESIDE, _NEAR_END = 0.6, 1.5e-3
"""Score of what is only the nearest part to the end of a motor's output, and its largest distance [m]."""
_REVIEW_BESIDE = "drawn beside the end of the motor's output; no face shows what it turns"
_REVIEW_NEARLY = "drawn beside the output of the motor, or up to 0.6 mm and 1.2 degrees off"
_ALONE, _ON_SHAFT, _THIN = 0.85, 0.7, 0.09
"""Scores of what is alone on a motor's drawn output or its shaft; radius of a shaft as a share of the size, at most."""
_REVIEW_THROUGH = "a rod through the motor from end to end: the screw of a linear motor slides in it"
_REVIEW_ALONE = "nothing else touches the motor: what is on its shaft may hold it"


def alone(survey: Survey, motor: Motor, outputs: Sequence[int], relations: Iterable[Relation]) -> tuple[float, str]:
    """Score and what to review of the only neighbour of a motor as what it turns, by their relations; 0 if it is not.

    It is on an output that is drawn, or around the shaft of a named case, which is thinner than a flange's spigot.
    """
    if outputs:
        return _ALONE, ""
    thin = _THIN * survey.parts[motor.case].size
    shafts = (fit for r in relations for fit in r.shafts if fit.shaft == motor.case and fit.full)
    is_on_shaft = motor.is_named and any(fit.radius < thin for fit in shafts)
    return (_ON_SHAFT, _REVIEW_ALONE) if is_on_shaft else (0.0, "")


def through(survey: Survey, motor: Motor, r: Relation) -> str:
    """What to review of a rod in the bore of a motor's case that reaches out of both ends of it; empty for others."""
    for fit in r.shafts if motor.case in (r.a, r.b) else ():
        (low, high), (start, end) = (survey.scene.span(i, fit.axis.d) for i in (motor.case, r.other(motor.case)))
        if fit.shaft == r.other(motor.case) and low - start > fit.radius and end - high > fit.radius:
            return _REVIEW_THROUGH
    return ""


def idlers(survey: Survey, axis: Axis, driven: Collection[int], others: Iterable[int]) -> set[int]:
    """Of other parts at a motor those that turn with what it drives: the discs at the other ends of their axis.

    Each is balanced about it, and has a ring of screws to what has one to a driven part, too, or to an equal part, as
    the two plates of a fork.
    """

    def ringed(part: int) -> set[int]:
        around = survey.around(part)
        return {i for i, r in around if r.via == Via.RING and r.axis is not None and r.axis.same(axis, SAME_LINE)}

    held = {i for part in driven for i in ringed(part)}
    kinds = {survey.equal.kind(i) for i in held}
    return {
        part
        for part in others
        if survey.parts[part].is_balanced(axis) and any(survey.equal.kind(i) in kinds for i in ringed(part))
    }


def is_beside(axis: Axis, relations: Sequence[Relation]) -> bool:
    """Whether nothing but faces beside an output's axis touches: a plate under the teeth of a pinion."""
    if any(r.fits or r.sockets or not r.patches for r in relations):
        return False
    across = perpendicular_frame(axis.d)[:, :2]
    hulls = [(patch.hull - axis.point) @ across for r in relations for patch in r.patches]
    return not any(_is_around_origin(hull) for hull in hulls)


def _is_around_origin(outline: Array) -> bool:
    """Whether the origin is in a convex outline (n, 2)."""
    x, y = (outline - np.roll(outline, 1, axis=0)).T
    turns = x * outline[:, 1] - y * outline[:, 0]
    return bool((turns >= 0.0).all() or (turns <= 0.0).all())


def is_through_mount(survey: Survey, motor: Motor, part: int, axis: Axis) -> bool:
    """Whether a shaft in a motor's case is also in what lies on the case, as a screw is: nothing turns there."""
    return any(
        host not in motor.parts
        and any(fit.shaft == part and fit.axis.same(axis) for fit in r.shafts)
        and (on_case := survey.relation(host, motor.case)) is not None
        and bool(on_case.patches)
        for host, r in survey.around(part)
    )


class NearOutput:
    """What is nearly on the output of one motor."""

    def __init__(self, survey: Survey, motor: Motor, axis: Axis, outputs: Sequence[int], evidence: Evidence) -> None:
        self._survey, self._motor, self._axis, self._outputs, self._evidence = survey, motor, axis, outputs, evidence

    def holders(self, known: set[int]) -> set[int]:
        """The parts that have several holes nearly in line with those of a named motor: they carry it."""
        lines: dict[int, list[Axis]] = defaultdict(list)
        for part, axis in self._lines_beside() if self._motor.is_named else ():
            if part not in known and not any(axis.distance(one.point) < OFFSET for one in lines[part]):
                lines[part].append(axis)
        held = {part for part, axes in lines.items() if sum(1 for axis in axes if not self._is_output(axis)) > 1}
        for part in sorted(held):
            why = f"holes nearly in line with those of the motor '{self._motor.path}'"
            self._evidence.weld(_NEARLY_HELD, self._motor.case, part, why, holds_motor=True)
        return held

    def _lines_beside(self) -> Iterator[tuple[int, Axis]]:
        """Other parts, and the axes of faces that are nearly or exactly coaxial with those of the motor."""
        inside = set(self._motor.parts)
        for (a, b), fits in self._survey.near_fits_of(inside):
            if (a in inside) != (b in inside):
                own, other = (a, b) if a in inside else (b, a)
                yield from ((other, fit.of(own)) for fit in fits)
        for i in self._motor.parts:
            for other, r in self._survey.around(i):
                if other not in inside:
                    yield from ((other, fit.axis) for fit in r.fits if fit.kind == FitKind.HOLES)

    def _is_output(self, axis: Axis) -> bool:
        return axis.is_along(self._axis.d, ANGLE) and self._axis.distance(axis.point) < OFFSET

    def hinge(self, held: set[int]) -> tuple[int, float, str, str] | None:
        """The part that the motor turns, or its horn, with score, reason and what to review; None for none.

        The part whose round faces are nearly on the output and next to its end, else the one nearest to the end of the
        output of a motor that something holds.
        """
        if not self._motor.is_named or not (held or self._outputs):
            return None
        spans = self._on_output_line(held)
        own = [span for part in self._motor.parts for span in spans.pop(part, ())]
        if not own:
            return None
        low, high = min(span[0] for span in own), max(span[1] for span in own)
        gaps = {part: min(max(0.0, span[0] - high, low - span[1]) for span in of) for part, of in spans.items()}
        volumes = {part: self._survey.parts[part].volume for part in gaps}
        best = min(gaps, key=lambda part: (round(gaps[part], 5), -volumes[part], part), default=None)
        if best is not None and gaps[best] < _BEYOND:
            return self._on_output(best, _NEARLY, _REVIEW_NEARLY)
        beside = self._beside_end(low, high, held) if held else None
        return None if beside is None else self._on_output(beside, _BESIDE, _REVIEW_BESIDE)

    def _on_output(self, part: int, score: float, review: str) -> tuple[int, float, str, str]:
        anchor = self._outputs[0] if self._outputs else part
        if anchor != part:
            self._evidence.weld(_NEARLY_HELD, anchor, part, f"nearly on the output of '{self._motor.path}'")
        return anchor, score, f"nearly on the output of the motor '{self._motor.path}'", review

    def _on_output_line(self, held: set[int]) -> dict[int, list[tuple[float, float]]]:
        """The spans [m] along the output's axis of all round faces nearly on it, by their parts."""
        survey = self._survey
        spans: dict[int, list[tuple[float, float]]] = defaultdict(list)
        for line in survey.contacts.lines:
            if not line.axis.is_along(self._axis.d, ANGLE):
                continue
            for part, faces in line.faces.items():
                for f in faces if part not in held and part not in survey.small else ():
                    ends = [line.axis.point + line.axis.d * at for at in (f.low, f.high)]
                    if f.span > HALF_ROUND and self._axis.distance(0.5 * (ends[0] + ends[1])) < OFFSET:
                        low, high = sorted(float((end - self._axis.point) @ self._axis.d) for end in ends)
                        spans[part].append((low, high))
        return spans

    def _beside_end(self, low: float, high: float, held: set[int]) -> int | None:
        """The larger part nearest to the end of the output, whose faces span low to high [m] along its axis."""
        axis, survey = self._axis, self._survey
        com = float((survey.parts[self._motor.case].com - axis.point) @ axis.d)
        end = axis.point + axis.d * (high if high - com > com - low else low)
        here, gaps = np.array([end, end]), []
        for i in survey.parts_near(here, _NEAR_END):
            if i not in held and i not in self._motor.parts and i not in survey.small:
                volume = survey.parts[i].volume
                gaps.append((round(least_gap(here[None], survey.scene.face_boxes(i)), 5), -volume, i))
        gap, _, best = min(gaps, default=(_NEAR_END, 0.0, -1))
        return best if gap < _NEAR_END else None
