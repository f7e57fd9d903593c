"""XML of descriptions, by lxml, which is imported where a file is read."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from .observation import EngineRefused

if TYPE_CHECKING:
    from lxml.etree import _Element

    Element: TypeAlias = _Element
else:
    Element = object
"""An element, for annotations; its stubs lack ``sourceline``."""


def xml_root(file: Path) -> Any:
    """The root element (``lxml.etree._Element``) of a file, without comments; entities are not expanded.

    Raises:
        EngineRefused: The file is not XML.
    """
    from lxml import etree

    try:
        return parsed(file.read_bytes(), remove_comments=True)  # `etree.parse` raises OSError for some encodings
    except etree.XMLSyntaxError as error:
        raise EngineRefused(f"not XML: {error.msg}") from error


def parsed(content: bytes, *, remove_comments: bool = False) -> Any:
    """The root element of a document; entities are not expanded.

    A prefix without a declared namespace is a part of the name, as for simulators: Drake's extensions of URDF have one.

    Raises:
        XMLSyntaxError: It is not XML.
    """
    from lxml import etree

    made = partial(
        etree.XMLParser, resolve_entities=False, no_network=True, remove_comments=remove_comments, huge_tree=True
    )
    parser = made()
    try:
        return etree.fromstring(content, parser)
    except etree.XMLSyntaxError:
        if {one.type for one in parser.error_log} != {etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE}:
            raise
        return etree.fromstring(content, made(recover=True))
