"""Products that occur many times in one assembly: placed here, because the kernel's time is quadratic in their number.

Only the first of such occurrences is left in the model for the kernel; five thousand screws take 0.03 s instead of 18.
The others are placed by the kernel's formula, and only if that gives the kernel's own pose for the first.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from typing import Any

from msgspec import Struct
from OCP.gp import gp_Ax3, gp_Trsf
from OCP.StepBasic import StepBasic_ProductDefinition
from OCP.StepData import StepData_Factors
from OCP.StepGeom import StepGeom_Axis2Placement3d
from OCP.StepRepr import StepRepr_ProductDefinitionShape, StepRepr_ShapeRepresentationRelationshipWithTransformation
from OCP.StepShape import StepShape_ContextDependentShapeRepresentation, StepShape_ShapeDefinitionRepresentation
from OCP.StepToGeom import StepToGeom
from OCP.StepVisual import StepVisual_PresentationStyleByContext

from stepbot.geometry.spatial import Array
from stepbot.step.assembly import Component, MeshTolerance, ReadOptions

from ..exchange.length_unit import unit_factors
from ..exchange.selection import entities, items
from ..kernel import is_same_motion, matrices_of
from .paths import ComponentPaths, nearest_claim

MANY = 16
"""Number of occurrences of one product in one assembly up to which the kernel places them all."""


class MisplacedOccurrence(Exception):
    """The kernel places an occurrence differently from the formula here: all must be left to it."""


class Repetition(Struct, frozen=True, eq=False):
    """Occurrences of one product in one assembly."""

    first: int
    """Index of the occurrence that the kernel places."""
    matrices: dict[int, Array]
    """For each occurrence, including the first, its matrix (4, 4) [m] in the assembly."""

    def check(self, placed: Array) -> None:
        """Compare with the kernel's pose of the first one.

        Raises:
            MisplacedOccurrence: The poses differ.
        """
        if not is_same_motion(self.matrices[self.first], placed):
            raise MisplacedOccurrence


def take_out_repetitions(session: Any, usages: Sequence[Any], keys: Sequence[tuple[int, int]]) -> list[Repetition]:
    """Remove all but the first of many equal occurrences from the model.

    Args:
        session: The reader's work session.
        keys: For each of them the index of the assembly and that of the product.

    Returns:
        The removed occurrences; those that are placed in an unusual way, or coloured, are left to the kernel.
    """
    groups: dict[tuple[int, int], list[int]] = defaultdict(list)
    for index, key in enumerate(keys):
        groups[key].append(index)
    many = [group for key, group in groups.items() if len(group) > MANY and min(key) >= 0]
    if not many or entities(session, StepVisual_PresentationStyleByContext):
        return []
    placements = _Placements(session)
    elsewhere = StepBasic_ProductDefinition()
    taken = []
    for group in many:
        motions = list(placements.of([usages[index] for index in group]))
        if len(motions) < len(group):
            continue
        taken.append(Repetition(group[0], dict(zip(group, matrices_of(motions), strict=True))))
        for index in group[1:]:
            usages[index].SetRelatingProductDefinition(elsewhere)
    return taken


class _Placements:
    """Placements of the occurrences in a file."""

    def __init__(self, session: Any) -> None:
        self._kept: list[Any] = []  # entities are compared by identity, so they must not be created again
        self._relations: dict[int, list[Any]] = defaultdict(list)
        for context in entities(session, StepShape_ContextDependentShapeRepresentation):
            shape = context.RepresentedProductRelation()
            usage = shape.Definition().Value() if shape is not None else None
            self._relations[id(usage)].append(context.RepresentationRelation())
            self._kept.append(usage)
        self._shapes: dict[int, set[int]] = defaultdict(set)
        for relation in entities(session, StepShape_ShapeDefinitionRepresentation):
            shape = relation.Definition().Value()
            if isinstance(shape, StepRepr_ProductDefinitionShape):
                definition, representation = shape.Definition().Value(), relation.UsedRepresentation()
                self._shapes[id(definition)].add(id(representation))
                self._kept += [definition, representation]
        self._items: dict[int, set[int]] = {}
        self._factors: dict[int, StepData_Factors | None] = {}
        self._frames: dict[tuple[int, int], gp_Ax3] = {}

    def of(self, usages: Sequence[Any]) -> Iterator[gp_Trsf]:
        """Motions [mm] of occurrences of one product in one assembly; none of those that are not placed as usual."""
        ends = usages[0].RelatedProductDefinition(), usages[0].RelatingProductDefinition()
        own, above = (self._shapes[id(end)] for end in ends)
        for usage in usages:
            if (motion := self._motion(usage, own, above)) is not None:
                yield motion

    def _motion(self, usage: Any, own_shapes: Collection[int], shapes_above: Collection[int]) -> gp_Trsf | None:
        relations = self._relations[id(usage)]
        if len(relations) != 1 or not isinstance(
            relations[0], StepRepr_ShapeRepresentationRelationshipWithTransformation
        ):
            return None
        operator = relations[0].TransformationOperator().ItemDefinedTransformation()
        if operator is None:
            return None
        own, above = relations[0].Rep1(), relations[0].Rep2()
        if id(own) not in own_shapes or id(above) not in shapes_above:
            return None
        start, end = operator.TransformItem1(), operator.TransformItem2()
        frames = self._frame(start, own), self._frame(end, above)
        if frames[0] is None or frames[1] is None:
            return None
        motion = gp_Trsf()
        motion.SetTransformation(frames[1], frames[0])
        return motion

    def _frame(self, placement: Any, representation: Any) -> gp_Ax3 | None:
        """An axis placement [mm] that is an item of a representation."""
        if not isinstance(placement, StepGeom_Axis2Placement3d):
            return None
        key = id(representation)
        if key not in self._items:
            listed = list(items(representation))
            self._kept += [representation, *listed]
            self._items[key] = {id(item) for item in listed}
            self._factors[key] = _factors(representation.ContextOfItems())
        factors = self._factors[key]
        if id(placement) not in self._items[key] or factors is None:
            return None
        known = id(placement), key
        if known not in self._frames:
            made = StepToGeom.MakeAxis2Placement_s(placement, factors)
            if made is None:  # the placement lacks its point
                return None
            self._frames[known] = gp_Ax3(made.Ax2())
        return self._frames[known]


def _factors(context: Any) -> StepData_Factors | None:
    units = unit_factors(context)
    if units is None or not units.LengthDone():
        return None
    factors = StepData_Factors()
    factors.SetCascadeUnit(1.0)
    factors.InitializeFactors(units.LengthFactor(), 1.0, 1.0)
    return factors


def definition_tolerances(
    components: Sequence[Component], bodies: Sequence[int], options: ReadOptions
) -> list[tuple[MeshTolerance, ...]]:
    """For each distinct body, the distinct tolerances of its components.

    Args:
        components: All components; a pattern that matches none of them is reported elsewhere.
        bodies: For each index in :attr:`Component.body`, its distinct body.
        options: The default, and patterns with their tolerances; the nearest claim
            applies, as it does for links.
    """
    claims: list[tuple[Sequence[int], MeshTolerance]] = []
    if options.tolerance_of:
        paths = ComponentPaths(components)
        claims = [(paths.find(pattern).indices, tolerance) for pattern, tolerance in options.tolerance_of]
    effective = nearest_claim(components, claims, options.tolerance)
    claimed: list[dict[MeshTolerance, None]] = [{} for _ in range(max(bodies, default=-1) + 1)]
    for component, tolerance in zip(components, effective, strict=True):
        if component.body >= 0:
            claimed[bodies[component.body]][tolerance] = None
    return [tuple(tolerances) or (options.tolerance,) for tolerances in claimed]
