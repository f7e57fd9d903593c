"""Units as a STEP file declares them: the size of each in SI, never assumed.

An SI unit is a prefix and a name; any other unit is defined as a multiple of another declared unit. The name of such a
unit is not used: a CAD program's INCH is as long as its file declares.
"""

import math
from typing import Any, Literal

from msgspec import Struct
from OCP.StepBasic import (
    StepBasic_ConversionBasedUnit,
    StepBasic_ConversionBasedUnitAndLengthUnit,
    StepBasic_ConversionBasedUnitAndMassUnit,
    StepBasic_SiPrefix,
    StepBasic_SiUnit,
    StepBasic_SiUnitAndLengthUnit,
    StepBasic_SiUnitAndMassUnit,
)
from OCP.StepRepr import StepRepr_MeasureRepresentationItem

from .selection import text

Quantity = Literal["length", "mass", "other"]

_PREFIXES = {
    StepBasic_SiPrefix.StepBasic_spExa: ("E", 1e18),
    StepBasic_SiPrefix.StepBasic_spPeta: ("P", 1e15),
    StepBasic_SiPrefix.StepBasic_spTera: ("T", 1e12),
    StepBasic_SiPrefix.StepBasic_spGiga: ("G", 1e9),
    StepBasic_SiPrefix.StepBasic_spMega: ("M", 1e6),
    StepBasic_SiPrefix.StepBasic_spKilo: ("k", 1e3),
    StepBasic_SiPrefix.StepBasic_spHecto: ("h", 1e2),
    StepBasic_SiPrefix.StepBasic_spDeca: ("da", 1e1),
    StepBasic_SiPrefix.StepBasic_spDeci: ("d", 1e-1),
    StepBasic_SiPrefix.StepBasic_spCenti: ("c", 1e-2),
    StepBasic_SiPrefix.StepBasic_spMilli: ("m", 1e-3),
    StepBasic_SiPrefix.StepBasic_spMicro: ("u", 1e-6),
    StepBasic_SiPrefix.StepBasic_spNano: ("n", 1e-9),
    StepBasic_SiPrefix.StepBasic_spPico: ("p", 1e-12),
    StepBasic_SiPrefix.StepBasic_spFemto: ("f", 1e-15),
    StepBasic_SiPrefix.StepBasic_spAtto: ("a", 1e-18),
}
_KINDS: dict[Quantity, tuple[type, type]] = {
    "length": (StepBasic_SiUnitAndLengthUnit, StepBasic_ConversionBasedUnitAndLengthUnit),
    "mass": (StepBasic_SiUnitAndMassUnit, StepBasic_ConversionBasedUnitAndMassUnit),
}
_SI = {"length": ("m", 1.0), "mass": ("g", 1e-3)}

KNOWN_LENGTHS = {
    "inch": 0.0254, "in": 0.0254, "foot": 0.3048, "feet": 0.3048, "ft": 0.3048, "yard": 0.9144, "mile": 1609.344,
    "mil": 2.54e-5, "thou": 2.54e-5, "microinch": 2.54e-8, "micron": 1e-6, "mm": 1e-3, "millimetre": 1e-3,
    "millimeter": 1e-3, "cm": 1e-2, "centimetre": 1e-2, "centimeter": 1e-2, "m": 1.0, "metre": 1.0, "meter": 1.0,
}  # fmt: skip
"""Size [m] of length units with common names."""
_SPELLINGS = {"in": "inch", "feet": "foot", "ft": "foot", "us inch": "inch", "millimetre": "mm", "millimeter": "mm"}


class DeclaredUnit(Struct, frozen=True):
    """A unit and its size."""

    quantity: Quantity
    name: str
    """``mm``, ``inch``, ``kg`` ..., in the usual spelling."""
    size: float
    """In m or kg; 0 for an invalid declaration."""


class DerivedUnit(Struct, frozen=True):
    """A product of powers of units."""

    name: str
    size: float
    """In kg^a m^b."""
    dimensions: tuple[float, float]
    """Exponents of mass and length."""


def measure_of(item: Any) -> Any:
    """The value and unit of a representation item; None for an item of another type."""
    if isinstance(item, StepRepr_MeasureRepresentationItem):
        return item.Measure()
    return item.GetMeasureWithUnit() if hasattr(item, "GetMeasureWithUnit") else None


def derived_unit(measure: Any) -> DerivedUnit | None:
    """The unit of a measure with a derived unit; None otherwise, or if it is invalid."""
    component = measure.UnitComponent()
    if component.IsNull() or (derived := component.DerivedUnit()) is None:
        return None
    size, mass, length, names = 1.0, 0.0, 0.0, []
    for index in range(1, derived.NbElements() + 1):
        element = derived.ElementsValue(index)
        if element is None:  # the file refers to something that is not a unit
            return None
        unit, exponent = declared_unit(element.Unit()), element.Exponent()
        if unit.size <= 0.0 or abs(exponent) > 12:
            return None
        size *= unit.size**exponent
        mass += exponent if unit.quantity == "mass" else 0.0
        length += exponent if unit.quantity == "length" else 0.0
        names.append(f"{unit.name}^{exponent:g}" if exponent != 1.0 else unit.name)
    return DerivedUnit(" ".join(names), size, (mass, length))


def declared_unit(unit: Any, depth: int = 0) -> DeclaredUnit:
    """Name and size of a named unit of the file; the nesting is limited, because files with cycles exist."""
    quantity: Quantity = next((one for one, kinds in _KINDS.items() if isinstance(unit, kinds)), "other")
    if quantity == "other" or depth > 5:
        return DeclaredUnit("other", "", 0.0)
    if isinstance(unit, StepBasic_SiUnit):
        symbol, size = _SI[quantity]
        prefix, factor = _PREFIXES[unit.Prefix()] if unit.HasPrefix() else ("", 1.0)
        if quantity == "mass":  # kilo and gram make 1, not 1000 * 0.001
            return DeclaredUnit(quantity, prefix + symbol, factor / 1000.0)
        return DeclaredUnit(quantity, prefix + symbol, size * factor)
    name = text(unit.Name()).strip().strip("'").lower()
    name = _SPELLINGS.get(name, name)
    size = _converted(unit, quantity, depth)
    known = KNOWN_LENGTHS.get(name, 0.0) if quantity == "length" else 0.0
    # 2.54 times 0.01 is not 0.0254 in floating point, but that is the intended value
    return DeclaredUnit(quantity, name, known if math.isclose(size, known, rel_tol=1e-12) else size)


def _converted(unit: StepBasic_ConversionBasedUnit, quantity: Quantity, depth: int) -> float:
    """Size of a unit defined as a multiple of another one of its kind."""
    factor = unit.ConversionFactor()
    if factor is None or factor.UnitComponent().IsNull():
        return 0.0
    base = declared_unit(factor.UnitComponent().NamedUnit(), depth + 1)
    size = factor.ValueComponent() * base.size
    return size if base.quantity == quantity and math.isfinite(size) and size > 0.0 else 0.0
