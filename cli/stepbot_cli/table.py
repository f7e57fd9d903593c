"""Tables: verification results, one line per file and engine; joints, with their position and its evidence."""

import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from .columns import wrapped_rows
from .diagnostic_text import FRAME_WIDTH, paint, printable
from .terminal import screen_width, wants_color, write_result

if TYPE_CHECKING:
    from stepbot.report.results import Check, Results, Row
    from stepbot.robot.joint_table import JointRow

RESULT = "result"
"""Heading of the column with the result."""
_HEADINGS = ("format", "file", "engine", "compared with", RESULT, "quantities", "worst deviation")
_MODEL = "model"
STATUS_COLORS = {"passed": "32", "failed": "1;31", "not run": "33"}


def show_table(report: "Results") -> None:
    """Print the compared quantities, the worst deviation and the result for each file and engine, then the reasons."""
    from stepbot.engines import optional_engines
    from stepbot.report.words import absent_engines, is_absent

    color = wants_color(sys.stdout)
    width = screen_width(sys.stdout)
    optional = optional_engines()
    absent = absent_engines(report, optional)
    shown = [row for row in report.rows() if not is_absent(row, optional)]
    lines = [*_table(shown, width, color), *_remarks(report, shown, width or FRAME_WIDTH)]
    if absent:
        lines.insert(-1, f"not installed: {', '.join(absent)}")
    write_result("\n".join(lines))


def _table(rows: Sequence["Row"], width: int | None, color: bool) -> list[str]:
    texts = [_HEADINGS, *map(_cells, rows)]
    if all(row.against == _MODEL for row in rows):  # then the name is omitted
        texts = [(*cells[:3], *cells[4:]) for cells in texts]
    return status_lines(texts, [row.status.value for row in rows], width, color)


def status_lines(
    texts: Sequence[Sequence[str]],
    statuses: Sequence[str],
    width: int | None,
    color: bool,
    colors: Mapping[str, str] = STATUS_COLORS,
) -> list[str]:
    """A table as lines: the headings bold, each result in its colour.

    Args:
        texts: The headings, and the cells of each row.
        statuses: The result of each row, in the column of that heading.
    """
    result = texts[0].index(RESULT)
    head, *body = wrapped_rows(texts, width)
    lines = [paint("  ".join(cells).rstrip(), "1", color) for cells in head]
    for status, of_row in zip(statuses, body, strict=True):
        for cells in of_row:
            word = cells[result].rstrip()
            blanks = cells[result][len(word) :]
            cells[result] = paint(word, colors[status], color and bool(word)) + blanks
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


def _deviation(check: "Check | None") -> str:
    """The deviation that is largest relative to its tolerance, the tolerance, and the place."""
    if check is None or check.deviation is None:
        return "-"
    unit = f" {check.unit}" if check.unit else ""
    return f"{check.deviation:.1e}{unit}, tolerance {check.tolerance:.0e}: {printable(check.where)}"


def _remarks(report: "Results", rows: Sequence["Row"], width: int) -> list[str]:
    """Legend of the quantities, failed or omitted checks with reasons, and the count of all checks."""
    from stepbot.report.words import independent_joints

    quantities = list(dict.fromkeys(check.quantity for check in report.checks))
    lines = ["", *filled(f"quantities: {', '.join(quantities)}", width)]
    for row in rows:
        if row.why and row.compared:
            lines += filled(f"{printable(row.file) or 'robot'} in {row.engine}: {printable(row.why)}", width)
    if driven := independent_joints(report):
        lines += ["", *filled(printable(driven), width)]
    statuses = [check.status.value for check in report.checks]
    counts = ", ".join(f"{statuses.count(status)} {status}" for status in STATUS_COLORS)
    lines.append("")
    if report.read_back:
        own = f"{len(report.read_back)} passed by stepbot's parsers only, because no engine reports these quantities"
        lines += filled(own, width)
    return [*lines, *filled(f"{len(statuses)} checks: {counts}", width)]


def filled(text: str, width: int | None, indent: str = "") -> list[str]:
    """``text`` in lines of ``width`` columns, those after the first indented farther; None for one line."""
    if width is None:
        return [indent + text]
    import textwrap

    below = f"{indent}{_INDENT}"
    return textwrap.wrap(
        text, width, initial_indent=indent, subsequent_indent=below, break_long_words=False, break_on_hyphens=False
    )


def write_filled(*paragraphs: str) -> None:
    """Print paragraphs to standard output, as wide as the terminal."""
    width = screen_width(sys.stdout)
    write_result("\n".join(line for text in paragraphs for line in filled(printable(text), width)))


_NARROWEST = 60
_INDENT = "    "


def show_joint_rows(rows: Sequence["JointRow"]) -> None:
    """Print the joint table of these joints, as wide as the terminal; nothing without joints."""
    if rows:
        write_result("\n".join(joint_lines(rows, screen_width(sys.stdout) or FRAME_WIDTH)))


def joint_lines(rows: Sequence["JointRow"], width: int) -> list[str]:
    """The joint table as lines of at least 60 columns, with all evidence; only a longer word exceeds the width."""
    from stepbot.report.words import joint_table_title, joint_words, weak_joints

    width, lines = max(width, _NARROWEST), [joint_table_title(rows)]
    for row in rows:
        head, *details = map(printable, joint_words(row))
        lines += filled(head, width)
        for text in details:
            lines += filled(text, width, _INDENT)
    weak = weak_joints(rows)
    return lines + (filled(printable(weak), width) if weak else [])
