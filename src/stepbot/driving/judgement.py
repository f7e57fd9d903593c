"""Compares the numbers of drive tests with their limits."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from stepbot.diagnostics import Diagnostics, Span

from .limits import UNITS, Demands
from .results import Measure, Result

_REMEDIES = {
    "overshoot": "raise kv, lower kp, or let stepbot compute both: `gains: auto`",
    "angle error": "raise kp, or the joint's effort limit if the motor is at it",
    "travel error": "raise kp, or the joint's effort limit if the motor is at it",
    "angle drift": "raise kv, or lower kp: the joint does not come to rest",
    "travel drift": "raise kv, or lower kp: the joint does not come to rest",
    "loop opening": "lower the efforts, or shorten the time step in the sidecar: `simulation: {timestep: 0.5 ms}`",
    "energy gain": "shorten the time step, or look for tiny masses and inertias behind large ones",
    "slip": "raise kp of the gripper's actuator: it decides the gripping force; give hollow jaws `collision: auto`",
    "penetration": "give the colliding links collision shapes with faces, not edges",
    "tilt": "lower the centre of mass, or move the wheels or casters apart",
    "tilt at rest": "check the home pose: all feet are to be on the floor",
    "sinking": "raise kp of the legs' actuators",
    "tilt after push": "raise kp and kv of the legs' actuators, or spread the legs in the home pose",
}
_REMEDY = "see the test in docs/drive.md; draw its curves with --plots"


class Status(StrEnum):
    """The outcome of one test in one engine."""

    PASSED = "passed"
    FAILED = "failed"


@dataclass(frozen=True)
class Verdict:
    """One test in one engine, judged."""

    engine: str
    test: str
    status: Status
    why: str = ""
    """Why it did not run."""
    result: Result | None = None
    bounds: Mapping[str, float] | None = None
    """Limit of each quantity that has one."""

    @property
    def worst(self) -> Measure | None:
        """The measure that is nearest to its limit, or farthest beyond."""
        bounds = self.bounds or {}
        limited = [one for one in (self.result.measures if self.result else ()) if one.quantity in bounds]
        return max(
            limited,
            key=lambda one: one.value / bounds[one.quantity] if bounds[one.quantity] else one.value,
            default=None,
        )


def judge(
    engine: str, file: str, results: Iterable[Result | str], demands: Demands, found: Diagnostics
) -> Iterator[Verdict]:
    """The verdict on each result.

    Args:
        engine: Name of the engine.
        file: The file that it drove, for diagnostics.
        results: Results, or names of tests in which the simulation diverged.
        demands: The limits.
        found: Receives SB830 and SB831.
    """
    span = Span(file)
    for result in results:
        if isinstance(result, str):
            found.add("SB831", f"{result} in {engine}: the simulation diverged", span)
            yield Verdict(engine, result, Status.FAILED, why="diverged")
            continue
        bounds = demands.limits[result.test]
        failed = [
            one for one in result.measures if one.quantity in bounds and not one.value <= bounds[one.quantity].value
        ]
        for one in failed:
            bound, unit = bounds[one.quantity], UNITS[one.quantity]
            place = f" of '{one.where}'" if one.where else ""
            numbers = f"{one.value:.3g} {unit}, limit {bound.value:g} {unit}"
            found.add(
                "SB830",
                f"{result.test} in {engine}: {one.quantity}{place} is {numbers}",
                span,
                help=(_REMEDIES.get(one.quantity, _REMEDY),),
                notes=(f"the limit: {bound.why}",),
            )
        status = Status.FAILED if failed else Status.PASSED
        yield Verdict(engine, result.test, status, "", result, {name: bound.value for name, bound in bounds.items()})
