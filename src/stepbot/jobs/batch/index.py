"""The page of a batch, ``index.html``: every robot with a link to its report."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stepbot.pipeline.conversion import REPORT, REPORT_PAGE
from stepbot.runtime.file import is_file, read_regular
from stepbot.runtime.output import failed_output
from stepbot.viewing.report.index import Entry, index_page

from .runs import Outcome, Status
from .summary import check_counts

INDEX = "index.html"


def write_index(folder: Path, outcomes: Sequence[Outcome]) -> None:
    """Write the page.

    Args:
        folder: The output folder of the batch.
        outcomes: The robots.

    Raises:
        OSError: It cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / INDEX).write_bytes(index_page([_entry(folder, outcome) for outcome in outcomes]))


def _entry(folder: Path, outcome: Outcome) -> Entry:
    has_failed = outcome.status is Status.FAILED
    place = failed_output(outcome.task.output) if has_failed else outcome.task.output
    is_current = not has_failed or bool(outcome.files)  # otherwise the files are from an earlier run
    page = (place / REPORT_PAGE).relative_to(folder).as_posix() if is_current and is_file(place / REPORT_PAGE) else ""
    robot = _robot(place / REPORT) if is_current else {}
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
        tuple(one.message for one in outcome.diagnostics if one.severity == "error"),
        sum(one.severity == "warning" for one in outcome.diagnostics),
    )


def _robot(report: Path) -> dict[str, Any]:
    """The robot in a report; empty without a readable one."""
    try:
        robot: dict[str, Any] = json.loads(read_regular(report))["robot"]
    except (OSError, ValueError, KeyError):
        return {}
    return robot
