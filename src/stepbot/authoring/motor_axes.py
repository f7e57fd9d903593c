"""The output axis of a motor: from its horn, else by a vote of all motors of one definition."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from stepbot.geometry.sums import exact_sum

from .axis import Axis, are_parallel
from .motors import Motor
from .relations import Relation, Via, reach
from .survey import Survey

SAME_AXIS = 5e-5
"""Distance [m] up to which axes at a motor are equal."""
_WEIGHTS = {Via.RING: 3, Via.FACE: 2, Via.PIN: 2}
_LEVEL = 1e-2
"""Angle [rad] up to which a contact is normal to the output axis."""
_MOST_OUTPUT_VOLUME, _LEAST_OUTPUT_VOLUME = 0.25, 0.01
"""Shares of the case's volume between which an unnamed part may be its output."""


@dataclass(frozen=True, eq=False)
class Output:
    """The output of a motor."""

    axis: Axis
    """In the assembly; in a vote, in the frame of the case."""
    reach: float
    """Radius [m] of the contacts about the axis; 0 if unknown."""


class OutputAxes:
    """The outputs of all motors."""

    def __init__(self, survey: Survey, motors: Sequence[Motor]) -> None:
        self._survey = survey
        self._votes = self._vote(motors)

    def of(self, motor: Motor, outputs: Iterable[int]) -> Output | None:
        """The output of a motor, ``outputs`` being its rotating parts; None without evidence."""
        survey = self._survey
        for output in outputs:
            others = [i for i in motor.parts if i not in (output, motor.case) and i not in survey.small]
            for relation in (survey.relation(output, i) for i in (motor.case, *others)):
                if relation is not None and relation.turns is not None:
                    return Output(relation.turns, reach(relation.turns, [relation]))
            if survey.turned.get(output):
                return Output(survey.turned[output][0], 0.0)
        voted = self._votes.get(survey.parts[motor.case].definition)
        if voted is None:
            return None
        X = survey.scene.component(motor.case).X_WC
        return Output(Axis(X.apply(voted.axis.point), X.turn(voted.axis.d)), voted.reach)

    def _vote(self, motors: Sequence[Motor]) -> Mapping[int, Output]:
        """For each definition of a case, the axis with most rotating parts, in its own frame."""
        survey = self._survey
        votes: dict[int, list[tuple[Axis, list[tuple[int, float]]]]] = defaultdict(list)
        for motor in motors:
            X = survey.scene.component(motor.case).X_WC.inverse()
            of_case = votes[survey.parts[motor.case].definition]
            for other, r in survey.around(motor.case):
                if other in motor.parts or r.via not in _WEIGHTS or r.axis is None:
                    continue
                local = Axis(X.apply(r.axis.point), X.turn(r.axis.d))
                ballot = _WEIGHTS[r.via], max(r.radius, r.ring_radius, reach(r.axis, [r]))
                for axis, ballots in of_case:
                    if axis.same(local, SAME_AXIS):
                        ballots.append(ballot)
                        break
                else:
                    of_case.append((local, [ballot]))
        named = {survey.parts[motor.case].definition for motor in motors if motor.is_named}
        best = {
            # A motor by its use has the output that it was found by, the widest.
            definition: max(of_case, key=_weight if definition in named else _width)
            for definition, of_case in votes.items()
            if of_case
        }
        return {
            definition: Output(axis, max(far for _, far in ballots)) for definition, (axis, ballots) in best.items()
        }


def _weight(vote: tuple[Axis, list[tuple[int, float]]]) -> float:
    return exact_sum(weight for weight, _ in vote[1])


def _width(vote: tuple[Axis, list[tuple[int, float]]]) -> float:
    return round(max(far for _, far in vote[1]), 6)


def hidden_outputs(survey: Survey, motor: Motor) -> list[int]:
    """Unnamed output parts of a motor: small turned parts that touch its housing about one axis only."""
    if motor.outputs or len(motor.parts) < 2:
        return []
    volume = survey.parts[motor.case].volume
    found = []
    for i in motor.parts:
        part = survey.parts[i]
        if i == motor.case or i in survey.small or part.volume > _MOST_OUTPUT_VOLUME * volume:
            continue
        touching = [r for j in motor.parts if survey.parts[j].volume > part.volume and (r := survey.relation(i, j))]
        if not touching or any(r.via not in (Via.FACE, Via.PIN, Via.BOLT) for r in touching):
            continue
        axis = max(touching, key=lambda r: r.radius).axis
        if axis is None or not part.is_balanced(axis):
            continue
        fastened = any(s.other(i) not in motor.parts for s in survey.near[i])
        if fastened or part.volume > _LEAST_OUTPUT_VOLUME * volume:
            found.append((not fastened, -max(r.radius for r in touching), i))
    return [i for _, _, i in sorted(found)][:2]


def lies_on(output: Output, relations: Sequence[Relation]) -> bool:
    """Whether all contacts are on the output's face: normal to its axis, and within its radius."""
    if not output.reach:
        return False
    directions = [p.normal for r in relations for p in r.patches] + [f.axis.d for r in relations for f in r.fits]
    if not all(are_parallel(output.axis.d, direction, _LEVEL) for direction in directions):
        return False
    return 0.0 < reach(output.axis, relations) <= 1.05 * output.reach + 1e-4
