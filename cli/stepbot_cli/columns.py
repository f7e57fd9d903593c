"""Text in columns, as wide as its cells."""

import unicodedata
from collections.abc import Sequence

WIDEST = 60
"""Columns of the screen; a longer cell pushes only the rest of its own line."""


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines, the cells of a column below each other."""
    widths = [min(max(cells(cell) for cell in column), WIDEST) for column in zip(*rows, strict=True)]
    return ["  ".join(map(padded, row, widths)).rstrip() for row in rows]


def padded(text: str, width: int) -> str:
    """``text`` with blanks up to ``width``."""
    return text + " " * (width - cells(text))


def cells(text: str) -> int:
    """Columns of the screen that ``text`` takes: wide characters two, combining ones none."""
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)
