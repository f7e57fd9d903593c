"""What a motor turns: the parts at its output, and what carries it.

The output axis is that of the motor's horn, else it is chosen by a vote of all equal motors.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.contacts.relations import Relation, Via, is_even, merged, reach
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.near_outputs import NearOutput, alone, idlers, is_beside, is_through_mount, through
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.robot.model import JointKind

SAME_AXIS = 5e-5
"""Distance [m] up to which axes at a motor are equal."""
_WEIGHTS = {Via.RING: 3, Via.FACE: 2, Via.PIN: 2}
_TURNING = (Via.FACE, Via.PIN, Via.BOLT)
_LEVEL = 1e-2
"""Angle [rad] up to which a contact is normal to the output axis."""
_MOST_OUTPUT_VOLUME, _LEAST_OUTPUT_VOLUME, _SHAFT = 0.25, 0.01, 0.05
"""Shares of the case's volume between which an unnamed part may be its output, and up to which what turns on it may be
its shaft.
"""


class Output(Struct, frozen=True, eq=False):
    """The output of a motor."""

    axis: Axis
    """In the assembly; in a vote, in the frame of the kind of case."""
    reach: float
    """Radius [m] of the contacts about the axis; 0 if unknown."""


class OutputAxes:
    """The outputs of all motors."""

    def __init__(self, survey: Survey, motors: Sequence[Motor]) -> None:
        self._survey = survey
        self._votes = self._vote(motors)

    def of(self, motor: Motor, outputs: Iterable[int]) -> Output | None:
        """The output of a motor, ``outputs`` being its rotating parts; None without evidence."""
        survey, outputs = self._survey, list(outputs)
        for output in outputs:
            others = [i for i in motor.parts if i not in (output, motor.case) and i not in survey.small]
            for relation in (survey.relation(output, i) for i in (motor.case, *others)):
                if relation is not None and relation.turns is not None:
                    return Output(relation.turns, reach(relation.turns, [relation]))
        for output in outputs:
            if survey.turned.get(output):
                return Output(survey.turned[output][0], 0.0)
        voted = self._votes.get(survey.equal.kind(motor.case))
        if voted is None:
            return None
        axes = survey.equal.placed(motor.case, voted.axis)
        used = [r.axis for _, r in survey.around(motor.case) if r.axis is not None] if len(axes) > 1 else []
        return Output(next((a for a in axes if any(a.same(b, SAME_AXIS) for b in used)), axes[0]), voted.reach)

    def _vote(self, motors: Sequence[Motor]) -> Mapping[int, Output]:
        """For each kind of case, the axis with most rotating parts, in its own frame."""
        survey = self._survey
        votes: dict[int, list[tuple[Axis, list[tuple[int, float]]]]] = defaultdict(list)
        for motor in motors:
            of_case = votes[survey.equal.kind(motor.case)]
            for other, r in survey.around(motor.case):
                is_horn = r.via == Via.BOLT and motor.is_named and Role.HORN in survey.parts[other].roles
                if other in motor.parts or r.axis is None or not (is_horn or r.via in _WEIGHTS):
                    continue
                is_ears = r.via == Via.RING and not is_even(r, r.axis)  # at the corners of a rectangle
                if is_ears or is_through_mount(survey, motor, other, r.axis):
                    continue
                local = survey.equal.axes(motor.case, r.axis)
                ballot = _WEIGHTS.get(r.via, 2), max(r.radius, r.ring_radius, reach(r.axis, [r]))
                for axis, ballots in of_case:
                    if any(axis.same(one, SAME_AXIS) for one in local):
                        ballots.append(ballot)
                        break
                else:
                    of_case.append((local[0], [ballot]))
            if motor.is_named and not of_case:
                self._vote_by_shafts(motor, of_case)
        named = {survey.equal.kind(motor.case) for motor in motors if motor.is_named}
        best = {
            # A motor by its use has the output that it was found by, the widest.
            kind: max(of_case, key=_weight if kind in named else _width)
            for kind, of_case in votes.items()
            if of_case
        }
        return {kind: Output(axis, max(far for _, far in ballots)) for kind, (axis, ballots) in best.items()}

    def _vote_by_shafts(self, motor: Motor, of_case: list[tuple[Axis, list[tuple[int, float]]]]) -> None:
        """Votes for the shaft of a motor that another part's bore is nearly on: nothing touches its output."""
        for _, fits in self._survey.near_fits_of([motor.case]):
            for fit in fits:
                if fit.shaft == motor.case:
                    axis = self._survey.equal.axes(motor.case, fit.of(motor.case))[0]
                    of_case.append((axis, [(1, fit.radius)]))


