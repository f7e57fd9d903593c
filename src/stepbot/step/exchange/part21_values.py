"""The parameters of a statement of a STEP file's text (ISO 10303-21), as plain values.

``#7=LINE('a',#1,(1.,2.),.T.,$,*,LENGTH_MEASURE(3.))`` is one record, ``LINE``; a complex instance
``(A(1.)B(#2))`` has several.
"""

import re

from msgspec import Struct

_TOKEN = re.compile(
    rb"\s+|/\*.*?\*/"
    rb"|(?P<text>'(?:[^']|'')*')"
    rb"|#\s*(?P<reference>\d{1,18})"
    rb"|\.(?P<word>[A-Z][A-Z0-9_]*)\."
    rb"|(?P<number>[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)"
    rb"|(?P<keyword>!?[A-Z][A-Z0-9_]*)"
    rb'|(?P<binary>"[0-9A-F]*")'
    rb"|(?P<mark>[(),$*])",
    re.DOTALL,
)
_DEEPEST = 32


class SyntaxFault(ValueError):
    """A statement that violates the grammar."""


class Reference(Struct, frozen=True):
    """``#12``."""

    number: int


class Word(Struct, frozen=True):
    """An enumeration value or a logical: ``.T.`` has ``T``."""

    name: str


class Record(Struct, frozen=True):
    """A keyword and its parameters: a simple instance, a part of a complex one, or a typed parameter."""

    keyword: str
    parameters: "tuple[Value, ...]"


Value = float | bytes | Reference | Word | Record | None | tuple["Value", ...]
"""A parameter; strings are the raw text between the quotes, ``$`` is None."""
DERIVED = Word("*")
"""A parameter that the schema derives from others."""


def records(body: bytes) -> tuple[Record, ...]:
    """The records of a statement, from the text between ``=`` and ``;``.

    Raises:
        SyntaxFault: It violates the grammar, or is nested deeper than any schema allows.
    """
    return _Reader(body).statement()


class _Reader:
    def __init__(self, body: bytes) -> None:
        self._tokens = [(match.lastgroup, match[0]) for match in _scan(body) if match.lastgroup is not None]
        self._at = 0

    def statement(self) -> tuple[Record, ...]:
        complex_instance = self._take_mark(b"(")
        records = [self._record()]
        while complex_instance and not self._take_mark(b")"):
            records.append(self._record())
        if self._at < len(self._tokens):
            raise SyntaxFault("text after the end")
        return tuple(records)

    def _record(self, depth: int = 0) -> Record:
        kind, token = self._next()
        if kind != "keyword":
            raise SyntaxFault("a keyword is missing")
        if not self._take_mark(b"("):
            raise SyntaxFault("an opening bracket is missing")
        return Record(token.decode("ascii"), self._values(depth + 1))

    def _values(self, depth: int) -> "tuple[Value, ...]":
        """Values up to the closing parenthesis."""
        if depth > _DEEPEST:
            raise SyntaxFault("nested too deeply")
        if self._take_mark(b")"):
            return ()
        values = [self._value(depth)]
        while not self._take_mark(b")"):
            if not self._take_mark(b","):
                raise SyntaxFault("a comma is missing")
            values.append(self._value(depth))
        return tuple(values)

    def _value(self, depth: int) -> Value:
        kind, token = self._next()
        match kind:
            case "text":
                return token[1:-1]
            case "reference":
                return Reference(int(token[1:]))
            case "word":
                return Word(token[1:-1].decode("ascii"))
            case "number":
                return float(token)
            case "keyword":
                self._at -= 1
                return self._record(depth)
            case "mark" if token == b"(":
                return self._values(depth + 1)
            case "mark" if token == b"*":
                return DERIVED
            case "mark" if token == b"$":
                return None
            case "binary":
                return None
        raise SyntaxFault("a value is missing")

    def _next(self) -> tuple[str, bytes]:
        if self._at >= len(self._tokens):
            raise SyntaxFault("the statement ends in the middle")
        self._at += 1
        return self._tokens[self._at - 1]

    def _take_mark(self, mark: bytes) -> bool:
        if self._at < len(self._tokens) and self._tokens[self._at] == ("mark", mark):
            self._at += 1
            return True
        return False


def _scan(body: bytes) -> "list[re.Match[bytes]]":
    tokens, at = [], 0
    while at < len(body):
        match = _TOKEN.match(body, at)
        if match is None:
            raise SyntaxFault("a character that starts no value")
        tokens.append(match)
        at = match.end()
    return tokens


_DIRECTIVE = re.compile(
    r"\\X2\\((?:[0-9A-Fa-f]{4})*)\\X0\\|\\X4\\((?:[0-9A-Fa-f]{8})*)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)|\\P([A-I])\\|(\\\\)|('')",
    re.DOTALL,
)
_LINE_BREAK = re.compile(r"[\r\n]")


def decode_string(raw: bytes, encoding: str, errors: str = "strict") -> str:
    """The text of a string between its quotes.

    Args:
        raw: Bytes as in the file.
        encoding: Encoding of bytes above 127.
        errors: Handling of undecodable bytes: ``strict`` or ``replace``.

    Raises:
        UnicodeDecodeError: The bytes are not in this encoding.
    """
    page = 1

    def replacement(match: re.Match[str]) -> str:
        nonlocal page
        two, four, one, shifted, alphabet, backslash, _ = match.groups()
        if two is not None:
            return bytes.fromhex(two).decode("utf-16-be", "replace")
        if four is not None:
            return bytes.fromhex(four).decode("utf-32-be", "replace")
        if one is not None:
            return chr(int(one, 16))
        if shifted is not None:
            return bytes([(ord(shifted) & 0x7F) | 0x80]).decode(f"iso8859-{page}", "replace")
        if alphabet is not None:
            page = ord(alphabet) - ord("A") + 1
            return ""
        return "\\" if backslash else "'"

    return _DIRECTIVE.sub(replacement, _joined(raw.decode(encoding, errors)))


def _joined(text: str) -> str:
    """Without line breaks, and without leading and trailing white space."""
    first, *others = _LINE_BREAK.split(text)
    if not others:
        return text
    *middle, last = others
    return "".join([first.rstrip(), *(line.strip() for line in middle), last.lstrip()])
