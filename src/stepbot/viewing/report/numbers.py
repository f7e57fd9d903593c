"""Quantities as a person reads them; the cell keeps the exact value as ``data-value``."""

from math import degrees, isfinite

from .markup import Markup, element


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
