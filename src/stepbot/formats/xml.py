"""XML of the written formats: elements, numbers, the document around them; imports lxml on first use."""

from collections.abc import Mapping, Sequence
from math import isnan
from typing import TYPE_CHECKING, TypeAlias

from stepbot.version import __version__

if TYPE_CHECKING:
    from lxml.etree import _Element

Element: TypeAlias = "_Element"
Value: TypeAlias = str | float | Sequence[float]


def number(value: float) -> str:
    """Shortest text that reads back as the same double; whole numbers without a point, no minus on zero.

    Raises:
        ValueError: Not a number.
    """
    value = float(value)
    if isnan(value):
        raise ValueError("NaN cannot be written")
    if value == 0.0:
        return "0"
    text = repr(value)
    return text.removesuffix(".0")


def text_of(value: Value) -> str:
    """The text of a value: a string unchanged, a number, or numbers separated by spaces."""
    if isinstance(value, str):
        return value
    if isinstance(value, int | float):
        return number(value)
    return " ".join(number(entry) for entry in value)


def element(parent: Element, tag: str, text: Value | None = None, /, **attributes: Value) -> Element:
    """A new last child of ``parent``; a trailing underscore of an attribute's name is dropped (``class_``)."""
    from lxml import etree

    child = etree.SubElement(parent, tag, {name.rstrip("_"): text_of(value) for name, value in attributes.items()})
    if text is not None:
        child.text = text_of(text)
    return child


def root(tag: str, source: str, namespaces: Mapping[str, str] | None = None, /, **attributes: Value) -> Element:
    """The root element of a document, below a comment that names the generator and the STEP file.

    Args:
        tag: Its tag.
        source: Name of the STEP file; empty if there is none.
        namespaces: Namespace of each prefix in the document.
        attributes: Its attributes.
    """
    from lxml import etree

    top = etree.Element(tag, {name: text_of(value) for name, value in attributes.items()}, nsmap=dict(namespaces or {}))
    origin = f" from {source}" if source else ""
    remark = f" Written by stepbot {__version__}{origin}. "
    while "--" in remark:  # not allowed in an XML comment
        remark = remark.replace("--", "- -")
    top.addprevious(etree.Comment(remark))
    return top


def document(top: Element) -> bytes:
    """The bytes of a document: UTF-8, indented by two spaces, one newline at the end."""
    from lxml import etree

    body: bytes = etree.tostring(top.getroottree(), encoding="UTF-8", pretty_print=True, xml_declaration=False)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + body.rstrip(b"\n") + b"\n"
