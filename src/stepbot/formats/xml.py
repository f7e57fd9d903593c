"""XML of the written formats: elements, numbers, the document around them.

A robot may have one mesh at thousands of places. The elements of such shapes differ in name and position alone:
:class:`Patterns` makes them once, and fills in the rest.
"""

import re
from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import TypeAlias
from xml.etree.ElementTree import Element as Element  # noqa: PLC0414
from xml.etree.ElementTree import SubElement

from stepbot.version import __version__

Value: TypeAlias = str | float | Sequence[float]

_NUMBER = (int, float)
_INDENTED = 30
"""Levels of elements that are indented: beyond, a chain of links would take space quadratic in its length."""
_SLOTS = ("\x01", "\x02")
"""Stand for the first and the second value of a pattern; no document can contain them."""
_NOT_XML = re.compile("[\0\x03-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""Characters that XML 1.0 does not allow, without those of slots."""
_NO_NAMESPACES: Mapping[str, str] = MappingProxyType({})
_NOT_ALLOWED = "U+{:04X} cannot be written to XML"
_IN_TEXT = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "\r": "&#13;"})
_IN_ATTRIBUTE = {**_IN_TEXT, **str.maketrans({'"': "&quot;", "\t": "&#9;", "\n": "&#10;"})}


def number(value: float) -> str:
    """Shortest text that reads back as the same double; whole numbers without a point, no minus on zero.

    Raises:
        ValueError: Not a number.
    """
    text = repr(float(value) + 0.0)  # adding zero turns -0.0 into 0.0
    if text == "nan":
        raise ValueError("NaN cannot be written")
    return text.removesuffix(".0")


def text_of(value: Value) -> str:
    """The text of a value: a string unchanged, a number, or numbers separated by spaces."""
    if isinstance(value, str):
        return value
    return number(value) if isinstance(value, _NUMBER) else _numbers(tuple(value))


@lru_cache(maxsize=1 << 14)
def _numbers(values: tuple[float, ...]) -> str:
    """Numbers separated by spaces: several formats place visual and collision of one part at the same position."""
    return " ".join([number(value) for value in values])


def element(parent: Element, tag: str, text: Value | None = None, /, **attributes: Value) -> Element:
    """A new last child of ``parent``; a trailing underscore of an attribute's name is dropped (``class_``)."""
    child = SubElement(parent, tag, {name.rstrip("_"): text_of(value) for name, value in attributes.items()})
    if text is not None:
        child.text = text_of(text)
    return child


class Patterns:
    """Elements that a document repeats with other names and positions: each is made and serialized once."""

    def __init__(self) -> None:
        self._made: dict[Hashable, _Pattern] = {}

    def add(self, parent: Element, key: Hashable, make: Callable[..., Element], *values: Value) -> None:
        """Add what ``make(parent, *values)`` adds to ``parent``.

        Args:
            key: Equal for elements that differ in ``values`` alone.
            make: Makes the element. It is called once for each key, with texts that it must write as they are, in
                attributes, or between white space.
            values: At most two.
        """
        pattern = self._made.get(key)
        if pattern is None:
            pattern = self._made[key] = _Pattern(make(Element(""), *_SLOTS[: len(values)]))
        texts = [_escaped(value, _IN_ATTRIBUTE) if isinstance(value, str) else text_of(value) for value in values]
        parent.append(_Copy(pattern, texts))


class _Pattern:
    """The text of an element, with gaps."""

    def __init__(self, parent: Element) -> None:
        self._element = parent
        self._at: dict[int, str] = {}
        """By level in the document."""

    def filled(self, level: int, values: Sequence[str]) -> str:
        text = self._at.get(level)
        if text is None:
            text = "\n".join(_lines(self._element, level)).replace("{", "{{").replace("}", "}}")
            for index, slot in enumerate(_SLOTS):
                text = text.replace(slot, f"{{{index}}}")
            self._at[level] = text
        return text.format(*values)


class _Copy(Element):
    """An element with the text of a pattern."""

    def __init__(self, pattern: _Pattern, values: Sequence[str]) -> None:
        super().__init__("")
        self.pattern, self.values = pattern, values


class _Root(Element):
    """The root element, with what stands before it in the document."""

    def __init__(self, tag: str, attributes: dict[str, str], remark: str, namespaces: Mapping[str, str]) -> None:
        super().__init__(tag, attributes)
        self.remark, self.namespaces = remark, namespaces


def root(tag: str, source: str, namespaces: Mapping[str, str] | None = None, /, **attributes: Value) -> Element:
    """The root element of a document, below a comment that names the generator and the STEP file.

    Args:
        source: Name of the STEP file; empty if there is none.
    """
    origin = f" from {source}" if source else ""
    remark = f" Written by stepbot {__version__}{origin}. "
    while "--" in remark:  # not allowed in an XML comment
        remark = remark.replace("--", "- -")
    return _Root(tag, {name: text_of(value) for name, value in attributes.items()}, remark, namespaces or {})


def document(top: Element) -> bytes:
    """The bytes of a document: UTF-8, indented by two spaces, one newline at the end.

    Raises:
        ValueError: A text has a character that XML does not allow.
    """
    assert isinstance(top, _Root)
    head = ['<?xml version="1.0" encoding="UTF-8"?>', f"<!--{_escaped(top.remark, {})}-->"]
    text = "\n".join([*head, *_lines(top, 0, top.namespaces), ""])
    for slot in _SLOTS:
        if slot in text:
            raise ValueError(_NOT_ALLOWED.format(ord(slot)))
    return text.encode()


def _lines(top: Element, level: int, namespaces: Mapping[str, str] = _NO_NAMESPACES) -> list[str]:
    """The lines of an element and everything in it; the first one declares the namespaces."""
    prefixes = {f"{{{namespace}}}": f"{prefix}:" for prefix, namespace in namespaces.items()}
    declared = "".join(f' xmlns:{prefix}="{namespace}"' for prefix, namespace in namespaces.items())
    lines: list[str] = []
    pending: list[tuple[Element, int] | str] = [(top, level)]  # no recursion: chains of links are deep
    while pending:
        one = pending.pop()
        if isinstance(one, str):
            lines.append(one)
            continue
        xml, level = one
        if isinstance(xml, _Copy):
            lines.append(xml.pattern.filled(level, xml.values))
            continue
        indent = "  " * min(level, _INDENTED)
        tag = xml.tag if xml.tag[0] != "{" else _prefixed(xml.tag, prefixes)
        given = "".join([f' {name}="{_escaped(value, _IN_ATTRIBUTE)}"' for name, value in xml.items()])
        begin, declared = f"{indent}<{tag}{declared}{given}", ""
        if len(xml):
            lines.append(f"{begin}>")
            pending.append(f"{indent}</{tag}>")
            pending += [(child, level + 1) for child in reversed(xml)]
        else:
            lines.append(f"{begin}/>" if xml.text is None else f"{begin}>{_escaped(xml.text, _IN_TEXT)}</{tag}>")
    return lines


def _prefixed(tag: str, prefixes: Mapping[str, str]) -> str:
    """A tag with its namespace's prefix."""
    namespace, _, name = tag.partition("}")
    return prefixes[f"{namespace}}}"] + name


def _escaped(text: str, characters: Mapping[int, str]) -> str:
    """A text with its special characters replaced.

    Raises:
        ValueError: It has a character that XML does not allow.
    """
    if text.isidentifier():  # most names
        return text
    if not text.isprintable() and (wrong := _NOT_XML.search(text)):
        raise ValueError(_NOT_ALLOWED.format(ord(wrong[0])))
    return text.translate(characters)
