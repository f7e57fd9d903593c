"""Verification summary: one line per file, with the engines and the worst deviation."""

import sys
from typing import TYPE_CHECKING

from .diagnostic_text import printable
from .table import RESULT, filled, status_lines
from .terminal import screen_width, wants_color, write_result

if TYPE_CHECKING:
    from stepbot.report.summary import Proof

_HEADINGS = ("format", "file", RESULT, "engines", "worst deviation")


def show_proof(proof: "Proof") -> None:
    """Print for each file its engines, the result and the worst deviation, then the counts."""
    width = screen_width(sys.stdout)
    write_result("\n".join(proof_lines(proof, width, color=wants_color(sys.stdout))))


def proof_lines(proof: "Proof", width: int | None, *, color: bool = False) -> list[str]:
    """The summary as lines no wider than ``width``; None for unlimited."""
    texts = [tuple(map(printable, row)) for row in proof.rows]
    lines = status_lines([_HEADINGS, *texts], [row[2] for row in texts], width, color)
    for text in proof.remarks:
        lines += filled(printable(text), width)
    return lines
