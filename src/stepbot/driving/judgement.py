"""Compares the numbers of drive tests with their limits."""

from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, Span

from .limits import UNITS, Bound, Demands
from .plan import SURVEYOR
from .remedies import Facts, fate, grip_remedies, overlap_words, remedy, spin_words
from .results import Measure, Result

_WAYS = ("distance error", "turn error")
"""What the wheels of a base decide."""


class Status(StrEnum):
    """The outcome of one test in one engine."""

    PASSED = "passed"
    FAILED = "failed"


class Verdict(Struct, frozen=True):
    """One test in one engine, judged."""

    engine: str
    test: str
    status: Status
    why: str = ""
    """Why there are no numbers, or how a cube was lost."""
    result: Result | None = None
    bounds: Mapping[str, float] | None = None
    """Limit of each quantity that has one."""

    @property
    def worst(self) -> Measure | None:
        """The measure that is nearest to its limit, or farthest beyond."""
        bounds = self.bounds or {}
        limited = [measure for measure in (self.result.measures if self.result else ()) if measure.quantity in bounds]
        return max(
            limited,
            key=lambda one: one.value / bounds[one.quantity] if bounds[one.quantity] else one.value,
            default=None,
        )


def judge(
    engine: str,
    file: str,
    results: Iterable[Result | str],
    demands: Demands,
    diagnostics: Diagnostics,
    facts: Facts | None = None,
) -> Iterator[Verdict]:
    """The verdict on each result.

    Args:
        file: The file that it drove, for diagnostics.
        results: Results, or names of tests in which the simulation diverged.
        diagnostics: Receives SB830.
        facts: What the robot's report states about remedies.
    """
    span = Span(file)
    overlaps = overlap_words(facts.overlaps) if facts and facts.overlaps and engine == SURVEYOR else ()
    cause, likely = overlaps[:1], overlaps[1:]  # stated once, with the first failure
    for result in results:
        if isinstance(result, str):
            message = f"{result} in {engine}: the simulation diverged"
            diagnostics.add("SB830", message, span, help=likely, notes=cause)
            cause = likely = ()
            yield Verdict(engine, result, Status.FAILED, why="diverged")
            continue
        bounds = demands.limits[result.test]
        failed = [
            measure
            for measure in result.measures
            if measure.quantity in bounds and not measure.value <= bounds[measure.quantity].value
        ]
        lost = ""
        for one in failed:
            bound = bounds[one.quantity]
            if one.quantity == "slip" and result.grips:
                lost = _judge_grips(engine, span, result, bound, facts or Facts(), diagnostics)
                continue
            message = f"{result.test} in {engine}: {_excess(one, bound)}"
            notes: tuple[str, ...] = (f"the limit: {bound.why}",)
            help = remedy(one.quantity, one.where, facts or Facts())
            if result.spin is not None and one.quantity in _WAYS:
                why, help = spin_words(result.spin, gains=engine == SURVEYOR)
                notes = (why, *notes)
            diagnostics.add("SB830", message, span, help=(*likely, help), notes=(*cause, *notes))
            cause = likely = ()
        status = Status.FAILED if failed else Status.PASSED
        yield Verdict(engine, result.test, status, lost, result, {name: bound.value for name, bound in bounds.items()})


def unmeasured(demands: Demands, verdicts: Iterable[Verdict]) -> dict[str, str]:
    """The robot's own limits that were compared with nothing, each with the reason: no engine measured the quantity."""
    measured: dict[str, set[str]] = {}
    for verdict in verdicts:
        if verdict.result is not None:
            measured.setdefault(verdict.test, set()).update(measure.quantity for measure in verdict.result.measures)
    return {
        f"limit of {quantity} in {test}": f"measured: {', '.join(sorted(measured[test]))}"
        for test, quantity in demands.stated
        if test in measured and quantity not in measured[test]
    }


def _excess(measure: Measure, bound: Bound) -> str:
    """A number beyond its limit."""
    unit = UNITS[measure.quantity]
    place = f" of '{measure.where}'" if measure.where else ""
    return f"{measure.quantity}{place} is {measure.value:.3g} {unit}, limit {bound.value:g} {unit}"


def _judge_grips(engine: str, span: Span, result: Result, bound: Bound, facts: Facts, diagnostics: Diagnostics) -> str:
    """Report each gripper in which the cube slips (SB830); returns how cubes were lost."""
    fates = []
    for grip in result.grips:
        if grip.slip <= bound.value:
            continue
        lost = grip.loss is not None
        if lost:
            fates.append(fate(grip))
        what = fates[-1] if lost else _excess(Measure("slip", grip.slip, f"{grip.joint}, {grip.cube}"), bound)
        notes = () if lost else (f"the limit: {bound.why}",)
        diagnostics.add(
            "SB830",
            f"{result.test} in {engine}: {what}",
            span,
            help=tuple(grip_remedies(grip, facts, gains=engine == SURVEYOR)),
            notes=notes,
        )
    return "; ".join(fates)
