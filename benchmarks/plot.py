"""Horizontal bars as SVG: a few rectangles and words, the same bytes for the same numbers."""

from collections.abc import Mapping, Sequence
from xml.sax.saxutils import escape

_WIDTH, _LABEL, _BAR, _GAP = 820, 270, 18, 6
_HUES = ("#3b6ea5", "#d98032", "#4f9d69", "#8a5aa3")


def bars(title: str, groups: Mapping[str, Sequence[tuple[str, float]]]) -> str:
    """A picture of named values; a group of bars for each name, a colour for each group.

    Args:
        title: Above all.
        groups: By the group's name its labels and values; the first group's labels give the order.
    """
    labels = list(dict.fromkeys(label for rows in groups.values() for label, _ in rows))
    longest = max((value for rows in groups.values() for _, value in rows), default=1.0)
    scale = (_WIDTH - _LABEL - 70) / longest
    shown = dict(zip(groups, _HUES, strict=False))
    parts = [_text(_LABEL + 180 * place, 38, name, "start", hue) for place, (name, hue) in enumerate(shown.items())]
    y = 48.0
    for label in labels:
        values = [(dict(groups[name]).get(label), hue) for name, hue in shown.items()]
        middle = y + 0.5 * _BAR * len(values) + 4
        parts.append(_text(_LABEL - 10, middle, label, "end", "#222"))
        for value, hue in values:
            if value is not None:
                parts.append(
                    f'<rect x="{_LABEL}" y="{y:.0f}" width="{scale * value:.1f}" height="{_BAR - 2}" fill="{hue}"/>'
                )
                parts.append(_text(_LABEL + scale * value + 6, y + _BAR - 5, f"{value:.2f}", "start", "#222"))
            y += _BAR
        y += _GAP
    line = f'<line x1="{_LABEL + scale:.1f}" x2="{_LABEL + scale:.1f}" y1="42" y2="{y:.0f}" stroke="#999"/>'
    body = "\n".join((_text(10, 20, title, "start", "#222"), *parts, line))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{y + 10:.0f}" '
        f'font-family="sans-serif" font-size="12">\n<rect width="100%" height="100%" fill="white"/>\n{body}\n</svg>\n'
    )


def _text(x: float, y: float, text: str, anchor: str, color: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}">{escape(text)}</text>'
