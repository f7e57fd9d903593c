"""XML of descriptions, by lxml, which is imported where a file is read."""

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
        parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True, huge_tree=True)
        return etree.fromstring(file.read_bytes(), parser)  # `etree.parse` raises OSError for some invalid encodings
    except etree.XMLSyntaxError as error:
        raise EngineRefused(f"not XML: {error.msg}") from error
