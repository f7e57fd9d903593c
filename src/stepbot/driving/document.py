"""Drive tests as JSON data."""

from typing import Any

from .driving import Driven
from .judgement import Verdict
from .limits import UNITS
from .results import Measure

_DIGITS = 4
"""Significant digits of a number in a file: it is the same bytes with every build of an engine's release."""


def driven_document(driven: Driven, *, timed: bool = False) -> dict[str, Any]:
    """The verdicts, the tests that do not apply, and the engines that did not run.

    Args:
        driven: The tests of a robot.
        timed: Whether to add the steps per second, which differ from run to run.
    """
    return {
        "robot": driven.robot,
        "tests": [_verdict(verdict, timed) for verdict in driven.verdicts],
        "inapplicable": dict(driven.inapplicable),
        "not_run": dict(driven.not_run),
    }


def _verdict(verdict: Verdict, timed: bool) -> dict[str, Any]:
    bounds = verdict.bounds or {}
    document: dict[str, Any] = {
        "test": verdict.test,
        "engine": verdict.engine,
        "status": verdict.status.value,
        "why": verdict.why,
        "measures": [
            _measure(one, bounds.get(one.quantity)) for one in (verdict.result.measures if verdict.result else ())
        ],
    }
    if timed:
        document["steps_per_second"] = round(verdict.result.steps_per_second) if verdict.result else None
    return document


def _measure(measure: Measure, limit: float | None) -> dict[str, Any]:
    return {
        "quantity": measure.quantity,
        "value": float(f"{measure.value:.{_DIGITS}g}"),
        "unit": UNITS[measure.quantity],
        "where": measure.where,
        "limit": limit,
    }
