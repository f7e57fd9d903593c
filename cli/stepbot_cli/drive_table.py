"""Drive tests as a table: one line per test and engine."""

import sys
from typing import TYPE_CHECKING, Any

from .counts import counted
from .diagnostic_text import printable
from .table import filled, status_lines
from .terminal import wants_color

if TYPE_CHECKING:
    from stepbot.driving.driving import Driven
    from stepbot.driving.judgement import Verdict
    from stepbot.driving.results import Measure

_HEADINGS = ("test", "engine", "result", "worst", "steps/s")


def driven_lines(driven: "Driven", width: int | None, *, verbose: bool = False) -> list[str]:
    """The verdicts as a table, then the tests that do not apply, then the counts."""
    texts = [_HEADINGS, *(_cells(verdict) for verdict in driven.verdicts)]
    lines = status_lines(texts, [v.status.value for v in driven.verdicts], width, wants_color(sys.stdout))
    if verbose:
        for verdict in driven.verdicts:
            lines += filled(f"{verdict.test} in {verdict.engine}: {', '.join(_numbers(verdict))}", width)
    for test, reason in driven.inapplicable.items():
        lines += filled(f"{test} does not apply: {printable(reason)}", width)
    statuses = [verdict.status.value for verdict in driven.verdicts]
    return [
        *lines,
        f"{counted(len(statuses), 'test')}: {statuses.count('passed')} passed, {statuses.count('failed')} failed",
    ]


def _cells(verdict: "Verdict") -> tuple[str, ...]:
    speed = f"{verdict.result.steps_per_second:,.0f}" if verdict.result else "-"
    worst = verdict.worst
    if worst is None or verdict.bounds is None:
        text = verdict.why or "-"
    else:
        text = f"{_number(worst)}, limit {verdict.bounds[worst.quantity]:g}"
    return verdict.test, verdict.engine, verdict.status.value, text, speed


def _number(measure: "Measure") -> str:
    from stepbot.driving.limits import UNITS

    place = f" of {printable(measure.where)}" if measure.where else ""
    return f"{measure.quantity}{place} {measure.value:.3g} {UNITS[measure.quantity]}"


def _numbers(verdict: "Verdict") -> list[str]:
    return [_number(measure) for measure in verdict.result.measures] if verdict.result else [verdict.why]


def driven_json(driven: "Driven") -> dict[str, Any]:
    """The output of ``--json``, with the speeds."""
    from stepbot.driving.document import driven_document

    return driven_document(driven, timed=True)
