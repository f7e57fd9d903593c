"""HTML and SVG elements: every text and attribute is escaped, so that no name becomes markup."""

from collections.abc import Iterable
from html import escape
from math import degrees, isfinite


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


def cell(text: str, value: float | None) -> Markup:
    """A cell of a table with a number; a dash without one."""
    if value is None or not isfinite(value):
        return element("td.number", "–")
    return element("td.number", text, data_value=repr(float(value)))


def mass_text(mass: float) -> str:
    """A mass [kg] in kilograms, grams or milligrams."""
    if mass >= 1.0 or mass == 0.0:
        return f"{mass:.4g} kg"
    return f"{mass * 1e3:.4g} g" if mass >= 1e-3 else f"{mass * 1e6:.4g} mg"


def position_text(value: float, slides: bool) -> str:
    """A joint's position [rad] or [m] in degrees or millimetres."""
    return f"{round(value * 1e3, 6) + 0.0:.6g} mm" if slides else f"{round(degrees(value), 6) + 0.0:.6g}°"


def short(value: float) -> str:
    """A number of any size in few letters."""
    return f"{value:.2e}" if value and not 1e-3 <= abs(value) < 1e5 else f"{value:.4g}"
