"""The statements of a STEP file's text, found in one pass even if some are invalid."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from .encodings import Text

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
    found, seen = [], set[int]()
    for statement in find_statements(data):
        if statement.number in seen:
            found.append(statement)
        seen.add(statement.number)
    return found
