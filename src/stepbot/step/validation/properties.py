"""Validation properties in a STEP file: volumes, areas and centroids stated by its writer for comparison.

AP214 and AP242 call them geometric validation properties. They are properties of a product definition, of an
occurrence, or of an aspect of a shape that represents a solid; occurrences give their centroid in the assembly's frame.
"""

import math
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

from OCP.StepAP242 import StepAP242_ItemIdentifiedRepresentationUsage
from OCP.StepGeom import StepGeom_CartesianPoint
from OCP.StepRepr import (
    StepRepr_PropertyDefinition,
    StepRepr_PropertyDefinitionRepresentation,
    StepRepr_ShapeAspect,
    StepRepr_ShapeRepresentationRelationship,
    StepRepr_ShapeRepresentationRelationshipWithTransformation,
)
from OCP.StepShape import StepShape_ShapeDefinitionRepresentation, StepShape_SolidModel

from ..assembly import Quantity
from ..exchange.declared_units import derived_unit, measure_of
from ..exchange.length_unit import context_unit
from ..exchange.selection import described_by, entities, items, shaped, text

_TITLE = "geometric validation property"
_POWERS = {Quantity.VOLUME: 3.0, Quantity.AREA: 2.0}
"""Exponents of the length in the quantity's unit."""
_OF_ELEMENTS = ("curve", "independent", "point set")
"""Words in the names of values of loose curves, surfaces and points, not of solids."""


@dataclass(frozen=True, eq=False)
class Statement:
    """A value that the file states."""

    subject: Any
    """Its subject: a product definition, an occurrence, or an aspect of a shape."""
    quantity: Quantity
    value: tuple[float, ...]
    """[m^3, m^2 or m]; empty if its unit is invalid."""


def read_statements(session: Any) -> list[Statement]:
    """All validation properties, in file order.

    Args:
        session: The reader's work session.
    """
    found = []
    for relation in entities(session, StepRepr_PropertyDefinitionRepresentation):
        definition = relation.Definition().Value()
        if not isinstance(definition, StepRepr_PropertyDefinition) or relation.UsedRepresentation() is None:
            continue
        if text(definition.Name()).replace("_", " ").strip().lower() != _TITLE:
            continue
        subject, representation = described_by(definition), relation.UsedRepresentation()
        for item in items(representation):
            quantity = _quantity(item, f"{text(item.Name())} {text(representation.Name())}".lower())
            if quantity is not None:
                found.append(Statement(subject, quantity, _value(item, quantity, representation)))
    return found


class Solids:
    """Finds the solid and the product definition of an aspect of a shape."""

    def __init__(self, session: Any) -> None:
        """Look them all up.

        Args:
            session: The reader's work session.
        """
        self._kept: list[Any] = []  # entities are compared by identity, so they must not be created again
        self._named: dict[int, list[Any]] = defaultdict(list)
        self._shapes: dict[int, list[Any]] = defaultdict(list)
        for relation in entities(session, StepShape_ShapeDefinitionRepresentation):
            representation = relation.UsedRepresentation()
            if representation is not None:
                self._add(described_by(relation.Definition().Value()), representation)
        for usage in entities(session, StepAP242_ItemIdentifiedRepresentationUsage):
            listed = [usage.IdentifiedItemValue(index) for index in range(1, usage.NbIdentifiedItem() + 1)]
            self._named[id(usage.Definition().Value())] += [i for i in listed if isinstance(i, StepShape_SolidModel)]
            self._kept += [usage.Definition().Value(), *listed]
        self._related: dict[int, list[Any]] = defaultdict(list)
        for relation in entities(session, StepRepr_ShapeRepresentationRelationship):
            if not isinstance(relation, StepRepr_ShapeRepresentationRelationshipWithTransformation):
                self._related[id(relation.Rep1())].append(relation.Rep2())
                self._related[id(relation.Rep2())].append(relation.Rep1())
                self._kept += [relation.Rep1(), relation.Rep2()]

    def of(self, aspect: Any) -> tuple[Any, int, int] | None:
        """The product definition, the index of the solid in its shape, and the number of its solids.

        None for an aspect that does not represent exactly one solid.
        """
        definition = shaped(aspect.OfShape()) if isinstance(aspect, StepRepr_ShapeAspect) else None
        named = {id(solid): solid for solid in self._named[id(aspect)]}
        if definition is None or len(named) != 1:
            return None
        solids = [id(solid) for solid in self._solids(definition)]
        (solid,) = named
        return (definition, solids.index(solid), len(solids)) if solid in solids else None

    def _add(self, subject: Any, representation: Any) -> None:
        self._kept += [subject, representation]
        if isinstance(subject, StepRepr_ShapeAspect):
            listed = [item for item in items(representation) if isinstance(item, StepShape_SolidModel)]
            self._named[id(subject)] += listed
            self._kept += listed
        else:
            self._shapes[id(subject)].append(representation)

    def _solids(self, definition: Any) -> list[Any]:
        """The solids of a product definition, in the order in which its representations list them."""
        waiting, found = list(self._shapes[id(definition)]), []
        seen = set()
        while waiting:
            representation = waiting.pop(0)
            if id(representation) not in seen:
                seen.add(id(representation))
                found += [item for item in items(representation) if isinstance(item, StepShape_SolidModel)]
                waiting += self._related[id(representation)]
        self._kept += found
        return found


def _quantity(item: Any, name: str) -> Quantity | None:
    if any(word in name for word in _OF_ELEMENTS):
        return None
    if isinstance(item, StepGeom_CartesianPoint):
        return Quantity.CENTROID if "cent" in name else None
    if measure_of(item) is None:
        return None
    return Quantity.VOLUME if "volume" in name else Quantity.AREA if "area" in name else None


def _value(item: Any, quantity: Quantity, representation: Any) -> tuple[float, ...]:
    if quantity is Quantity.CENTROID:
        unit = context_unit(representation.ContextOfItems())
        point = [item.CoordinatesValue(index) for index in range(1, item.NbCoordinates() + 1)]
        value = tuple(number * unit.size for number in point) if unit is not None and len(point) == 3 else ()
    else:
        measure = measure_of(item)
        derived = derived_unit(measure)
        fits = derived is not None and derived.dimensions == (0.0, _POWERS[quantity])
        value = (measure.ValueComponent() * derived.size,) if derived is not None and fits else ()
    return value if all(map(math.isfinite, value)) else ()
