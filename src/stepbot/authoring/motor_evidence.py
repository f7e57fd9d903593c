"""Evidence from motors: parts that touch only a motor's output turn with it; all others hold the motor."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from stepbot.robot.model import JointKind

from .clusters import Clusters
from .evidence import Evidence, Hinge
from .motor_axes import SAME_AXIS, Output, OutputAxes, hidden_outputs, lies_on
from .motors import Motor
from .relations import Relation, merged, reach
from .survey import Survey

_BRUSH_AREA = 5e-6
"""Contact [m^2] below which a part that shares fewer than two holes with a motor is not fastened to it."""
_WIDER = 0.8
"""Ratio of the radii of a motor's two sides, below which the side that holds it is unambiguous."""


@dataclass(frozen=True, eq=False)
class _Side:
    """A part that touches a motor."""

    part: int
    relations: tuple[Relation, ...]
    whole: Relation
    on_output: bool

    @property
    def is_held(self) -> bool:
        """Whether the contact is more than incidental."""
        return self.whole.holes >= 2 or self.whole.area > _BRUSH_AREA or self.whole.freedom.dof <= 1


def motor_evidence(survey: Survey, motors: Sequence[Motor], found: Evidence) -> None:
    """Add the evidence of all motors."""
    axes = OutputAxes(survey, motors)
    for motor in motors:
        _OneMotor(survey, motor, axes, found).say()


class _OneMotor:
    def __init__(self, survey: Survey, motor: Motor, axes: OutputAxes, found: Evidence) -> None:
        self._survey, self._motor, self._found = survey, motor, found
        named = [i for i in motor.outputs if i not in survey.small]
        self._outputs = list(dict.fromkeys([*named, *hidden_outputs(survey, motor)]))
        self._output = axes.of(motor, self._outputs)

    def say(self) -> None:
        """Add the evidence of this motor."""
        motor, survey = self._motor, self._survey
        for i in motor.parts:
            if i != motor.case and i not in self._outputs and i not in survey.small:
                self._found.weld(0.96, motor.case, i, f"parts of the motor '{motor.path}'")
        if self._output is None:
            return
        sides = self._sides(self._output)
        driven = [side for side in sides if side.on_output]
        carrying = [side for side in sides if not side.on_output and side.is_held]
        score, why, review = 0.95, f"output of the motor '{motor.path}'", ""
        if not carrying:
            driven, carrying, score, review = self._split(driven)
        for side in carrying:
            self._found.weld(0.94, motor.case, side.part, f"carries the motor '{motor.path}'", holds_motor=True)
        if not driven:
            if carrying and self._outputs:
                self._idle(why)
            return
        if not motor.is_named:
            why, review = f"used like the output of a motor, '{motor.path}'", "not named as a motor"
        self._drive(driven, score, why, review)

    def _sides(self, output: Output) -> list[_Side]:
        outside: dict[int, list[Relation]] = defaultdict(list)
        for i in self._motor.parts:
            for other, r in self._survey.around(i):
                if other not in self._motor.parts:
                    outside[other].append(r)
        sides = []
        for part, relations in sorted(outside.items()):
            touched = {r.other(part) for r in relations}
            whole = merged(relations, (relations[0].a, relations[0].b), [output.axis])
            about = whole.turns is not None and whole.turns.same(output.axis, SAME_AXIS)
            by_name = bool(self._outputs) and touched <= set(self._outputs)
            sides.append(_Side(part, tuple(relations), whole, by_name or about or lies_on(output, relations)))
        return sides

    def _split(self, driven: list[_Side]) -> tuple[list[_Side], list[_Side], float, str]:
        """For contacts that are all centred on the motor's axis: the part on the wider circle holds the motor.

        Returns the driven part, the holding part, the score of the joint, and what to review.
        """
        groups = self._groups(driven)
        if len(groups) < 2:
            # Only its own output and one neighbour: the case stands alone.
            return (driven, [], 0.85, "") if self._outputs else ([], [], 0.0, "")
        assert self._output is not None
        widths = [
            max(
                max(side.whole.ring_radius, side.whole.radius, reach(self._output.axis, side.relations))
                for side in group
            )
            for group in groups
        ]
        order = sorted(range(len(groups)), key=lambda n: (-round(widths[n], 5), groups[n][0].part))
        score = 0.83 if widths[order[-1]] < _WIDER * widths[order[0]] else 0.65
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
                if together or (r is not None and (r.is_rigid or r.patches)):
                    tied.join(x.part, y.part)
        by_root: dict[int, list[_Side]] = defaultdict(list)
        for side in sides:
            by_root[tied.find(side.part)].append(side)
        return [by_root[root] for root in sorted(by_root)]

    def _idle(self, why: str) -> None:
        """A motor that is held and has a free output."""
        turning = [o for o in self._outputs if "IDLE" not in self._survey.parts[o].path.upper()]
        if not turning:
            return
        self._hinge(turning[0], 0.62, why, "nothing is fastened to it")
        for o in self._outputs:
            if o != turning[0]:
                self._found.weld(0.5, self._motor.case, o, "an idler that carries nothing")

    def _drive(self, driven: list[_Side], score: float, why: str, review: str) -> None:
        """Parts that touch the output turn with it, and with the output's own part if there is one."""
        touched = {side.part: {r.other(side.part) for r in side.relations} for side in driven}
        anchors = sorted({o for parts in touched.values() for o in parts if o in self._outputs})
        for side in driven:
            mine = sorted(touched[side.part].intersection(self._outputs))
            for o in mine:
                self._found.weld(0.94, o, side.part, f"fastened to the output of '{self._motor.path}'")
            if not mine:
                self._hinge(side.part, score, why, review)
        for o in anchors:
            self._hinge(o, score, why, review)
        if not anchors and not self._outputs:
            for side in driven[1:]:
                if self._survey.relation(driven[0].part, side.part) is not None:
                    self._found.weld(0.6, driven[0].part, side.part, f"both on the output of '{self._motor.path}'")
        for o in self._outputs:
            if o not in anchors:
                beside = any(r.other(o) in anchors for r in self._survey.near.get(o, ()))
                self._found.weld(
                    0.58, anchors[0] if beside else self._motor.case, o, "a horn or idler that carries nothing"
                )

    def _hinge(self, part: int, score: float, why: str, review: str) -> None:
        assert self._output is not None
        case = self._motor.case
        motor = self._motor.path if self._motor.is_named else ""
        self._found.hinge(
            Hinge(
                *(score, case, part, JointKind.REVOLUTE, self._output.axis, why),
                drives=True,
                motor=motor,
                review=review,
            )
        )
