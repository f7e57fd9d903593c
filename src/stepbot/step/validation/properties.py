"""Validation properties in a STEP file: volumes, areas and centroids stated by its writer for comparison.

AP214 and AP242 call them geometric validation properties. They are properties of a product definition, of an
occurrence, or of an aspect of a shape that represents a solid; occurrences give their centroid in the assembly's frame.
Their subjects, entities of the file, are found again among definitions and components.
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from msgspec import Struct
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
from OCP.TopAbs import TopAbs_ShapeEnum

from stepbot.geometry.spatial import Array
from stepbot.step.structure.source import NONE, Definition

from ..assembly import Quantity
from ..exchange.declared_units import derived_unit, measure_of
from ..exchange.length_unit import context_unit
from ..exchange.selection import described_by, entities, items, shaped, text
from ..structure.products import Products
from ..structure.tree import Tree


class Subject(Struct, frozen=True):
    """A definition, a body of it, or an occurrence of it in another."""

    component: int
    definition: int
    body: int = NONE
    matrix: Array | None = None
    """For an occurrence, shape (4, 4): its pose in its assembly."""


class Subjects:
    """Finds the subjects of statements in the tree of components."""

    def __init__(
        self, session: Any, products: Products, places: Mapping[int, int], definitions: Sequence[Definition], tree: Tree
    ) -> None:
        """Index what one file has.

        Args:
            session: Work session of the file's reader.
            places: For each of them the index of its definition.
            definitions: Every definition once, those of other files included.
        """
        self._solids = Solids(session)
        self._definitions = definitions
        self._by_product = places
        self._products = {id(product.entity): index for index, product in enumerate(products.products)}
        self._occurrences = {id(occurrence.entity): index for index, occurrence in enumerate(products.occurrences)}
        self._assemblies = [occurrence.assembly for occurrence in products.occurrences]
        self._components: dict[tuple[int, int], int] = {}
        for component in tree.components:
            if component.definition != NONE:
                shape = tree.shapes[component.definition]
                self._components.setdefault((shape.definition, shape.body), component.index)
        self._children: dict[int, list[int]] = {index: [] for index in self._components.values()}
        for component in tree.components:
            if component.parent in self._children:
                self._children[component.parent].append(component.index)

    def of(self, entity: Any) -> Subject | None:
        """The subject of an entity; None if it does not occur."""
        if id(entity) in self._occurrences:
            return self._occurrence(self._occurrences[id(entity)])
        if (solid := self._solids.of(entity)) is not None:
            return self._solid(*solid)
        definition = self._by_product.get(self._products.get(id(entity), NONE), NONE)
        component = self._components.get((definition, NONE), NONE)
        return Subject(component, definition) if component != NONE else None

    def _occurrence(self, number: int) -> Subject | None:
        assembly = self._by_product.get(self._assemblies[number], NONE)
        above = self._components.get((assembly, NONE), NONE)
        if above == NONE:
            return None
        for component, child in zip(self._children[above], self._definitions[assembly].children, strict=False):
            if child.number == number:
                return Subject(component, child.definition, matrix=child.matrix)
        return None

    def _solid(self, entity: Any, number: int, count: int) -> Subject | None:
        index = self._by_product.get(self._products.get(id(entity), NONE), NONE)
        bodies = list(self._bodies(index)) if index != NONE else []
        if len(bodies) != count:
            return None
        definition, body = bodies[number]
        alone = len(self._definitions[definition].bodies) == 1
        component = self._components.get((definition, NONE if alone else body), NONE)
        return Subject(component, definition, body) if component != NONE else None

    def _bodies(self, index: int) -> Iterator[tuple[int, int]]:
        """The solids of a product, some of which the kernel may have put into separate definitions."""
        definition = self._definitions[index]
        for number, source in enumerate(definition.bodies):
            if source.shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID:
                yield index, number
        for child in definition.children:
            if self._definitions[child.definition].product == NONE:
                yield from self._bodies(child.definition)


_TITLE = "geometric validation property"
_POWERS = {Quantity.VOLUME: 3.0, Quantity.AREA: 2.0}
"""Exponents of the length in the quantity's unit."""
_OF_ELEMENTS = ("curve", "independent", "point set")
"""Words in the names of values of loose curves, surfaces and points, not of solids."""


class StatedValue(Struct, frozen=True):
    """A value that the file states."""

    subject: Subject | None
    """None if it does not occur in the assembly."""
    quantity: Quantity
    value: tuple[float, ...]
    """[m^3, m^2 or m]; empty if its unit is invalid."""


def read_statements(session: Any) -> list[tuple[Any, Quantity, tuple[float, ...]]]:
    """All validation properties, in file order: the entity that is the subject, the quantity and the value.

    Args:
        session: The reader's work session.
    """
    statements = []
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
                statements.append((subject, quantity, _value(item, quantity, representation)))
    return statements


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
        waiting, solids = list(self._shapes[id(definition)]), []
        seen = set()
        while waiting:
            representation = waiting.pop(0)
            if id(representation) not in seen:
                seen.add(id(representation))
                solids += [item for item in items(representation) if isinstance(item, StepShape_SolidModel)]
                waiting += self._related[id(representation)]
        self._kept += solids
        return solids


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
