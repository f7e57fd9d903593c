"""HTML and SVG elements: every text and attribute is escaped, so that no name becomes markup."""

from collections.abc import Iterable
from html import escape


class Markup(str):
    """HTML that is safe to put into a page."""

    __slots__ = ()


def element(kind: str, *children: object, **attributes: object) -> Markup:
    """An element.

    Args:
        kind: Tag and classes: ``td.number``.
        children: Texts, elements, or iterables of them; None is left out.
        attributes: Attributes; ``_`` in a name becomes ``-``, None is left out.
    """
    tag, *classes = kind.split(".")
    names = {name.strip("_").replace("_", "-"): value for name, value in attributes.items()}
    given = {"class": " ".join(classes) or None, **names}
    written = "".join(f' {name}="{escape(str(value))}"' for name, value in given.items() if value is not None)
    return Markup(f"<{tag}{written}>{joined(children)}</{tag}>")


def joined(children: Iterable[object]) -> Markup:
    """Texts and elements one after the other."""
    return Markup("".join(_content(child) for child in children))


def _content(child: object) -> str:
    if child is None:
        return ""
    if isinstance(child, Markup):
        return child
    if isinstance(child, str):
        return escape(child)
    if isinstance(child, Iterable):
        return joined(child)
    return escape(str(child))
