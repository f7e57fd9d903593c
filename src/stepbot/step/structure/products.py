"""Names of products and occurrences, found again in the document by a mark that they have during the transfer.

The kernel's reader assigns names to shapes by position, so that two occurrences at one position swap or lose theirs.
Here every product definition and every occurrence is renamed to a number before the transfer; the numbers come back as
names of labels, and identify the entities and their real names.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from msgspec import Struct
from OCP.StepBasic import StepBasic_Product, StepBasic_ProductDefinition, StepBasic_ProductDefinitionFormation
from OCP.StepRepr import StepRepr_NextAssemblyUsageOccurrence, StepRepr_ProductDefinitionShape
from OCP.StepShape import StepShape_ShapeDefinitionRepresentation
from OCP.TCollection import TCollection_HAsciiString

from stepbot.geometry.spatial import Array

from ..exchange.length_unit import DEFAULT_PRECISION, precision
from ..exchange.selection import entities, text
from .repetition import take_out_repetitions
from .source import NONE

_PRODUCT = "product-"
_OCCURRENCE = "occurrence-"


class Product(Struct, frozen=True, eq=False):
    """A product definition."""

    entity: Any
    name: str
    precision: float
    """Uncertainty [mm] of its shape."""


class Occurrence(Struct, frozen=True, eq=False):
    """A product in an assembly."""

    entity: Any
    name: str
    assembly: int
    """Index of the parent product."""
    product: int
    """Index of the product that occurs."""


class Products:
    """The product definitions of a file and their occurrences in each other, in file order."""

    def __init__(self, session: Any, *, take_out: bool = True) -> None:
        """Collect them, and mark each in the model.

        Args:
            session: The reader's work session.
            take_out: Whether occurrences that repeat many times are hidden from the kernel.
        """
        definitions = entities(session, StepBasic_ProductDefinition)
        precisions = _precisions(session)
        self.products = [
            Product(entity, _product_name(entity), precisions.get(id(entity), DEFAULT_PRECISION))
            for entity in definitions
        ]
        index_of = {id(entity): index for index, entity in enumerate(definitions)}
        usages = entities(session, StepRepr_NextAssemblyUsageOccurrence)
        self.occurrences = [
            Occurrence(
                usage,
                _occurrence_name(usage),
                index_of.get(id(usage.RelatingProductDefinition()), NONE),
                index_of.get(id(usage.RelatedProductDefinition()), NONE),
            )
            for usage in usages
        ]
        keys = [(occurrence.assembly, occurrence.product) for occurrence in self.occurrences]
        repetitions = take_out_repetitions(session, usages, keys) if take_out else []
        self._repetitions = {repetition.first: repetition for repetition in repetitions}
        taken_out = {index for r in repetitions for index in r.matrices if index != r.first}
        self._below: dict[int, list[int]] = defaultdict(list)
        for index, occurrence in enumerate(self.occurrences):
            if index not in taken_out:
                self._below[occurrence.assembly].append(index)
        self._mark(definitions, {index: usage for index, usage in enumerate(usages) if index not in taken_out})

    def tree_size(self) -> int:
        """Number of components in the tree of all occurrences; files of a few kilobytes can expand to billions.

        A product that contains itself counts as empty: it is reported elsewhere.
        """
        below: dict[int, list[int]] = defaultdict(list)
        for occurrence in self.occurrences:
            if min(occurrence.assembly, occurrence.product) >= 0:
                below[occurrence.assembly].append(occurrence.product)
        sizes: dict[int, int] = {}
        roots = set(range(len(self.products))) - {product for products in below.values() for product in products}
        pending = list(roots)
        while pending:
            product = pending[-1]
            known = product in sizes
            left = [] if known else [one for one in set(below[product]) if one not in sizes]
            if not known:
                sizes[product] = 0  # until everything below it is known
            elif sizes[product] == 0:
                sizes[product] = 1 + sum(sizes[one] for one in below[product])
            if known:
                pending.pop()
            pending += left
        return sum(sizes[root] for root in roots)

    def product_of(self, mark: str) -> int:
        """Index of the product whose mark a label has; -1 for a label created by the kernel."""
        return _number(mark, _PRODUCT)

    def occurrences_of(self, assembly: int, products: Sequence[int], marks: Sequence[str]) -> list[int]:
        """Indices of the occurrences of an assembly's components; -1 for components that are not occurrences.

        Args:
            assembly: Index of its product.
            products: For each component the index of its product, -1 if it has none.
            marks: For each component the name of its label.
        """
        expected: dict[int, list[int]] = defaultdict(list)
        for index in reversed(self._below.get(assembly, [])):
            expected[self.occurrences[index].product].append(index)
        counts = Counter(products)
        numbers = []
        for product, mark in zip(products, marks, strict=True):
            candidates = expected.get(product, [])
            # In file order, as the kernel builds them; if it built fewer, the mark identifies them.
            if product != NONE and len(candidates) == counts[product]:
                numbers.append(candidates.pop())
                counts[product] -= 1
            else:
                numbers.append(_number(mark, _OCCURRENCE))
        return numbers

    def name_of(self, occurrence: int) -> str:
        """Name of an occurrence; empty for none."""
        return self.occurrences[occurrence].name if occurrence != NONE else ""

    def repeated(self, occurrence: int, matrix: Array) -> Iterator[tuple[int, Array]]:
        """Occurrences that were hidden from the kernel in favour of this one, and their matrices (4, 4) [m].

        Raises:
            MisplacedOccurrence: The kernel places this one differently than expected.
        """
        repetition = self._repetitions.get(occurrence)
        if repetition is not None:
            repetition.check(matrix)
            yield from ((index, place) for index, place in repetition.matrices.items() if index != occurrence)

    @staticmethod
    def _mark(definitions: list[Any], usages: Mapping[int, Any]) -> None:
        marked: set[int] = set()
        for index, definition in enumerate(definitions):
            formation = definition.Formation()
            product = formation.OfProduct() if formation is not None else None
            if product is None or id(product) in marked:  # one product, two definitions: each needs a mark of its own
                product = StepBasic_Product()
                formation = StepBasic_ProductDefinitionFormation()
                formation.SetOfProduct(product)
                definition.SetFormation(formation)
            marked.add(id(product))
            product.SetName(TCollection_HAsciiString(f"{_PRODUCT}{index}"))
        for index, usage in usages.items():
            mark = TCollection_HAsciiString(f"{_OCCURRENCE}{index}")
            usage.SetName(mark)
            usage.SetDescription(mark)


def _number(mark: str, prefix: str) -> int:
    return int(mark.removeprefix(prefix)) if mark.startswith(prefix) else NONE


def _product_name(definition: Any) -> str:
    """The name of the product, else its id, as displayed by CAD programs."""
    formation = definition.Formation()
    product = formation.OfProduct() if formation is not None else None
    return _first(product.Name(), product.Id()) if product is not None else ""


def _occurrence_name(usage: Any) -> str:
    """The description, else the name, else the id: the order of other programs based on this kernel."""
    return _first(usage.Description() if usage.HasDescription() else None, usage.Name(), usage.Id())


def _first(*strings: Any) -> str:
    return next((name for name in map(text, strings) if name.strip()), "")


def _precisions(session: Any) -> dict[int, float]:
    """For each product definition, by identity, the uncertainty [mm] of its shape."""
    precisions: dict[int, float] = {}
    for relation in entities(session, StepShape_ShapeDefinitionRepresentation):
        shape = relation.Definition().Value()
        if not isinstance(shape, StepRepr_ProductDefinitionShape) or relation.UsedRepresentation() is None:
            continue
        definition = shape.Definition().Value()
        if isinstance(definition, StepBasic_ProductDefinition):
            precisions.setdefault(id(definition), precision(relation.UsedRepresentation().ContextOfItems()))
    return precisions
