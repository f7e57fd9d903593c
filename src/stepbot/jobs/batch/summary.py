"""Results of a batch, for programs: JSON, and suites for JUnit."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from stepbot.pipeline.conversion import REPORT
from stepbot.report.junit import Suite
from stepbot.runtime.file import read_regular
from stepbot.runtime.output import failed_output

from .runs import Outcome, Status

Json = dict[str, Any]


def checks_of(outcome: Outcome) -> list[Mapping[str, Any]]:
    """The checks in a robot's report; none without a report."""
    output = outcome.task.output
    folder = failed_output(output) if outcome.status is Status.FAILED else output
    if outcome.status is Status.FAILED and not outcome.files:  # the existing report is from an earlier run
        return []
    try:
        checks: list[Mapping[str, Any]] = json.loads(read_regular(folder / REPORT))["checks"]
    except (OSError, ValueError, KeyError):
        return []
    return checks


def check_counts(outcome: Outcome) -> dict[str, int]:
    """Number of checks that passed, failed, did not run."""
    statuses = Counter(str(check["status"]) for check in checks_of(outcome))
    return {name.replace(" ", "_"): statuses[name] for name in ("passed", "failed", "not run")}


def batch_document(outcomes: Sequence[Outcome]) -> Json:
    """The batch as JSON data, without diagnostics, which the caller adds."""
    statuses = Counter(outcome.status for outcome in outcomes)
    return {
        "robots": [
            {
                "name": outcome.task.name,
                "sidecar": outcome.task.sidecar.as_posix(),
                "output": outcome.task.output.as_posix(),
                "status": outcome.status.value,
                "checks": check_counts(outcome),
                "seconds": round(outcome.seconds, 3),
                "diagnostics": outcome.diagnostics,
            }
            for outcome in outcomes
        ],
        "summary": {status.value: statuses[status] for status in Status},
    }


def suites(outcomes: Sequence[Outcome]) -> list[Suite]:
    """A suite per robot; an unchanged robot has the checks of its last conversion."""
    return [
        Suite(outcome.task.name, checks_of(outcome), tuple(outcome.diagnostics), outcome.seconds)
        for outcome in outcomes
    ]
