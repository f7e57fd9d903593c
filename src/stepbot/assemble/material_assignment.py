"""Material and display of each component: fields from the sidecar's ``parts``, the STEP and the defaults.

Each field comes from the first rule that sets it, on the component or an ancestor. A rule with ``material`` sets the
density and colour of that material, unless the rule sets one of them itself. For a material named only in the STEP, the
density comes from the sidecar's ``materials``.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.robot.model import Rgba
from stepbot.sidecar.contact import Contact
from stepbot.sidecar.document import Document, MaterialSection, PartRule, StepDensity
from stepbot.sidecar.shapes import Derived
from stepbot.sidecar.tree import Keys, subject
from stepbot.step.assembly import BodyKind, Component
from stepbot.step.structure.paths import quoted

from .binder import Binder, listed


class ShadowedRules:
    """The fields of each rule that earlier rules set on all of its components, to other values."""

    def __init__(self, binder: Binder) -> None:
        self._binder = binder
        self._rules = list(binder.document.parts.items())
        self._matches: dict[int, dict[str, list[int]]] = {}

    def note(self, rule: int, field: str, earlier: Iterable[int]) -> None:
        """Take one field of a rule.

        Args:
            earlier: For each component that it covers, the number of the rule that has set the field; -1 for none.
        """
        above = [int(number) for number in earlier]
        others = [n for n in dict.fromkeys(above) if n >= 0 and self._value(n, field) != self._value(rule, field)]
        if above and min(above) >= 0 and others:
            self._matches.setdefault(rule, {})[field] = others

    def report(self) -> None:
        """Report SB306, one for each rule."""
        for rule, fields in self._matches.items():
            pattern = self._rules[rule][0]
            above = [self._rules[n][0] for n in sorted({n for numbers in fields.values() for n in numbers})]
            named = " and ".join(f"'{one}'" for one in above[:_NAMED])
            more = f" and {len(above) - _NAMED} more" if len(above) > _NAMED else ""
            what = ", ".join(f"'{field}'" for field in fields)
            self._binder.report(
                "SB306",
                ("parts", pattern),
                f"{what} without effect: set by {named}{more} above",
                help=(f"of several rules the first holds: move this rule above '{above[0]}', or remove it",),
            )

    def _value(self, rule: int, field: str) -> object:
        """What a rule sets; a density or a colour may come from its material."""
        given = self._rules[rule][1]
        if field in ("density", "color"):
            return (getattr(given, field), given.material)
        return getattr(given, field)


_NAMED = 2
"""Maximum number of rules that a message names."""


PLACEHOLDER_DENSITY = 1000.0
"""Density [kg/m^3] of `todo`: between plastics and light metals, and easy to recognize."""
PLACEHOLDER = "defaults: todo"
"""Source of a density that is not known yet."""


class GivenMass(Struct, frozen=True):
    """A mass that the sidecar gives to a component and everything below it."""

    mass: float
    """[kg]."""
    pattern: str
    """The rule's path or glob."""
    actuator: str = ""
    """The actuator whose motor has this mass; empty for a rule of ``parts``."""

    @property
    def keys(self) -> Keys:
        """Its place in the sidecar."""
        return ("actuators", self.actuator, "part") if self.actuator else ("parts", self.pattern, "mass")

    @property
    def origin(self) -> str:
        """The source of the mass."""
        return f"motor of {subject(self.keys[:2])}" if self.actuator else subject(self.keys[:2])


class MaterialAssignment(Struct, frozen=True):
    """The material, colour and geometry settings of one component."""

    ignored: bool = False
    density: float | None = None
    """[kg/m^3]; None if no source gives one."""
    density_origin: str = ""
    """``parts rule '**/Cover'``, ``STEP``, ``material 'pla' in the STEP``, ``defaults``; empty without a density."""
    material: str = ""
    """The material whose density this is, in the sidecar or the STEP; empty if none is named."""
    color: Rgba | None = None
    """Colour that overrides the STEP's."""
    visual: bool | None = None
    collision: Derived | None = None
    """How its collision geometry is made; None if no rule sets it."""
    contact: Contact | None = None
    """Its contact properties; None if no rule sets them."""
    given: GivenMass | None = None
    """The mass of it and everything below it; its ancestors may have one as well."""


