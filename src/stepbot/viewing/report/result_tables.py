"""What the engines confirmed, what was found, and what was read."""

from collections.abc import Iterable, Mapping

from stepbot.diagnostics import Diagnostic
from stepbot.diagnostics.codes import CODES
from stepbot.report.record import Check, Report, Row, Status

from .markup import Markup, element
from .numbers import cell, short
from .plot import deviations_plot
from .robot_tables import table

Places = Mapping[tuple[str, int], str]
"""Source lines by file and line number."""

_ORDER = (Status.FAILED, Status.PASSED, Status.NOT_RUN)
_SEVERITIES = ("error", "warning", "note")
_TONES = {Status.PASSED: "good", Status.FAILED: "bad", Status.NOT_RUN: "quiet"}


def proof_section(report: Report) -> Markup:
    """Every check, in a plot and in a table per file and engine."""
    if not report.checks:
        return element(
            "section",
            element("h2", "Verification"),
            element("p.warn", "The files were not verified."),
            id="proof-table",
        )
    rows = sorted(report.rows(), key=lambda row: _ORDER.index(row.status))
    groups = [_group(row, report) for row in rows if row.status is not Status.NOT_RUN]
    silent = [_group(row, report) for row in rows if row.status is Status.NOT_RUN]
    if silent:
        words = f"{len(silent)} combinations of file and engine without a result"
        groups.append(element("details.silent", element("summary", element("span.quiet", words)), silent))
    note = (
        "Each dot is a quantity of a file as one engine reports it, compared with the model. Dots left of the line are "
        "within their tolerance."
    )
    return element(
        "section",
        element("h2", "Verification"),
        element("p", _counts(report)),
        deviations_plot(report),
        element("p.quiet", note),
        groups,
        id="proof-table",
    )


def _counts(report: Report) -> list[Markup | str]:
    statuses = [check.status for check in report.checks]
    parts: list[Markup | str] = [f"{len(statuses)} checks: "]
    for status in Status:
        count = statuses.count(status)
        parts += [element(f"b.{_TONES[status] if count else 'quiet'}", f"{count} {status.value}"), ", "]
    own = len(report.read_back)
    parts[-1] = f"; {own} of the passed ones by stepbot's own parsers only." if own else "."
    return parts


def _group(row: Row, report: Report) -> Markup:
    checks = [c for c in report.checks if (c.file, c.engine, c.against) == (row.file, row.engine, row.against)]
    version = report.versions.get(row.engine, "")
    head = f"{row.file or 'robot'} in {f'{row.engine} {version}'.strip()}"
    against = "" if row.against == "model" else f", compared with {row.against}"
    summary = element(
        "summary",
        element(f"b.{_TONES[row.status]}", row.status.value),
        f" {head}{against} ",
        element("span.quiet", f"{len(row.compared)} of {len(checks)} quantities compared"),
    )
    headings = ("quantity", "result", "deviation", "tolerance", "unit", "where, why")
    rows = table(headings, (_check_row(check) for check in checks))
    return element("details", summary, rows, open="" if row.status is Status.FAILED else None)


def _check_row(check: Check) -> Markup:
    deviation, tolerance = check.deviation, check.tolerance
    return element(
        "tr",
        element("th", check.quantity),
        element(f"td.{_TONES[check.status]}", check.status.value),
        cell("" if deviation is None else short(deviation), deviation),
        cell("" if tolerance is None else short(tolerance), tolerance),
        element("td", check.unit),
        element("td", check.where, ": " if check.where and check.why else "", check.why),
    )


def findings_section(found: Iterable[Diagnostic], lines: Places, short_name: Mapping[str, str]) -> Markup:
    """Diagnostics, each with its source line.

    Args:
        found: Diagnostics.
        lines: Source lines of their places.
        short_name: File names to display, without folders.
    """
    ranked = sorted(found, key=lambda one: _SEVERITIES.index(one.severity))
    shown = [_finding(one, lines.get((one.span.file, one.span.line)), short_name) for one in ranked]
    nothing = element("p.good", "No errors, warnings or notes.")
    return element("section", element("h2", "Findings"), shown or nothing, id="finding-list")


def _finding(one: Diagnostic, line: str | None, short_name: Mapping[str, str]) -> Markup:
    tone = {"error": "bad", "warning": "warn"}.get(one.severity, "quiet")
    place = short_name.get(one.span.file, one.span.file) + (f":{one.span.line}" if one.span.line else "")
    return element(
        "article.finding",
        element("p", element(f"b.{tone}", f"{one.severity} {one.code}"), " ", one.message),
        element("p.quiet", f"{place} · {CODES[one.code].title}"),
        _frame(one, line) if line is not None else None,
        element("ul", (element("li", note) for note in one.notes)) if one.notes else None,
        element("ul.help", (element("li", f"help: {help}") for help in one.remedies)) if one.remedies else None,
    )


def _frame(one: Diagnostic, line: str) -> Markup:
    """The source line with the place marked."""
    start = max(one.span.column - 1, 0)
    end = max(one.span.end_column - 1, start + 1)
    marked = (line[:start], element("mark", line[start:end]), line[end:]) if one.span.column else (line,)
    return element("pre", element("span.quiet", f"{one.span.line} │ "), marked)


def inputs_section(report: Report) -> Markup:
    """The files that were read, and the engines that ran."""
    files = ((name, f"sha256 {digest}") for name, digest in report.inputs.items())
    engines = ((name, version) for name, version in report.versions.items())
    rows = (element("tr", element("th", name), element("td.number", value)) for name, value in (*files, *engines))
    return element("section", element("h2", "Inputs and engines"), table(("", ""), rows), id="inputs")
