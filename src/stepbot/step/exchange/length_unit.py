"""The length unit and the stated precision of a STEP file.

Every shape of a STEP file has its own context with its own unit, by which the kernel scales it. For a context without
unit the kernel assumes millimetres; stepbot does not.
"""

import math
from collections import Counter
from typing import Any

from msgspec import Struct
from OCP.STEPConstruct import STEPConstruct_UnitContext
from OCP.StepGeom import StepGeom_GeometricRepresentationItem
from OCP.StepRepr import StepRepr_MappedItem
from OCP.StepShape import StepShape_ShapeDimensionRepresentation, StepShape_ShapeRepresentation
from OCP.StepVisual import StepVisual_TessellatedItem

from stepbot.diagnostics import Diagnostics, Span

from .declared_units import KNOWN_LENGTHS, DeclaredUnit, declared_unit
from .selection import entities, items

_WITH_LENGTHS = (StepGeom_GeometricRepresentationItem, StepRepr_MappedItem, StepVisual_TessellatedItem)
DEFAULT_PRECISION = 1e-3
"""Precision [mm] of a shape that states none: the kernel's default."""


class LengthUnit(Struct, frozen=True):
    """The unit of most shapes in a file."""

    name: str
    scale: float
    others: tuple[str, ...] = ()
    """Further units that some shapes are in."""


def read_length_unit(session: Any, place: str, diagnostics: Diagnostics) -> LengthUnit | None:
    """The file's length unit; None, with the reason in ``diagnostics``, if a shape has none."""
    units: Counter[DeclaredUnit] = Counter()
    missing = 0
    sizes: dict[int, tuple[Any, DeclaredUnit | None]] = {}  # a reference is kept, so that its id stays unique
    for representation in entities(session, StepShape_ShapeRepresentation):
        if isinstance(representation, StepShape_ShapeDimensionRepresentation) or not any(
            isinstance(item, _WITH_LENGTHS) for item in items(representation)
        ):
            continue
        context = representation.ContextOfItems()
        if id(context) not in sizes:
            sizes[id(context)] = (context, context_unit(context))
        unit = sizes[id(context)][1]
        if unit is None:
            missing += 1
        else:
            units[unit] += 1
    if missing:
        without = f"{missing} of {missing + units.total()} shapes do" if units else "the file does"
        diagnostics.add(
            "SB207",
            f"{without} not declare a length unit",
            Span(place),
            help=["export with a CAD program that writes the unit", "add a LENGTH_UNIT to the geometric context"],
        )
        return None
    if not units:
        return LengthUnit("mm", 1e-3)  # no shape: reported elsewhere, and nothing to scale
    for unit in units:
        _check_name(unit, place, diagnostics)
    first = max(units, key=lambda unit: units[unit])
    return LengthUnit(first.name, first.size, tuple(unit.name for unit in units if unit != first))


def precision(context: Any) -> float:
    """Uncertainty [mm] stated in a context of shapes, as read by the kernel."""
    measures = _part(context, "GlobalUncertaintyAssignedContext")
    factors = unit_factors(context)
    if measures is None or factors is None:
        return DEFAULT_PRECISION
    factors.ComputeTolerance(measures)
    value = factors.Uncertainty() * factors.LengthFactor() if factors.HasUncertainty() else 0.0
    return value if math.isfinite(value) and value > 0.0 else DEFAULT_PRECISION


def context_unit(context: Any) -> DeclaredUnit | None:
    """The length unit of a context; None if it has none, or one that the kernel does not support."""
    factors = unit_factors(context)
    assigned = _part(context, "GlobalUnitAssignedContext")
    if factors is None or not factors.LengthDone():
        return None
    for index in range(1, assigned.NbUnits() + 1):
        unit = declared_unit(assigned.UnitsValue(index))
        if unit.quantity == "length":
            followed = math.isclose(unit.size * 1e3, factors.LengthFactor(), rel_tol=1e-9)
            return unit if followed else None
    return None


def unit_factors(context: Any) -> Any:
    """The kernel's own unit factors for a context; None without units."""
    assigned = _part(context, "GlobalUnitAssignedContext")
    if assigned is None:
        return None
    factors = STEPConstruct_UnitContext()
    factors.ComputeFactors(assigned)
    return factors


def _part(context: Any, name: str) -> Any:
    """A part of a combined context, or the context itself if it is that part."""
    if type(context).__name__ == f"StepRepr_{name}":
        return context
    return getattr(context, name)() if hasattr(context, name) else None


def _check_name(unit: DeclaredUnit, place: str, diagnostics: Diagnostics) -> None:
    known = KNOWN_LENGTHS.get(unit.name, unit.size)
    if not math.isclose(known, unit.size, rel_tol=1e-4):
        diagnostics.add(
            "SB209",
            f"the file's unit '{unit.name}' is declared as {unit.size:.9g} m, not {known:.9g} m",
            Span(place),
            help=["compare a known dimension with `stepbot inspect`"],
        )