def assign_materials(binder: Binder) -> tuple[MaterialAssignment, ...]:
    """Apply every rule of ``parts`` to the components that it matches."""
    document, components = binder.document, binder.assembly.components
    rules = list(document.parts.items())
    first = {field: np.full(len(components), -1) for field in _SETS}
    shadowed = ShadowedRules(binder)
    given: dict[int, GivenMass] = {}
    for i, (pattern, rule) in enumerate(rules):
        named = binder.all(pattern, ("parts", pattern))
        covered = np.zeros(len(components), dtype=bool)
        covered[binder.paths.below(named)] = True
        for field, sets in _SETS.items():
            if sets(rule, document):
                shadowed.note(i, field, first[field][covered])
                first[field][covered & (first[field] < 0)] = i
        if rule.mass is not None:
            shadowed.note(i, "mass", [_rule_of_mass(rules, given.get(index)) for index in named])
            for index in named:
                given.setdefault(index, GivenMass(rule.mass, pattern))
    assignments = tuple(
        _assignment(
            component,
            {field: rules[row[component.index]] for field, row in first.items() if row[component.index] >= 0},
            document,
        )
        for component in components
    )
    shadowed.report()
    _give_motor_masses(binder, assignments, given)
    _warn_of_uniform_density(binder, assignments)
    _note_unlisted_materials(binder, assignments)
    return tuple(replace(one, given=given[i]) if i in given else one for i, one in enumerate(assignments))


def _give_motor_masses(binder: Binder, assignments: Sequence[MaterialAssignment], given: dict[int, GivenMass]) -> None:
    """Give the part of a motor its catalogue's mass, if no rule, no subassembly and no density gives it one."""
    components = binder.assembly.components
    for name, motor in binder.sidecar.motors.items():
        figure = motor.figure("mass")
        index = binder.one(motor.part, ("actuators", name, "part")) if motor.part else None
        if figure is None or index is None:
            continue
        above = {index}
        while (parent := components[min(above)].parent) >= 0:
            above.add(parent)
        below = binder.assembly.subtree(index)
        known = any(assignments[i].density_origin not in ("", "defaults", PLACEHOLDER) for i in below)
        if not known and given.keys().isdisjoint(above.union(below)):
            given[index] = GivenMass(figure.value, motor.part, name)


def _rule_of_mass(rules: Sequence[tuple[str, PartRule]], given: GivenMass | None) -> int:
    """The number of the rule that gives a mass; -1 for none."""
    return -1 if given is None else next(i for i, (pattern, _) in enumerate(rules) if pattern == given.pattern)


def default_color(document: Document) -> Rgba | None:
    """Colour of components without one from a rule or the STEP."""
    return document.defaults.color or _material(document, document.defaults.material).color


def _material(document: Document, name: str | None) -> MaterialSection:
    return document.materials.get(name, MaterialSection()) if name is not None else MaterialSection()


def _rule_density(rule: PartRule, document: Document) -> float | None:
    return rule.density if rule.density is not None else _material(document, rule.material).density


def _rule_color(rule: PartRule, document: Document) -> Rgba | None:
    return rule.color if rule.color is not None else _material(document, rule.material).color


_SETS: dict[str, Callable[[PartRule, Document], bool]] = {
    "ignore": lambda rule, document: "ignore" in rule.model_fields_set,
    "density": lambda rule, document: _rule_density(rule, document) is not None,
    "color": lambda rule, document: _rule_color(rule, document) is not None,
    "visual": lambda rule, document: rule.visual is not None,
    "collision": lambda rule, document: rule.collision is not None,
    "contact": lambda rule, document: rule.contact is not None,
}


