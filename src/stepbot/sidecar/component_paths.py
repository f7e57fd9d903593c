"""Every place of a sidecar that names components of the assembly."""

from collections.abc import Iterator

from msgspec import Struct

from .document import Document
from .origins import AxisOrigin, CenterOrigin, ComponentOrigin, ExplicitOrigin, MateOrigin, Origin
from .tree import Keys


class PathPlace(Struct, frozen=True):
    """A component path, and where it stands."""

    keys: Keys
    pattern: str
    """The path or glob."""
    is_one: bool
    """Whether it must name one component."""
    is_key: bool = False
    """Whether it is the key itself, not the value at it."""


def component_paths(document: Document) -> Iterator[PathPlace]:
    """All component paths and globs of a sidecar, in its order of sections."""
    for pattern in document.parts:
        yield PathPlace(("parts", pattern), pattern, is_one=False, is_key=True)
    for link, section in document.links.items():
        for position, pattern in enumerate(section.parts):
            yield PathPlace(("links", link, "parts", position), pattern, is_one=False)
    for keys, origin in origins(document):
        yield from _paths_of_origin(document, keys, origin)


def origins(document: Document) -> Iterator[tuple[Keys, Origin | None]]:
    """Every origin of a sidecar, and where it stands."""
    if document.root is not None:
        yield ("root", "frame"), document.root.frame
    for section in ("joints", "closures", "frames", "sensors"):
        for name, element in getattr(document, section).items():
            yield (section, name, "origin"), element.origin


def _paths_of_origin(document: Document, keys: Keys, origin: Origin | None) -> Iterator[PathPlace]:
    if isinstance(origin, ComponentOrigin):
        yield PathPlace((*keys, "component"), origin.component, is_one=True)
    elif isinstance(origin, CenterOrigin):
        yield PathPlace((*keys, "center"), origin.center, is_one=True)
    elif isinstance(origin, AxisOrigin):
        yield PathPlace((*keys, "axis_of"), origin.axis_of, is_one=True)
    elif isinstance(origin, MateOrigin):
        for position, pattern in enumerate(origin.mate):
            yield PathPlace((*keys, "mate", position), pattern, is_one=True)
    elif isinstance(origin, ExplicitOrigin) and origin.relative_to not in ("assembly", *document.links):
        yield PathPlace((*keys, "relative_to"), origin.relative_to, is_one=True)
