"""Drive tests as JSON data."""

from typing import Any

from .driving import Driven
from .judgement import Verdict
from .limits import UNITS
from .results import Measure
from .survey import SweptRange

_DIGITS = 4
"""Significant digits of a number in a file: it is the same bytes with every build of an engine's release."""


def driven_document(driven: Driven) -> dict[str, Any]:
    """The verdicts, the tests that do not apply, the engines that did not run, and the ranges that sweeps cover.

    The steps per second differ from run to run.
    """
    return {
        "robot": driven.robot,
        "tests": [_verdict(verdict) for verdict in driven.verdicts],
        "inapplicable": dict(driven.inapplicable),
        "not_run": dict(driven.not_run),
        "ranges": [_range(one) for one in driven.ranges],
    }


def _range(swept: SweptRange) -> dict[str, Any]:
    """What the sweep of a joint covers, in [rad] or [m]."""
    return {
        "joint": swept.joint,
        "unit": "rad" if swept.angular else "m",
        "swept": [_rounded(one) for one in swept.swept],
        "limits": list(swept.limits),
        "stops": list(swept.stops),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _verdict(verdict: Verdict) -> dict[str, Any]:
    bounds = verdict.bounds or {}
    return {
        "test": verdict.test,
        "engine": verdict.engine,
        "status": verdict.status.value,
        "why": verdict.why,
        "measures": [
            _measure(measure, bounds.get(measure.quantity))
            for measure in (verdict.result.measures if verdict.result else ())
        ],
        "steps_per_second": round(verdict.result.steps_per_second) if verdict.result else None,
    }


def _measure(measure: Measure, limit: float | None) -> dict[str, Any]:
    return {
        "quantity": measure.quantity,
        "value": _rounded(measure.value),
        "unit": UNITS[measure.quantity],
        "where": measure.where,
        "limit": limit,
    }
