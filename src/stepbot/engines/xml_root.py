"""Reads a description as XML, without what a document may refer to."""

from pathlib import Path
from typing import Any

from .observation import EngineRefused


def xml_root(file: Path) -> Any:
    """The root element (``lxml.etree._Element``) of a file, without comments; entities are not expanded.

    Raises:
        EngineRefused: The file is not XML.
    """
    from lxml import etree

    try:
        parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True)
        return etree.parse(str(file), parser).getroot()
    except etree.XMLSyntaxError as error:
        raise EngineRefused(f"not XML: {error.msg}") from error
