"""The results in docs/: tables between markers of performance.md, and a plot. Nothing is measured here."""

import re
from pathlib import Path

from .plot import bars
from .results import load, rows_of, table

PAGE, PLOT = "performance.md", "performance.svg"
_PART = re.compile(r"(<!-- results: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def write_report(docs: Path) -> None:
    """Write page and plot anew."""
    page = docs / PAGE
    page.write_text(page_with_results(page.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
    (docs / PLOT).write_text(plot(), encoding="utf-8", newline="\n")


def page_with_results(text: str) -> str:
    """A page whose marked parts hold the tables of their kind."""
    return _PART.sub(lambda match: match[1] + _tables(match[2]) + match[3], text)


def plot() -> str:
    """Ratios of the comparison with the bare script, as SVG."""
    groups = {}
    for case, entry in load().get("cold", {}).items():
        groups[case] = [(row.contender, row.wall_ratio) for row in rows_of(entry)]
    return bars("Time of the bare OCCT script = 1", groups)


def _tables(kind: str) -> str:
    parts = []
    for case, entry in load().get(kind, {}).items():
        parts.append(f"`{case}`, {entry['rounds']} rounds, {entry['machine']}:\n\n{table(rows_of(entry))}\n")
    return "\n".join(parts)
