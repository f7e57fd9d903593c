"""Materials and densities in a STEP file, converted to kg/m^3.

A density is a measure with a derived unit, attached to a product definition; a name is a descriptive item beside it,
the product of a raw material that the part is made from, or a material designation. The kernel's own reader drops the
mass unit and every unit that is not SI, so the model is queried directly.
"""

import math
from typing import Any

from msgspec import Struct, field
from OCP.StepBasic import StepBasic_ProductDefinition
from OCP.StepRepr import (
    StepRepr_DescriptiveRepresentationItem,
    StepRepr_MakeFromUsageOption,
    StepRepr_MaterialDesignation,
    StepRepr_PropertyDefinition,
    StepRepr_PropertyDefinitionRepresentation,
)

from stepbot.diagnostics import Diagnostics, Span

from ..exchange.declared_units import derived_unit, measure_of
from ..exchange.selection import described_by, entities, items, shaped, text
from .source import StepMaterial


class _Claims(Struct):
    """The material of one product definition in the file."""

    names: list[str] = field(default_factory=list)
    densities: list[float] = field(default_factory=list)


class Materials:
    """Materials of the product definitions of one file."""

    def __init__(self, session: Any, place: str, diagnostics: Diagnostics) -> None:
        """Read them all."""
        # By identity; a reference is kept, so that its id stays unique.
        self._claims: dict[int, tuple[Any, _Claims]] = {}
        strange: list[str] = []
        for relation in entities(session, StepRepr_PropertyDefinitionRepresentation):
            self._read_property(relation, strange)
        for designation in entities(session, StepRepr_MaterialDesignation):
            definition = shaped(designation.OfDefinition().Value())
            if isinstance(definition, StepBasic_ProductDefinition):
                self._of(definition).names.append(text(designation.Name()))
        for usage in entities(session, StepRepr_MakeFromUsageOption):
            self._read_raw_material(usage)
        if strange:
            diagnostics.add(
                "SB211",
                f"{len(strange)} densities in the file have no density unit and are ignored",
                Span(place),
                help=["set densities in the sidecar, under `parts` or `defaults`"],
                notes=[f"a density of {value}" for value in [*dict.fromkeys(strange)][:3]],
            )
        self._place, self._diagnostics = place, diagnostics

    def of(self, definition: Any, product: str) -> StepMaterial:
        """The material of a product definition; contradictory densities count as missing.

        Args:
            product: Name of the product, for diagnostics.
        """
        if id(definition) not in self._claims:
            return StepMaterial()
        claims = self._claims[id(definition)][1]
        densities = list(dict.fromkeys(claims.densities))
        name = next((name for name in claims.names if name.strip()), "")
        if len(densities) > 1 and not math.isclose(min(densities), max(densities), rel_tol=1e-6):
            values = ", ".join(f"{value:g}" for value in densities)
            self._diagnostics.add(
                "SB211",
                f"'{product}': several densities in the file: {values} kg/m^3",
                Span(self._place),
                help=["set the right one in the sidecar, under `parts`"],
            )
            return StepMaterial(name)
        return StepMaterial(name, densities[0] if densities else None)

    def _of(self, definition: Any) -> _Claims:
        return self._claims.setdefault(id(definition), (definition, _Claims()))[1]

    def _read_property(self, relation: Any, strange: list[str]) -> None:
        """Add a density or a material's name from one property of a product definition."""
        property_definition = relation.Definition().Value()
        if not isinstance(property_definition, StepRepr_PropertyDefinition) or relation.UsedRepresentation() is None:
            return
        definition = described_by(property_definition)
        if not isinstance(definition, StepBasic_ProductDefinition):
            return
        title = " ".join((_described(property_definition), text(relation.UsedRepresentation().Name()))).lower()
        for item in items(relation.UsedRepresentation()):
            if isinstance(item, StepRepr_DescriptiveRepresentationItem):
                if "material" in title and (name := _material_name(item)):
                    self._of(definition).names.append(name)
            elif (measure := measure_of(item)) is not None:
                self._read_measure(definition, measure, "density" in title, strange)

    def _read_measure(self, definition: Any, measure: Any, is_density: bool, strange: list[str]) -> None:
        value = measure.ValueComponent()
        unit = derived_unit(measure)
        if unit is None or unit.dimensions != (1.0, -3.0):
            if is_density:
                strange.append(f"{value:g} {unit.name if unit else 'without unit'}")
            return
        density = value * unit.size
        if density > 0.0 and math.isfinite(density):
            # Without rounding errors of the conversion: 7.85 g/cm^3 is 7850, not 7849.999999999999.
            self._of(definition).densities.append(float(f"{density:.12g}"))
        elif density != 0.0:  # zero means unset
            strange.append(f"{value:g} {unit.name}")

    def _read_raw_material(self, usage: Any) -> None:
        """A part made from another product has its density, and its name as the material's."""
        part, raw = usage.RelatingProductDefinition(), usage.RelatedProductDefinition()
        if part is None or raw is None or id(raw) not in self._claims:
            return
        formation = raw.Formation()
        product = formation.OfProduct() if formation is not None else None
        name = (text(product.Name()) or text(product.Id())) if product is not None else ""
        claims = self._of(part)
        claims.names += [*self._claims[id(raw)][1].names, name]
        claims.densities += self._claims[id(raw)][1].densities


def _material_name(item: Any) -> str:
    """The name in a descriptive item; its description if the name is only a label."""
    name = text(item.Name()).strip()
    return text(item.Description()).strip() if name.lower() in ("", "material", "material name") else name


def _described(property_definition: Any) -> str:
    description = property_definition.Description() if property_definition.HasDescription() else None
    return f"{text(property_definition.Name())} {text(description)}"