def _weight(vote: tuple[Axis, list[tuple[int, float]]]) -> float:
    return exact_sum(weight for weight, _ in vote[1])


def _width(vote: tuple[Axis, list[tuple[int, float]]]) -> float:
    return round(max(far for _, far in vote[1]), 6)


def hidden_outputs(survey: Survey, motor: Motor) -> list[int]:
    """Unnamed output parts of a motor: small turned parts that touch its housing about one axis only."""
    if motor.outputs or len(motor.parts) < 2:
        return []
    volume = survey.parts[motor.case].volume
    outputs = []
    for i in motor.parts:
        part = survey.parts[i]
        if i == motor.case or i in survey.small or part.volume > _MOST_OUTPUT_VOLUME * volume:
            continue
        touching = [r for j in motor.parts if survey.parts[j].volume > part.volume and (r := survey.relation(i, j))]
        if not touching or any(r.via not in (Via.FACE, Via.PIN, Via.BOLT) for r in touching):
            continue
        axis = max(touching, key=lambda r: r.radius).axis
        fastened = any(s.other(i) not in motor.parts for s in survey.near[i])
        is_horn = fastened and all(r.via == Via.PIN for r in touching)  # its arm is on one side
        if axis is None or not (is_horn or part.is_balanced(axis)):
            continue
        if fastened or part.volume > _LEAST_OUTPUT_VOLUME * volume:
            outputs.append((not fastened, -max(r.radius for r in touching), i))
    return [i for _, _, i in sorted(outputs)][:2]


def apart_outputs(survey: Survey, motor: Motor) -> dict[int, list[int]]:
    """Outputs that bearings or their gap separate from the case of a named motor; what else is of each.

    They are turned about one line of the case, touch the rest of the motor only about it, and carry what is outside.
    """
    larger = [i for i in motor.parts if i not in survey.small]
    if motor.outputs or not motor.is_named or len(larger) < 2:
        return {}
    outputs: dict[int, list[int]] = {}
    for axis in survey.turned.get(motor.case, ()):
        held = Clusters(larger)
        for i, k in combinations(larger, 2):
            r = survey.relation(i, k)
            if r is not None and not (r.via in _TURNING and r.axis is not None and r.axis.same(axis, SAME_AXIS)):
                held.join(i, k)
        for island in held.groups().values():
            first = max(island, key=lambda i: (survey.parts[i].volume, -i))
            carries = any(other not in motor.parts for i in island for other, _ in survey.around(i))
            is_turned = any(axis.same(line, SAME_AXIS) for line in survey.turned.get(first, ()))
            is_turned &= all(survey.parts[i].is_balanced(axis) for i in island)
            if motor.case not in island and carries and is_turned:
                outputs[first] = [i for i in island if i != first]
        if outputs:
            break
    return outputs


def lies_on(output: Output, relations: Sequence[Relation]) -> bool:
    """Whether all contacts are on the output's face: normal to its axis, and within its radius."""
    if not output.reach or not _is_level(output, relations):
        return False
    return 0.0 < reach(output.axis, relations) <= 1.05 * output.reach + 1e-4


def _is_level(output: Output, relations: Sequence[Relation]) -> bool:
    """Whether all contacts are normal to the output's axis."""
    directions = [p.normal for r in relations for p in r.patches] + [f.axis.d for r in relations for f in r.fits]
    return all(are_parallel(output.axis.d, direction, _LEVEL) for direction in directions)


_BRUSH_AREA, _WIDER, _BOLTED = 5e-6, 0.8, 0.9
"""Contact [m^2] below which a part with fewer than two holes in line holds no motor; ratio of two sides' radii; score
of an output that is bolted on within the circle that holds the case, above that of what a circle of bolts holds.
"""


class _Side(Struct, frozen=True, eq=False):
    """A part that touches a motor."""

    part: int
    relations: tuple[Relation, ...]
    whole: Relation
    on_output: bool
    is_seat: bool = False
    """Whether it holds the case by a face about the output's axis, wider than the output."""

    @property
    def is_held(self) -> bool:
        """Whether the contact is more than incidental."""
        return self.is_seat or self.whole.holes >= 2 or self.whole.area > _BRUSH_AREA or self.whole.freedom.dof <= 1


@rule(10)
def motor_evidence(survey: Survey, motors: Sequence[Motor], evidence: Evidence) -> None:
    """Add the evidence of all motors."""
    axes = OutputAxes(survey, motors)
    for motor in motors:
        _OneMotor(survey, motor, axes, evidence).say()


