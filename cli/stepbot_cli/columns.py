"""Text in aligned columns."""

import unicodedata
from collections.abc import Sequence
from itertools import zip_longest

WIDEST = 60
"""Width of the screen; a longer cell shifts only the rest of its own line."""

NARROWEST_COLUMN = 8
"""Width of the screen; minimum width of a wrapped column of a table."""


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines, with aligned columns."""
    widths = [min(max(cells(cell) for cell in column), WIDEST) for column in zip(*rows, strict=True)]
    return ["  ".join(map(padded, row, widths)).rstrip() for row in rows]


def wrapped_rows(rows: Sequence[Sequence[str]], width: int | None) -> list[list[list[str]]]:
    """For each row its lines, for each line its padded cells: text too long for its column is wrapped.

    Args:
        rows: Rows of equal numbers of cells.
        width: Width of the screen; the widest columns are narrowed until all of them fit. None for unlimited: each row
            is one line, as in :func:`aligned`.
    """
    widths = [max(cells(cell) for cell in column) for column in zip(*rows, strict=True)]
    if width is None:
        return [[list(map(padded, row, [min(w, WIDEST) for w in widths]))] for row in rows]
    while sum(widths) + 2 * (len(widths) - 1) > width and max(widths) > NARROWEST_COLUMN:
        widths[widths.index(max(widths))] -= 1
    return [
        [list(map(padded, line, widths)) for line in zip_longest(*map(wrapped, row, widths), fillvalue="")]
        for row in rows
    ]


def table_lines(rows: Sequence[Sequence[str]], width: int | None) -> list[str]:
    """Rows of cells as lines no wider than ``width``; None for unlimited."""
    return ["  ".join(line).rstrip() for row in wrapped_rows(rows, width) for line in row]


def wrapped(text: str, width: int) -> list[str]:
    """``text`` in lines of ``width`` columns, broken at spaces; a word that is too long is broken anywhere."""
    lines = [""]
    for word in text.split():
        if lines[-1] and cells(lines[-1]) + 1 + cells(word) <= width:
            lines[-1] += f" {word}"
            continue
        lines += [""] if lines[-1] else []
        for letter in word:
            if lines[-1] and cells(lines[-1]) + cells(letter) > width:
                lines.append("")
            lines[-1] += letter
    return lines


def shortened(text: str, width: int) -> str:
    """``text`` in ``width`` columns, truncated with an ellipsis."""
    if cells(text) <= width:
        return text
    while text and cells(text) > width - 1:
        text = text[:-1]
    return text.rstrip() + "…"


def padded(text: str, width: int) -> str:
    """``text`` padded with spaces to ``width``."""
    return text + " " * (width - cells(text))


def cells(text: str) -> int:
    """Width of ``text`` on the screen: wide characters take two columns, combining ones none."""
    if text.isascii():
        return len(text)
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)
