"""The proof as a table: one line per file and engine."""

import sys
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .columns import wrapped_rows
from .render import FRAME_WIDTH, paint, printable
from .terminal import screen_width, wants_color, write_result

if TYPE_CHECKING:
    from stepbot.report import Check, Report, Row

_RESULT = "result"
_HEADINGS = ("format", "file", "engine", "compared with", _RESULT, "quantities", "worst deviation")
_MODEL = "model"
_COLORS = {"passed": "32", "failed": "1;31", "not run": "33"}


def show_table(report: "Report") -> None:
    """Print what was compared, the worst deviation and the outcome for each file and engine, then the reasons."""
    color = wants_color(sys.stdout)
    width = screen_width(sys.stdout)
    absent = dict.fromkeys(row.engine for row in report.rows() if _is_absent(row))
    shown = [row for row in report.rows() if not _is_absent(row)]
    lines = [*_table(shown, width, color), *_remarks(report, shown, width or FRAME_WIDTH)]
    if absent:
        lines.insert(-1, f"not installed, so not run: {', '.join(absent)}")
    write_result("\n".join(lines))


def _is_absent(row: "Row") -> bool:
    """Whether an engine that most people do without said nothing of a file because it is not there."""
    from stepbot.simulators import optional_engines

    return not row.compared and row.engine in optional_engines() and row.why.endswith("is not installed")


def _table(rows: Sequence["Row"], width: int | None, color: bool) -> list[str]:
    texts = [_HEADINGS, *map(_cells, rows)]
    if all(row.against == _MODEL for row in rows):  # then it goes without saying
        texts = [_without_against(cells) for cells in texts]
    result = texts[0].index(_RESULT)
    head, *body = wrapped_rows(texts, width)
    lines = [paint("  ".join(cells).rstrip(), "1", color) for cells in head]
    for row, of_row in zip(rows, body, strict=True):
        for cells in of_row:
            word = cells[result].rstrip()
            cells[result] = paint(word, _COLORS[row.status.value], color and bool(word)) + cells[result][len(word) :]
            lines.append("  ".join(cells).rstrip())
    return lines


def _cells(row: "Row") -> tuple[str, ...]:
    return (
        row.format,
        printable(row.file) or "robot",
        row.engine,
        printable(row.against),
        row.status.value,
        str(len(row.compared)) if row.compared else "-",
        _deviation(row.worst) if row.compared else printable(row.why),
    )


def _without_against(cells: tuple[str, ...]) -> tuple[str, ...]:
    return (*cells[:3], *cells[4:])


def _deviation(check: "Check | None") -> str:
    """The deviation that came nearest to its tolerance, what is allowed, and where."""
    if check is None or check.deviation is None:
        return "-"
    unit = f" {check.unit}" if check.unit else ""
    return f"{check.deviation:.1e}{unit}, {check.tolerance:.0e} allowed: {printable(check.where)}"


def _remarks(report: "Report", rows: Sequence["Row"], width: int) -> list[str]:
    """What the quantities are, what failed or did not run and why, and the count of all checks."""
    quantities = list(dict.fromkeys(check.quantity for check in report.checks))
    lines = ["", *_wrapped(f"quantities: {', '.join(quantities)}", width)]
    for row in rows:
        if row.why and row.compared:
            lines += _wrapped(f"{printable(row.file) or 'robot'} in {row.engine}: {printable(row.why)}", width)
    if report.driven:
        several = "s" if report.degrees_of_freedom != 1 else ""
        driven = ", ".join(printable(name) for name in report.driven)
        lines += ["", *_wrapped(f"{report.degrees_of_freedom} degree{several} of freedom, driven by {driven}", width)]
    statuses = [check.status.value for check in report.checks]
    counts = ", ".join(f"{statuses.count(status)} {status}" for status in _COLORS)
    lines.append("")
    if report.read_back:
        own = f"{len(report.read_back)} passed by what stepbot's own parsers read back, since no engine tells of it"
        lines += _wrapped(own, width)
    return [*lines, *_wrapped(f"{len(statuses)} checks: {counts}", width)]


def _wrapped(text: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