def _assignment(component: Component, rules: dict[str, tuple[str, PartRule]], document: Document) -> MaterialAssignment:
    """The settings of a component; each field from the rule that takes precedence."""
    density, origin, material = _density(component, rules.get("density"), document)
    return MaterialAssignment(
        ignored="ignore" in rules and rules["ignore"][1].ignore,
        density=density,
        density_origin=origin,
        material=material or "",
        color=_rule_color(rules["color"][1], document) if "color" in rules else None,
        visual=rules["visual"][1].visual if "visual" in rules else None,
        collision=rules["collision"][1].collision if "collision" in rules else None,
        contact=rules["contact"][1].contact if "contact" in rules else None,
    )


def _density(
    component: Component, named: tuple[str, PartRule] | None, document: Document
) -> tuple[float | None, str, str | None]:
    """Density [kg/m^3], its source and the material that has it; a density of zero in the STEP counts as missing."""
    if named is not None:
        rule = named[1]
        return (
            _rule_density(rule, document),
            f"parts rule '{named[0]}'",
            rule.material if rule.density is None else None,
        )
    name = component.material.strip()
    if component.density is not None and document.step_density is StepDensity.USE:
        return component.density, "STEP", name
    if name and (density := _material(document, name).density) is not None:
        return density, f"material '{name}' in the STEP", name
    defaults = document.defaults
    if defaults.density == "todo":
        return PLACEHOLDER_DENSITY, PLACEHOLDER, None
    if defaults.density is not None:
        return defaults.density, "defaults", None
    default = _material(document, defaults.material).density
    return default, "defaults" if default is not None else "", defaults.material


def _warn_of_uniform_density(binder: Binder, assignments: tuple[MaterialAssignment, ...]) -> None:
    """Warn if the STEP's density is used and is the same for every definition."""
    assembly = binder.assembly
    solids = [c for c in assembly.components if c.body >= 0 and assembly.bodies[c.body].kind is not BodyKind.SURFACE]
    densities = {component.density for component in solids}
    definitions = {component.definition for component in solids}
    used = any(assignments[c.index].density_origin == "STEP" and not assignments[c.index].ignored for c in solids)
    if used and len(densities) == 1 and len(definitions) > 1:
        names = sorted({c.material for c in solids if c.material})
        density = f"{next(iter(densities)):g} kg/m^3" + (f" ({', '.join(names)})" if names else "")
        binder.diagnostics.add(
            "SB502",
            f"{assembly.source}: all {len(definitions)} parts have a density of {density}: probably a CAD default",
            binder.span(("step_density",)),
            help=(
                "write `step_density: ignore` and the density of most parts, with exceptions in `parts`; for PLA "
                "`defaults: {density: 1240 kg/m^3}`",
            ),
        )


def _note_unlisted_materials(binder: Binder, assignments: tuple[MaterialAssignment, ...]) -> None:
    """Report materials in the STEP whose parts have the default density because no source gives their own."""
    document, components = binder.document, binder.assembly.components
    unlisted: dict[str, list[int]] = {}
    for component in components:
        name = component.material.strip()
        solid = component.body >= 0 and binder.assembly.bodies[component.body].kind in (
            BodyKind.SOLID,
            BodyKind.TESSELLATED,
        )
        if solid and name and assignments[component.index].density_origin in ("defaults", PLACEHOLDER):
            unlisted.setdefault(name, []).append(component.index)
    if unlisted and document.step_density is StepDensity.USE:
        count = sum(map(len, unlisted.values()))
        parts = f"{count} parts have" if count > 1 else "one part has"
        binder.diagnostics.add(
            "SB515",
            f"{binder.assembly.source}: {parts} a material without a density; the default density is used",
            binder.span(("materials",)),
            help=(f"define it: `materials: {{{quoted(next(iter(unlisted)))}: {{density: ...}}}}`",),
            notes=listed(
                tuple(
                    f"'{name}': {quoted(binder.path(indices[0]))}{_more(indices)}" for name, indices in unlisted.items()
                )
            ),
        )


def _more(indices: list[int]) -> str:
    return f" and {len(indices) - 1} more" if len(indices) > 1 else ""
