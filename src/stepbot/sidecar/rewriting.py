"""Replaces component paths in the text of a sidecar; every other byte is unchanged.

The text is spliced at the positions of the values, because a YAML writer would change the layout. The result is parsed
again, and must be the same sidecar except for these paths.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from stepbot.diagnostics import Diagnostics, Span

from .component_paths import PathPlace, component_paths
from .load import parse_sidecar
from .located import Sidecar
from .tree import plain_data

_LINE_END = re.compile(r"(\r\n|\r|\n)")
_ANCHOR = re.compile(r"&\S+ +")
_PLAIN = re.compile(r"[^\W\d][\w/.-]*( [\w/.-]+)*")
"""Paths that need no quotes anywhere."""
_NO_TEXT = frozenset({"true", "false", "null"})
"""Words that are not strings without quotes."""
_BYTE_ORDER_MARK = "\ufeff"


def rewritten(sidecar: Sidecar, content: bytes, paths: Mapping[str, str]) -> bytes | None:
    """Replace paths.

    Args:
        content: The bytes that it was read from.
        paths: The new path for each path to replace.

    Returns:
        The new file; None if the result would be a different sidecar and must not be written: for a path across several
            lines, or one that another rule already has.
    """
    text = content.decode("utf-8")
    mark = _BYTE_ORDER_MARK if text.startswith(_BYTE_ORDER_MARK) else ""
    lines = _LINE_END.split(text.removeprefix(mark))  # lines at even places, their ends between them
    places = [place for place in component_paths(sidecar.document) if place.pattern in paths]
    spans = {
        _span(sidecar, place): place.pattern for place in places if _written(lines, _span(sidecar, place)) is not None
    }
    for span in sorted(spans, reverse=True):
        _splice(lines, span, spans[span], paths[spans[span]])
    new = mark + "".join(lines)
    again = parse_sidecar(new.removeprefix(mark).replace("\r\n", "\n").replace("\r", "\n"), sidecar.path, Diagnostics())
    if again is None or plain_data(again.root) != _expected(plain_data(sidecar.root, shared=False), places, paths):
        return None
    return new.encode("utf-8")


def _span(sidecar: Sidecar, place: PathPlace) -> Span:
    return sidecar.key_span(*place.keys) if place.is_key else sidecar.span(*place.keys)


def _written(lines: list[str], span: Span) -> str | None:
    """The text at a place; None for an alias, whose anchor is replaced instead, and for text of several lines."""
    if not span.end_column:
        return None
    text = lines[2 * (span.line - 1)][span.column - 1 : span.end_column - 1]
    return None if text.startswith("*") else text


def _splice(lines: list[str], span: Span, old: str, new: str) -> None:
    index = 2 * (span.line - 1)
    line = lines[index]
    written = line[span.column - 1 : span.end_column - 1]
    anchor = _ANCHOR.match(written)
    start = anchor[0] if anchor else ""
    lines[index] = (
        line[: span.column - 1] + start + _quoted_as(written[len(start) :], old, new) + line[span.end_column - 1 :]
    )


def _quoted_as(written: str, old: str, new: str) -> str:
    """A path in the quotes of another, or with quotes if it needs them."""
    if written == old and _PLAIN.fullmatch(new) and new.lower() not in _NO_TEXT:
        return new
    if written.startswith("'"):
        return f"'{new.replace(chr(39), 2 * chr(39))}'"
    return '"' + new.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _expected(data: Any, places: Sequence[PathPlace], paths: Mapping[str, str]) -> Any:
    """The values of the sidecar, which are changed, with the new paths."""
    if any(place.is_key for place in places):
        data["parts"] = {paths.get(key, key): value for key, value in data["parts"].items()}
    for place in (one for one in places if not one.is_key):
        at = data
        for key in place.keys[:-1]:
            at = at[key]
        at[place.keys[-1]] = paths[place.pattern]
    return data
