"""The source lines that diagnostics are about."""

from collections.abc import Iterable
from pathlib import Path

from . import Diagnostic

LARGEST_SOURCE = 16 * 2**20
"""Size [bytes] of a file above which no lines are read, because reading it again would take too long."""


def source_lines(diagnostics: Iterable[Diagnostic]) -> dict[tuple[str, int], str]:
    """The source lines of diagnostics, each file read once; an unreadable file gives none."""
    wanted: dict[str, set[int]] = {}
    for diagnostic in diagnostics:
        if diagnostic.span.line:
            wanted.setdefault(diagnostic.span.file, set()).add(diagnostic.span.line)
    found: dict[tuple[str, int], str] = {}
    for file, numbers in wanted.items():
        try:
            if Path(file).stat().st_size > LARGEST_SOURCE:
                continue
            with Path(file).open(encoding="utf-8", errors="replace") as source:
                for number, line in enumerate(source, start=1):
                    if number in numbers:
                        found[file, number] = line.removeprefix("\ufeff").rstrip("\n")
                    if number >= max(numbers):
                        break
        except OSError:  # missing or unreadable now: the headline is sufficient
            continue
    return found
