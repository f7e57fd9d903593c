"""Text in columns, as wide as its cells."""

import unicodedata
from collections.abc import Sequence
from itertools import zip_longest

WIDEST = 60
"""Columns of the screen; a longer cell pushes only the rest of its own line."""

NARROWEST_COLUMN = 8
"""Columns of the screen; a column of a table that is wrapped gets no narrower."""


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines, the cells of a column below each other."""
    widths = [min(max(cells(cell) for cell in column), WIDEST) for column in zip(*rows, strict=True)]
    return ["  ".join(map(padded, row, widths)).rstrip() for row in rows]


def wrapped_rows(rows: Sequence[Sequence[str]], width: int | None) -> list[list[list[str]]]:
    """For each row its lines, for each line its padded cells: text too long for its column goes on below itself.

    Args:
        rows: Rows of as many cells.
        width: Columns of the screen; the widest columns give way until all of them fit. None for no bound: each row
            is one line, as :func:`aligned` has it.
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


def wrapped(text: str, width: int) -> list[str]:
    """``text`` in lines of ``width`` columns, broken at blanks; a word that is too long is broken anywhere."""
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
    """``text`` in ``width`` columns, with an ellipsis where it is longer."""
    if cells(text) <= width:
        return text
    while text and cells(text) > width - 1:
        text = text[:-1]
    return text.rstrip() + "…"


def padded(text: str, width: int) -> str:
    """``text`` with blanks up to ``width``."""
    return text + " " * (width - cells(text))


def cells(text: str) -> int:
    """Columns of the screen that ``text`` takes: wide characters two, combining ones none."""
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)
