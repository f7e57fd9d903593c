"""Writes the results to docs/performance.md: tables between markers. Nothing is measured here."""

import re
from pathlib import Path

from .results import load, rows_of, table

PAGE = "performance.md"
_PART = re.compile(r"(<!-- results: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def write_report(docs: Path) -> None:
    """Update the tables of the page."""
    page = docs / PAGE
    page.write_text(page_with_results(page.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")


def page_with_results(text: str) -> str:
    """The page with the tables of each kind between their markers."""
    return _PART.sub(lambda match: match[1] + _tables(match[2]) + match[3], text)


def _tables(kind: str) -> str:
    parts = []
    for case, entry in load().get(kind, {}).items():
        parts.append(f"`{case}`, {entry['rounds']} rounds, {entry['machine']}:\n\n{table(rows_of(entry))}\n")
    return "\n".join(parts)
