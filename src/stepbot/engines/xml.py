"""XML of descriptions, by lxml, which is imported where a file is read."""

import re
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
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_OTHER_VERSION = re.compile(rb"""^((?:\xef\xbb\xbf)?<\?xml\s+version\s*=\s*["'])0[.]\d+(?=["'])""")
"""A version that XML does not have, as in PyBullet's own files; engines do not read it."""

_LATE_DECLARATION = re.compile(rb"\A(\xef\xbb\xbf)?((?:\s|<!--.*?-->)+)(<\?xml\s[^<>]*\?>)", re.DOTALL)
"""A declaration below blank lines or comments, which most simulators read."""


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


def with_readable_head(content: bytes) -> bytes:
    """The beginning of a document, or all of it, with the declaration first, and with the version that XML has."""
    return _OTHER_VERSION.sub(rb"\g<1>1.0", _LATE_DECLARATION.sub(rb"\1\3\2", content))


def parsed(content: bytes, *, remove_comments: bool = False) -> Any:
    """The root element of a document; entities are not expanded.

    As simulators read it, a prefix without a declared namespace is a part of the name, such as that of Drake's
    extensions of URDF, the version may be 0.0, blank lines and
    comments may precede the declaration, and comments may have hyphens; in a URDF not, from which yourdfpy would
    leave out elements.

    Raises:
        XMLSyntaxError: It is not XML.
    """
    from lxml import etree

    content = with_readable_head(content)
    made = partial(
        etree.XMLParser, resolve_entities=False, no_network=True, remove_comments=remove_comments, huge_tree=True
    )
    parser = made()
    try:
        return etree.fromstring(content, parser)
    except etree.XMLSyntaxError:
        kinds, known = {one.type for one in parser.error_log}, etree.ErrorTypes
        bare = _COMMENT.sub(lambda match: b"\n" * match[0].count(b"\n"), content)
        if known.ERR_HYPHEN_IN_COMMENT in kinds and bare != content:
            root = parsed(bare)
            if root.tag != "robot":
                return root
        if kinds != {known.NS_ERR_UNDEFINED_NAMESPACE}:
            raise
        return etree.fromstring(content, made(recover=True))
