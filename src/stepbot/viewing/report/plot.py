"""All checks of a report in one picture: deviation relative to tolerance on a logarithmic scale, a row per engine."""

from collections.abc import Sequence
from math import log10

from stepbot.report.record import Check, Report, Status

from .markup import Markup, element
from .numbers import short

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