class _OneMotor:
    def __init__(self, survey: Survey, motor: Motor, axes: OutputAxes, evidence: Evidence) -> None:
        self._survey, self._motor, self._evidence = survey, motor, evidence
        named = [i for i in motor.outputs if i not in survey.small]
        self._apart = apart_outputs(survey, motor)
        hidden = list(self._apart) or hidden_outputs(survey, motor)
        self._outputs = list(dict.fromkeys([*named, *hidden]))
        self._anchors = {o: o for o in self._outputs} | {i: o for o, others in self._apart.items() for i in others}
        """The output of each part that turns with one."""
        self._output = axes.of(motor, self._outputs)
        self._idlers: set[int] = set()

    def say(self) -> None:
        """Add the evidence of this motor."""
        motor, survey = self._motor, self._survey
        for output, others in self._apart.items():
            for i in others:
                self._evidence.weld(0.96, output, i, f"parts of the output of '{motor.path}'")
        for i in motor.parts:
            if i != motor.case and i not in self._anchors and i not in survey.small:
                self._evidence.weld(0.96, motor.case, i, f"parts of the motor '{motor.path}'")
        if self._output is None:
            return
        sides = self._sides(self._output)
        driven = [side for side in sides if side.on_output]
        carrying = [side for side in sides if not side.on_output and side.is_held]
        near = NearOutput(survey, motor, self._output.axis, self._outputs, self._evidence)
        held = {side.part for side in carrying} | near.holders({side.part for side in driven})
        hinge = near.hinge(held) if not driven else None
        if hinge is not None:
            self._joint(*hinge)
            for side in carrying:
                self._evidence.weld(0.94, motor.case, side.part, f"carries the motor '{motor.path}'", holds_motor=True)
            return
        score, why, review = 0.95, f"output of the motor '{motor.path}'", ""
        if not carrying:
            driven, carrying, score, review = self._split(driven)
        for side in carrying:
            self._evidence.weld(0.94, motor.case, side.part, f"carries the motor '{motor.path}'", holds_motor=True)
        if not driven:
            if carrying and self._outputs:
                self._idle(why)
            return
        if not motor.is_named:
            why, review = f"used like the output of a motor, '{motor.path}'", "not named as a motor"
        self._drive(driven, score, why, review)

    def _sides(self, output: Output) -> list[_Side]:
        outside: dict[int, list[Relation]] = defaultdict(list)
        survey = self._survey
        for i in self._motor.parts:
            for other, r in survey.around(i):
                if other not in self._motor.parts:
                    outside[other].append(r)
        sides = []
        for part, relations in sorted(outside.items()):
            touched = {r.other(part) for r in relations}
            whole = merged(relations, (relations[0].a, relations[0].b), [output.axis])
            about = whole.turns is not None and whole.turns.same(output.axis, SAME_AXIS)
            by_name = bool(self._outputs) and touched - survey.small <= set(self._anchors)
            by_name &= not is_beside(output.axis, relations)
            sides.append(_Side(part, tuple(relations), whole, by_name or about or lies_on(output, relations)))
        if any(Role.WHEEL in survey.parts[o].roles for o in self._outputs):
            # What is on the axle of a hub motor holds it.
            sides = [replace(side, on_output=self._is_on_anchor(side), is_seat=True) for side in sides]
        if any(self._is_on_anchor(side) for side in sides):
            # The output is drawn: what is on a wider face of the case about its axis, such as a saddle, holds the case.
            across = perpendicular_frame(output.axis.d)[:, 0]
            most = max(0.5 * float(np.ptp(survey.scene.span(o, across))) for o in self._anchors)
            sides = [
                replace(side, on_output=False, is_seat=True)
                if side.on_output and not self._is_on_anchor(side) and self._width(side) > most
                else side
                for side in sides
            ]
        some = {side.part for side in sides if side.on_output}
        level = {side.part for side in sides if _is_level(output, side.relations) and side.whole.holes < 2} - some
        self._idlers = idlers(survey, output.axis, some, level)
        return [replace(side, on_output=True) if side.part in self._idlers else side for side in sides]

    def _width(self, side: _Side) -> float:
        """The largest radius [m] at which a part touches the motor about its output."""
        assert self._output is not None
        return max(side.whole.ring_radius, side.whole.radius, reach(self._output.axis, side.relations))

    def _is_on_anchor(self, side: _Side) -> bool:
        return any(r.other(side.part) in self._anchors for r in side.relations)

    def _split(self, driven: list[_Side]) -> tuple[list[_Side], list[_Side], float, str]:
        """For contacts that are all centred on the motor's axis: the part on the wider circle holds the motor.

        Returns the driven part, the holding part, the score of the joint, and what to review.
        """
        groups = self._groups(driven)
        own = {side.part for group in groups if any(map(self._is_on_anchor, group)) for side in group}
        on_case = len(own) < len(driven) and (own or self._outputs)
        if self._motor.is_named and on_case:  # what touches the case alone holds it, however narrow
            return [s for s in driven if s.part in own], [s for s in driven if s.part not in own], 0.83, ""
        if len(groups) < 2:
            outputs = self._outputs or list(self._idlers)
            score, review = alone(self._survey, self._motor, outputs, [side.whole for side in driven])
            return (driven if score else []), [], score, review
        widths = [max(map(self._width, group)) for group in groups]
        order = sorted(range(len(groups)), key=lambda n: (-round(widths[n], 5), groups[n][0].part))
        clear = _BOLTED if all(side.whole.ring for side in driven) else 0.83
        score = clear if widths[order[-1]] < _WIDER * widths[order[0]] else 0.65
        turning = [side for n in order[1:] for side in groups[n]]
        return turning, groups[order[0]], score, "" if score > 0.8 else "either side of the motor may be the fixed one"

    def _groups(self, sides: list[_Side]) -> list[list[_Side]]:
        """Sides in groups that touch each other or are in one subassembly."""
        tied = Clusters(side.part for side in sides)
        survey = self._survey
        for x in sides:
            for y in (y for y in sides if y.part > x.part):
                r = survey.relation(x.part, y.part)
                home = survey.scene.component(x.part).parent
                together = survey.sources.tree and 0 < home == survey.scene.component(y.part).parent
                together &= self._motor.case not in survey.assembly.subtree(home)  # which may list both sides
                if together or self._idlers or (r is not None and (r.is_rigid or r.patches)):
                    tied.join(x.part, y.part)
        side_of = {side.part: side for side in sides}
        return [[side_of[i] for i in members] for members in tied.groups().values()]

    def _idle(self, why: str) -> None:
        """A motor that is held and has a free output."""
        turning = [o for o in self._outputs if "IDLE" not in self._survey.parts[o].path.upper()]
        if not turning:
            return
        self._joint(turning[0], 0.62, why, "nothing is fastened to it")
        for o in self._outputs:
            if o != turning[0]:
                beside = self._survey.relation(turning[0], o) is not None
                why = "an idler that carries nothing" if not beside else "on the output"
                self._evidence.weld(0.5, turning[0] if beside else self._motor.case, o, why)

    def _drive(self, driven: list[_Side], score: float, why: str, review: str) -> None:
        """Parts that touch the output turn with it, and with the output's own part if there is one."""
        touched = {
            side.part: {self._anchors.get(i, i) for r in side.relations for i in [r.other(side.part)]}
            for side in driven
        }
        anchors = sorted({o for parts in touched.values() for o in parts if o in self._outputs})
        for side in driven:
            mine = sorted(touched[side.part].intersection(self._outputs))
            for o in mine:
                self._evidence.weld(0.94, o, side.part, f"fastened to the output of '{self._motor.path}'")
            if not mine:
                self._joint(side.part, score, why, review or through(self._survey, self._motor, side.whole))
                self._mount(side.part)
        for o in anchors:
            self._joint(o, score, why, review)
        for side in driven[1:] if not anchors and not self._outputs else ():
            if self._survey.relation(driven[0].part, side.part) is not None:
                self._evidence.weld(0.6, driven[0].part, side.part, f"both on the output of '{self._motor.path}'")
        for o in self._outputs:
            if o not in anchors:
                beside = any(r.other(o) in anchors for r in self._survey.near.get(o, ()))
                self._evidence.weld(
                    0.58, anchors[0] if beside else self._motor.case, o, "a horn or idler that carries nothing"
                )

    def _mount(self, shaft: int) -> None:
        """What is on a turned shaft that is no part of the motor, such as a horn on its spline, is fixed to it."""
        assert self._output is not None
        survey, case = self._survey, self._motor.case
        small = survey.parts[shaft].volume < _SHAFT * survey.parts[case].volume
        if not small or not survey.parts[shaft].is_balanced(self._output.axis):
            return
        for other, r in survey.around(shaft):
            about = r.turns is not None and r.turns.same(self._output.axis, SAME_AXIS)
            if about and other not in self._motor.parts and survey.relation(case, other) is None:
                self._evidence.weld(0.9, shaft, other, f"on the shaft of '{self._motor.path}'")

    def _joint(self, part: int, score: float, why: str, review: str) -> None:
        assert self._output is not None
        motor = self._motor.path if self._motor.is_named else ""
        self._evidence.joint(
            JointEvidence(
                *(score, self._motor.case, part, JointKind.REVOLUTE, self._output.axis, why),
                drives=True,
                motor=motor,
                review=review,
            )
        )
