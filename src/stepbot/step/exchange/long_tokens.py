"""Strings and comments that are longer than the kernel's parser can hold; it rejects the file without a reason."""

import re
from collections.abc import Iterator
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import read_regular

from .encodings import line_of

LONGEST = 16_382
"""Bytes of a string with its quotes, or of a line of a comment: the kernel's parser has a buffer of 16 kB."""
_SHOWN = 5
"""Maximum number of places in a diagnostic."""
_OPENING = re.compile(rb"'|/\*")
_COMMENT_TOKENS = re.compile(rb"[\n*]")


def report_long_tokens(path: Path, place: str, found: Diagnostics) -> bool:
    """Report strings and comments that the kernel cannot parse (SB205), by line; False if there are none.

    Args:
        path: A file that the kernel rejected.
        place: The file in diagnostics.
    """
    data = read_regular(path)
    tokens = [(line_of(data, start), what) for start, what in _long_tokens(data)]
    if not tokens:
        return False
    line, what = tokens[0]
    more = f"; and {len(tokens) - 1} more" if len(tokens) > 1 else ""
    found.add(
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
