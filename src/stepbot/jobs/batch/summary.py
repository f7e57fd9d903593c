"""Results of a batch, for programs: JSON, and suites for JUnit."""

import json
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from stepbot.formats import FORMATS
from stepbot.pipeline.conversion import REPORT, REPORT_PAGE
from stepbot.report.document import Suite
from stepbot.report.plain import Json
from stepbot.runtime.file import is_file, read_regular, replace_file
from stepbot.runtime.output import failed_output
from stepbot.viewing.report.page import Entry, index_page

from .runs import Outcome, Status


def _folder(outcome: Outcome) -> Path | None:
    """Where the files of this run are; None if a failed robot has none: those there are from an earlier run."""
    if outcome.status is not Status.FAILED:
        return outcome.task.output
    return failed_output(outcome.task.output) if outcome.files else None


def _report(outcome: Outcome) -> Json:
    """A robot's report; empty without a readable one."""
    folder = _folder(outcome)
    try:
        report: Json = {} if folder is None else json.loads(read_regular(folder / REPORT))
    except (OSError, ValueError):
        return {}
    return report


def checks_of(outcome: Outcome) -> list[Mapping[str, Any]]:
    """The checks in a robot's report; none without a report."""
    return list(_report(outcome).get("checks", ()))


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


INDEX = "index.html"


def write_index(folder: Path, outcomes: Sequence[Outcome]) -> None:
    """Write the page of the batch; raises OSError if that is impossible."""
    folder.mkdir(parents=True, exist_ok=True)
    replace_file(folder / INDEX, index_page([_entry(folder, outcome) for outcome in outcomes]))


def write_variant_sets(folder: Path, outcomes: Sequence[Outcome]) -> None:
    """Write an OpenUSD file for each sidecar with variants: a variant set `configuration` of references to its robots.

    Args:
        folder: The output folder of the batch.

    Raises:
        OSError: One cannot be written.
    """
    robots = dict[Path, dict[str, str]]()
    named: dict[Path, str] = {}
    for outcome in outcomes:
        task = outcome.task
        if not task.variant:
            named[task.sidecar] = task.name
        usd = None if outcome.status is Status.FAILED else _usd(task.output)
        if usd is not None:
            place = Path(os.path.relpath(usd, folder)).as_posix()
            robots.setdefault(task.sidecar, {})[task.variant] = place
    for sidecar, by_variant in robots.items():
        if any(by_variant):
            asset = import_module(f"{FORMATS['usd'].package}.asset")  # nothing else imports OpenUSD's rooms
            replace_file(folder / f"{named[sidecar]}.usda", asset.configurations(named[sidecar], by_variant))


def _usd(output: Path) -> Path | None:
    """The OpenUSD file of a converted robot in its output folder; None if it has none."""
    files = json.loads(read_regular(output / REPORT))["files"]
    return next(
        (output / file["path"] for file in files if (file["format"], file["content"]) == ("usd", "robot")), None
    )


def _entry(folder: Path, outcome: Outcome) -> Entry:
    place = _folder(outcome)
    has_page = place is not None and is_file(place / REPORT_PAGE)
    page = (place / REPORT_PAGE).relative_to(folder).as_posix() if place is not None and has_page else ""
    robot = _report(outcome).get("robot")
    checks = check_counts(outcome)
    return Entry(
        outcome.task.name,
        outcome.status.value,
        page,
        checks["passed"],
        checks["failed"],
        checks["not_run"],
        len(robot["links"]) if robot else None,
        len(robot["joints"]) if robot else None,
        robot["mass"] if robot else None,
        tuple(diagnostic.message for diagnostic in outcome.diagnostics if diagnostic.severity == "error"),
        sum(diagnostic.severity == "warning" for diagnostic in outcome.diagnostics),
    )
