"""Writes the results to benchmarks/NOTES.md: tables between markers, and a picture. Nothing is measured here."""

import re
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from .overview import PICTURE, picture, tables
from .results import load, rows_of, table

PAGE = Path(__file__).with_name("NOTES.md")
OVER_FILES = ("cold", "cold-hulls")
"""Kinds of results that have a row per file, and the first one the picture; other kinds have a table per file."""
_PART = re.compile(r"(<!-- results: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def write_report(docs: Path) -> None:
    """Update the tables of the notes, and the picture in ``docs`` if matplotlib is installed."""
    PAGE.write_text(page_with_results(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
    if find_spec("matplotlib") is None:
        print(f"{PICTURE} is not updated: pip install 'stepbot[draw]'")
    elif results := {case: rows_of(entry) for case, entry in load().get(OVER_FILES[0], {}).items()}:
        (docs / "pictures" / PICTURE).write_bytes(picture(results))


def page_with_results(text: str) -> str:
    """The page with the tables of each kind between their markers."""
    return _PART.sub(lambda match: match[1] + _tables(match[2]) + match[3], text)


def _tables(kind: str) -> str:
    entries = load().get(kind, {})
    if kind in OVER_FILES and entries:
        results = {case: rows_of(entry) for case, entry in entries.items()}
        return f"{_conditions(entries)}\n\n{tables(results)}"
    parts = [f"`{case}`, {_rounds(entry)}:\n\n{table(rows_of(entry))}\n" for case, entry in entries.items()]
    return "\n".join(parts)


def _conditions(entries: Mapping[str, Mapping[str, object]]) -> str:
    """The machine and the number of rounds, once if they are the same for all files."""
    conditions = {case: _rounds(entry) for case, entry in entries.items()}
    if len(set(conditions.values())) == 1:
        return f"{next(iter(conditions.values()))}; ratios to the first column, quartiles in brackets."
    return "; ".join(f"`{case}`: {words}" for case, words in conditions.items()) + "."


def _rounds(entry: Mapping[str, object]) -> str:
    return f"{entry['rounds']} round{'s' if entry['rounds'] != 1 else ''}, {entry['machine']}"
