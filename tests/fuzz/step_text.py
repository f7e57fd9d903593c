"""The text of a STEP file in pieces that can be damaged one by one (ISO 10303-21).

It only splits tokens and statements, so that it reads any complete file; it is independent of the tested reader.
"""

import re
from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

from msgspec import Struct

_TOKEN = re.compile(
    rb"(?P<comment>/\*.*?\*/)|(?P<string>'(?:[^']|'')*')|(?P<reference>#\d+)|(?P<enumeration>\.[A-Z][A-Z0-9_]*\.)"
    rb"|(?P<number>[-+]?\d+\.?\d*(?:[Ee][-+]?\d+)?)|(?P<keyword>[A-Z_][A-Z0-9_-]*)|(?P<mark>[(),;=$*])",
    re.DOTALL,
)


class Token(NamedTuple):
    """A token of the file."""

    kind: str
    """``string``, ``reference``, ``enumeration``, ``number``, ``keyword``, ``mark`` or ``comment``."""
    start: int
    end: int


class Statement(NamedTuple):
    """``#12 = KEYWORD(...);``, from its number to its semicolon."""

    number: int
    keyword: bytes
    """The first keyword, also of a complex instance."""
    start: int
    end: int
    first: int
    """Range of its tokens in :attr:`StepText.tokens`, without the number that it defines."""
    last: int


class Edit(NamedTuple):
    """Bytes that replace others."""

    start: int
    end: int
    text: bytes


class StepText(Struct, frozen=True, eq=False, dict=True):
    """A file and the positions of its parts."""

    data: bytes

    @cached_property
    def tokens(self) -> list[Token]:
        """All tokens of the file."""
        return [Token(match.lastgroup or "", match.start(), match.end()) for match in _TOKEN.finditer(self.data)]

    @cached_property
    def statements(self) -> list[Statement]:
        """All statements of the DATA section, in file order."""
        found = []
        opened: int | None = None
        for index, token in enumerate(self.tokens):
            if token.kind == "mark" and self.data[token.start] == ord(";"):
                if opened is not None:
                    found.append(self._statement(opened, index))
                opened = None
            elif opened is None and token.kind == "reference":
                opened = index
        return found

    @cached_property
    def by_keyword(self) -> dict[bytes, list[Statement]]:
        """Statements by kind of entity."""
        groups: dict[bytes, list[Statement]] = {}
        for statement in self.statements:
            groups.setdefault(statement.keyword, []).append(statement)
        return groups

    @cached_property
    def by_number(self) -> dict[int, Statement]:
        """Statements by the number that they define."""
        return {statement.number: statement for statement in self.statements}

    @cached_property
    def header_end(self) -> int:
        """Offset of the DATA section."""
        return max(self.data.find(b"DATA;"), 0)

    def within(self, statement: Statement, *kinds: str) -> list[Token]:
        """The tokens of some kinds in a statement."""
        return [token for token in self.tokens[statement.first : statement.last] if token.kind in kinds]

    def text(self, piece: Token | Statement) -> bytes:
        """The bytes of a part."""
        return self.data[piece.start : piece.end]

    def edited(self, edits: Iterable[Edit]) -> bytes:
        """The file with parts replaced; of overlapping edits the first in the file applies."""
        parts, position = [], 0
        for edit in sorted(edits):
            if edit.start >= position:
                parts += [self.data[position : edit.start], edit.text]
                position = edit.end
        return b"".join((*parts, self.data[position:]))

    def _statement(self, opened: int, closed: int) -> Statement:
        keyword = next((t for t in self.tokens[opened:closed] if t.kind == "keyword"), None)
        start, end = self.tokens[opened].start, self.tokens[closed].end
        number = int(self.data[start + 1 : self.tokens[opened].end])
        return Statement(number, self.text(keyword) if keyword else b"", start, end, opened + 1, closed)
