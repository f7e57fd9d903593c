"""Verification summary: one line per file, with the engines and the worst deviation."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .diagnostic_text import printable
from .table import RESULT, absent_engines, driven_words, filled, status_lines
from .terminal import screen_width, wants_color, write_result

if TYPE_CHECKING:
    from stepbot.report.results import Check, Results, Row

_HEADINGS = ("format", "file", RESULT, "engines", "worst deviation")
_ROBOT = "robot"
"""Label of checks that do not belong to a file."""


def show_proof(report: "Results") -> None:
    """Print for each file its engines, the result and the worst deviation, then the counts."""
    width = screen_width(sys.stdout)
    lines = proof_lines(report, width, color=wants_color(sys.stdout))
    write_result("\n".join(lines))


def proof_lines(report: "Results", width: int | None, *, color: bool = False) -> list[str]:
    """The summary as lines no wider than ``width``; None for unlimited."""
    by_file: dict[str, list[Row]] = {}
    for row in report.rows():
        by_file.setdefault(row.file, []).append(row)
    texts = [_cells(rows) for rows in by_file.values()]
    lines = status_lines([_HEADINGS, *texts], [cells[2] for cells in texts], width, color)
    for text in (driven_words(report), _counts(report)):
        lines += filled(text, width) if text else []
    return lines


def _cells(rows: Sequence["Row"]) -> tuple[str, ...]:
    """The line of one file."""
    statuses = [row.status.value for row in rows]
    result = next(status for status in ("failed", "passed", "not run") if status in statuses)
    engines = [name for row in rows if row.compared for name in row.engine.split(", ")]
    measured = [row.worst for row in rows if row.worst is not None and row.status.value == result]
    return (
        rows[0].format,
        printable(rows[0].file) or _ROBOT,
        result,
        ", ".join(dict.fromkeys(engines)) or "-",
        _deviation(max(measured, key=lambda check: check.ratio, default=None)),
    )


def _deviation(check: "Check | None") -> str:
    """The deviation that is largest relative to its tolerance, and that tolerance."""
    if check is None or check.deviation is None:
        return "-"
    unit = f" {check.unit}" if check.unit else ""
    return f"{check.quantity}: {check.deviation:.1e} of {check.tolerance:.0e}{unit}"


def _counts(report: "Results") -> str:
    """The number of checks that passed, failed and did not run, and of those confirmed by own parsers only."""
    statuses = [check.status.value for check in report.checks]
    own = len(report.read_back)
    passed = f"{statuses.count('passed')} passed" + (f" ({own} by stepbot's parsers only)" if own else "")
    absent = absent_engines(report)
    missing = f"; not installed: {', '.join(absent)}" if absent else ""
    failed, not_run = statuses.count("failed"), statuses.count("not run")
    return f"{len(statuses)} checks: {passed}, {failed} failed, {not_run} not run (-v for reasons){missing}"
