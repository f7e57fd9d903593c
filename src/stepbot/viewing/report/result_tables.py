"""What the engines confirmed, what was found, and what was read."""

from collections.abc import Iterable, Mapping, Sequence
from math import log10

from stepbot.diagnostics import Diagnostic
from stepbot.diagnostics.codes import CODES
from stepbot.report.robot import Check, Report, Row, Status

from .robot_tables import Markup, cell, element, section, short, table, table_row

_LOWEST = -14
"""Power of ten at the left; what is smaller, or exactly zero, is there."""
_HIGHEST = 1
_LABELS, _WIDTH, _ROW, _TOP, _BOTTOM = 250, 900, 22, 8, 40
_COLORS = {Status.PASSED: "passed", Status.FAILED: "failed"}


def deviations_plot(report: Report) -> Markup | None:
    """The plot; None if no check has a number."""
    rows = [(name, checks) for name, checks in _rows(report) if checks]
    if not rows:
        return None
    height = _TOP + _ROW * len(rows) + _BOTTOM
    parts = [*_grid(height - _BOTTOM), *(part for i, row in enumerate(rows) for part in _row(i, *row))]
    label = "Deviation of every check relative to its tolerance"
    drawing = element("svg", *parts, viewBox=f"0 0 {_WIDTH} {height}", role="img", aria_label=label)
    return element("figure.plot", drawing)


def _rows(report: Report) -> list[tuple[str, list[Check]]]:
    rows: dict[tuple[str, str, str], list[Check]] = {}
    for check in report.checks:
        measured = rows.setdefault((check.file, check.engine, check.against), [])
        if check.status in _COLORS and check.ratio >= 0.0:
            measured.append(check)
    return [(f"{file or 'robot'} in {engine}", checks) for (file, engine, _), checks in rows.items()]


def _row(number: int, name: str, checks: Sequence[Check]) -> list[Markup]:
    y = _TOP + _ROW * (number + 0.5)
    shown = name if len(name) <= 36 else f"{name[:35]}…"
    label = element("text", shown, x=_LABELS - 12, y=y + 4, text_anchor="end")
    line = element("line.row", x1=_LABELS, y1=y, x2=_WIDTH - 12, y2=y)
    return [line, label, *(_dot(check, y) for check in checks)]


def _dot(check: Check, y: float) -> Markup:
    deviation, tolerance = short(check.deviation or 0.0), short(check.tolerance or 0.0)
    words = f"{check.quantity}: {deviation} {check.unit}".rstrip()
    words += f", tolerance {tolerance}: {check.where}".rstrip(": ")
    kind = f"circle.{_COLORS[check.status]}"
    return element(kind, element("title", words), cx=f"{_x(check.ratio):.1f}", cy=f"{y:g}", r=4.5)


def _grid(bottom: float) -> list[Markup]:
    parts = []
    for power in range(_LOWEST, _HIGHEST + 1, 2):
        x = f"{_x(10.0**power):.1f}"
        text = "≤ 1e-14" if power == _LOWEST else "1" if power == 0 else f"1e{power}"
        parts.append(element("line.grid", x1=x, y1=_TOP, x2=x, y2=bottom))
        parts.append(element("text.tick", text, x=x, y=bottom + 16, text_anchor="middle"))
    limit = f"{_x(1.0):.1f}"
    parts.append(element("line.limit", x1=limit, y1=_TOP, x2=limit, y2=bottom))
    title = "deviation / tolerance"
    parts.append(element("text.tick", title, x=(_LABELS + _WIDTH) / 2, y=bottom + 33, text_anchor="middle"))
    return parts


def _x(ratio: float) -> float:
    power = min(max(log10(ratio) if ratio > 0.0 else _LOWEST, _LOWEST), _HIGHEST)
    return _LABELS + 24 + (power - _LOWEST) / (_HIGHEST - _LOWEST) * (_WIDTH - _LABELS - 48)


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
    return section(
        "Verification",
        element("p", _counts(report)),
        deviations_plot(report),
        element("p.quiet", note),
        groups,
        name="proof-table",
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
    return table_row(
        check.quantity,
        element(f"td.{_TONES[check.status]}", check.status.value),
        cell(check.deviation, short),
        cell(check.tolerance, short),
        check.unit,
        (check.where, ": " if check.where and check.why else "", check.why),
    )


def findings_section(diagnostics: Iterable[Diagnostic], lines: Places, short_name: Mapping[str, str]) -> Markup:
    """Diagnostics, each with its source line; ``short_name`` are the file names to display, without folders."""
    ranked = sorted(diagnostics, key=lambda diagnostic: _SEVERITIES.index(diagnostic.severity))
    shown = [_finding(one, lines.get((one.span.file, one.span.line)), short_name) for one in ranked]
    nothing = element("p.good", "No errors, warnings or notes.")
    return section("Findings", shown or nothing, name="finding-list")


def _finding(diagnostic: Diagnostic, line: str | None, short_name: Mapping[str, str]) -> Markup:
    tone = {"error": "bad", "warning": "warn"}.get(diagnostic.severity, "quiet")
    place = short_name.get(diagnostic.span.file, diagnostic.span.file) + (
        f":{diagnostic.span.line}" if diagnostic.span.line else ""
    )
    return element(
        "article.finding",
        element("p", element(f"b.{tone}", f"{diagnostic.severity} {diagnostic.code}"), " ", diagnostic.message),
        element("p.quiet", f"{place} · {CODES[diagnostic.code].title}"),
        _frame(diagnostic, line) if line is not None else None,
        element("ul", (element("li", note) for note in diagnostic.notes)) if diagnostic.notes else None,
        element("ul.help", (element("li", f"help: {help}") for help in diagnostic.remedies))
        if diagnostic.remedies
        else None,
    )


def _frame(diagnostic: Diagnostic, line: str) -> Markup:
    """The source line with the place marked."""
    start = max(diagnostic.span.column - 1, 0)
    end = max(diagnostic.span.end_column - 1, start + 1)
    marked = (line[:start], element("mark", line[start:end]), line[end:]) if diagnostic.span.column else (line,)
    return element("pre", element("span.quiet", f"{diagnostic.span.line} │ "), marked)


def inputs_section(report: Report) -> Markup:
    """The files that were read, and the engines that ran."""
    files = ((name, f"sha256 {digest}") for name, digest in report.inputs.items())
    engines = ((name, version) for name, version in report.versions.items())
    rows = (table_row(name, element("td.number", value)) for name, value in (*files, *engines))
    return section("Inputs and engines", table(("", ""), rows), name="inputs")
