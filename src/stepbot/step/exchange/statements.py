"""The statements of a STEP file's text, found in one pass even if some are invalid."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import read_regular

from .encodings import Text, line_of

# Each alternative ends where it must, at the latest at the end of the file: no byte is read twice.
_TOKEN = re.compile(rb"'[^']*'|/\*.*?(?:\*/|\Z)|(;)|#\s*(\d{1,18})\s*=", re.DOTALL)
_REFERENCE = re.compile(rb"'[^']*'|/\*.*?(?:\*/|\Z)|#\s*(\d{1,18})(?!\d)", re.DOTALL)
_BEGINNING = re.compile(rb"#\s*+(\d{1,18})\s*+=")
"""The beginning of a statement; strings and comments may look like one."""
_KEYWORD = re.compile(rb"[A-Z][A-Z0-9_]*")


class Statement(NamedTuple):
    """``#12=LINE(...);``."""

    number: int
    start: int
    """Offset of its ``#``."""
    body: bytes
    """The text between ``=`` and ``;``."""

    @property
    def keyword(self) -> str:
        """The first keyword, if there are several; empty if there is none."""
        match = _KEYWORD.search(self.body)
        return match[0].decode("ascii") if match is not None else ""

    @property
    def references(self) -> Iterator[int]:
        """The numbers that it refers to, in order."""
        return (int(match[1]) for match in _REFERENCE.finditer(self.body) if match[1])

    def __str__(self) -> str:
        return f"#{self.number} {self.keyword}".rstrip()


def find_statements(data: Text) -> Iterator[Statement]:
    """All statements that end with a semicolon, in file order."""
    head: re.Match[bytes] | None = None
    for token in _TOKEN.finditer(data):
        if token[2] and head is None:
            head = token
        elif token[1]:
            if head is not None:
                yield Statement(int(head[2]), head.start(), data[head.end() : token.start()])
            head = None


def duplicates(data: Text) -> list[Statement]:
    """The statements with the number of an earlier one, in file order.

    Files without any are most, and are recognized in a fraction of the time of :func:`find_statements`.
    """
    numbers = [int(number) for number in _BEGINNING.findall(data)]
    if len(set(numbers)) == len(numbers):
        return []
    repeated, seen = [], set[int]()
    for statement in find_statements(data):
        if statement.number in seen:
            repeated.append(statement)
        seen.add(statement.number)
    return repeated


LONGEST = 16_382
"""Bytes of a string with its quotes, or of a line of a comment: the kernel's parser has a buffer of 16 kB."""
_SHOWN = 5
"""Maximum number of places in a diagnostic."""
_OPENING = re.compile(rb"'|/\*")
_COMMENT_TOKENS = re.compile(rb"[\n*]")


def report_long_tokens(path: Path, place: str, diagnostics: Diagnostics) -> bool:
    """Report strings and comments that the kernel cannot parse (SB205), by line; False if there are none.

    Args:
        path: A file that the kernel rejected.
    """
    data = read_regular(path)
    tokens = [(line_of(data, start), what) for start, what in _long_tokens(data)]
    if not tokens:
        return False
    line, what = tokens[0]
    more = f"; and {len(tokens) - 1} more" if len(tokens) > 1 else ""
    diagnostics.add(
        "SB205",
        f"{what}, the kernel supports {LONGEST}{more}",
        Span(place, line),
        help=["shorten it in the CAD program and export again, or edit this line of the file"],
        notes=[f"line {line}: {what}" for line, what in tokens[1 : 1 + _SHOWN]],
    )
    return True


def _long_tokens(data: bytes) -> Iterator[tuple[int, str]]:
    """Offset and description of each token that is too long, in file order; no byte is searched twice."""
    position = 0
    while (opening := _OPENING.search(data, position)) is not None:
        start = opening.start()
        if opening[0] == b"'":
            position = _end_of_string(data, start + 1)
            if position - start > LONGEST:
                yield start, f"string of {position - start - 2} bytes"
        else:
            end = data.find(b"*/", start + 2)
            position = len(data) if end < 0 else end + 2
            longest = max(map(len, _COMMENT_TOKENS.split(data[start:position])))
            if longest > LONGEST:
                yield start, f"comment with {longest} bytes in a line"


def _end_of_string(data: bytes, position: int) -> int:
    """Offset behind the closing quote; two quotes stand for one within the string."""
    while (end := data.find(b"'", position)) >= 0:
        if data[end + 1 : end + 2] != b"'":
            return end + 1
        position = end + 2
    return len(data)
