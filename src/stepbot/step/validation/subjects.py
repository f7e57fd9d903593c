"""Subjects of validation properties: entities of the file found again among definitions and components."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from OCP.TopAbs import TopAbs_ShapeEnum

from stepbot.geometry.spatial import Array
from stepbot.step.structure.source import NONE, Definition

from ..structure.products import Products
from ..structure.tree import Tree
from .properties import Solids


@dataclass(frozen=True)
class Subject:
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
