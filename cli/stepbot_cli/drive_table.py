"""Drive tests as a table: one line per test and engine."""

import sys
from math import degrees
from typing import TYPE_CHECKING, Any

from stepbot_cli.diagnostic_text import counted

from .diagnostic_text import printable
from .table import filled, status_lines
from .terminal import wants_color

if TYPE_CHECKING:
    from stepbot.driving.driving import Driven
    from stepbot.driving.judgement import Verdict
    from stepbot.driving.results import Measure
    from stepbot.driving.survey import SweptRange

_ALL = 0.995
"""Share of a range from which it counts as covered."""
_HEADINGS = ("test", "engine", "result", "steps/s", "worst")


def driven_lines(driven: "Driven", width: int | None, *, verbose: bool = False) -> list[str]:
    """The counts, the verdicts as a table, the tests that do not apply, and the engines that did not run."""
    speeds = [_speed(verdict) for verdict in driven.verdicts]
    digits = max(map(len, (*speeds, _HEADINGS[3])))
    texts = [_HEADINGS, *(_cells(*one) for one in zip(driven.verdicts, (s.rjust(digits) for s in speeds), strict=True))]
    statuses = [verdict.status.value for verdict in driven.verdicts]
    counts = f"{counted(len(statuses), 'test')}: {statuses.count('passed')} passed, {statuses.count('failed')} failed"
    absent = f"; not run in {' and '.join(driven.not_run)}" if driven.not_run else ""
    lines = [f"driven: {counts}{absent}"]
    lines += status_lines(texts, statuses, width, wants_color(sys.stdout))
    if verbose:
        for verdict in driven.verdicts:
            lines += filled(f"{verdict.test} in {verdict.engine}: {', '.join(_numbers(verdict))}", width)
    for test, reason in driven.inapplicable.items():
        lines += filled(f"{test} does not apply: {printable(reason)}", width)
    for one in driven.ranges:
        if one.share < _ALL:
            lines += filled(f"sweep covers {_covered(one)}", width)
    for engine, reason in driven.not_run.items():
        lines += filled(f"not run in {engine}: {printable(reason)}", width)
    return lines


def _covered(one: "SweptRange") -> str:
    """What a sweep covers, in degrees or millimetres, and what stops it."""
    factor, unit = (degrees(1.0), "deg") if one.angular else (1e3, "mm")
    swept, limits = (f"{factor * ends[0]:.4g} to {factor * ends[1]:.4g} {unit}" for ends in (one.swept, one.limits))
    stops = " and ".join(f"{way} by {stop}" for way, stop in zip(("below", "above"), one.stops, strict=True) if stop)
    return printable(f"{100.0 * one.share:.0f} % of the range of {one.joint}: {swept} of {limits}; stopped {stops}")


def _speed(verdict: "Verdict") -> str:
    return f"{verdict.result.steps_per_second:,.0f}" if verdict.result else "-"


def _cells(verdict: "Verdict", speed: str) -> tuple[str, ...]:
    worst = verdict.worst
    if verdict.why or worst is None or verdict.bounds is None:
        text = printable(verdict.why) or "-"
    else:
        text = f"{_number(worst)}, limit {_value(verdict.bounds[worst.quantity], worst.quantity)}"
    return verdict.test, verdict.engine, verdict.status.value, speed, text


def _number(measure: "Measure") -> str:
    place = f" of {printable(measure.where)}" if measure.where else ""
    return f"{measure.quantity}{place} {_value(measure.value, measure.quantity)}"


def _value(value: float, quantity: str) -> str:
    """A number with the unit of its quantity."""
    from stepbot.driving.limits import UNITS

    return f"{value:.3g} {UNITS[quantity]}".rstrip()


def _numbers(verdict: "Verdict") -> list[str]:
    return [_number(measure) for measure in verdict.result.measures] if verdict.result else [verdict.why]


def driven_json(driven: "Driven") -> dict[str, Any]:
    """The output of ``--json``, with the speeds."""
    from stepbot.driving.document import driven_document

    return driven_document(driven, timed=True)
