"""Builds the links: shapes, and mass properties summed over components with the source of each component's mass."""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import Bodies, MassProperties, without_residue
from stepbot.geometry.poses import Poses
from stepbot.geometry.spatial import Pose
from stepbot.report.robot import MeasuredBody
from stepbot.robot.model import GREY, ComponentMass, Link, Visual
from stepbot.sidecar.document import InertialSection
from stepbot.step.structure.paths import quoted

from .assets import MeshAssets
from .binder import Binder, listed
from .claims import Claims
from .collisions import Collisions, PlacedComponent
from .fitted_collisions import FittedCollisions
from .material_assignment import PLACEHOLDER, PLACEHOLDER_DENSITY, MaterialAssignment, default_color


def visuals(binder: Binder, assets: MeshAssets, link: str, parts: Sequence[PlacedComponent]) -> tuple[Visual, ...]:
    """Visual geometry of a link, by component in file order; a component's ``visual`` overrides its link's."""
    assembly = binder.assembly
    drawn = binder.document.links[link].visual is not False
    default = default_color(binder.document) or GREY
    visuals = []
    for part in parts:
        component = assembly.components[part.index]
        if part.material.visual is False or (part.material.visual is None and not drawn):
            continue
        if not len(assembly.bodies[component.body].mesh.faces):
            continue
        groups = assets.by_color(component.body, component, part.material.color, default)
        visuals += [(group, part.X_LC, component.path) for group in groups]
    return tuple(
        Visual(f"{link}_visual_{i}", group.geometry, X_LG, group.rgba, path)
        for i, (group, X_LG, path) in enumerate(visuals, start=1)
    )


class Links:
    """Builds links from their components."""

    def __init__(
        self,
        binder: Binder,
        claims: Claims,
        assignments: Sequence[MaterialAssignment],
        masses: Mapping[int, ComponentMass],
        bodies: Sequence[MeasuredBody],
        fitted: FittedCollisions,
    ) -> None:
        self._binder = binder
        self._of = assignments
        self._masses = masses
        self._used = [body.used or MassProperties() for body in bodies]  # only components with a volume have a mass
        self._parts = {link: claims.parts_of(link) for link in binder.document.links}
        self.assets = MeshAssets(binder.assembly)
        self._collisions = Collisions(binder, self.assets, fitted)

    def report_unknown_masses(self) -> None:
        """One error for all components with a missing mass, and one for each link without a centre of mass.

        Components with the placeholder density are one warning.
        """
        unknown: list[int] = []
        guessed: list[int] = []
        for name, section in self._binder.document.links.items():
            weighed = [index for index in self._parts[name] if index in self._masses]
            if section.inertial is None:
                unknown += [index for index in weighed if self._masses[index].mass is None]
                guessed += [index for index in weighed if self._masses[index].origin == PLACEHOLDER]
            elif not is_complete(section.inertial) and not weighed:
                self._binder.report(
                    "SB503",
                    ("links", name, "inertial"),
                    "com and inertia cannot be computed: its parts have no volume",
                    help=("give `com` and `inertia` with `mass`",),
                )
        if guessed:
            self._report_placeholder(sorted(guessed))
        if unknown:
            paths = tuple(quoted(self._binder.path(index)) for index in sorted(unknown))
            count = f"{len(paths)} components have" if len(paths) > 1 else f"component {paths[0]} has"
            materials = [name for i in unknown if (name := self._binder.assembly.components[i].material.strip())]
            listed_materials = [
                f"or define the material of the STEP: `materials: {{{quoted(name)}: {{density: 1240 kg/m^3}}}}`"
                for name in list(dict.fromkeys(materials))[:3]
            ]
            self._binder.diagnostics.add(
                "SB501",
                f"{self._binder.assembly.source}: {count} no density",
                self._binder.span(("defaults",)),
                help=(
                    "set a default: `defaults: {density: 1240 kg/m^3}`",
                    f"or set it for one component: `parts: {{{paths[0]}: {{density: 1240 kg/m^3}}}}`, or its `mass`",
                    *listed_materials,
                ),
                notes=listed(paths),
            )

    def _report_placeholder(self, guessed: list[int]) -> None:
        paths = tuple(quoted(self._binder.path(index)) for index in guessed)
        count = f"{len(paths)} components have" if len(paths) > 1 else f"component {paths[0]} has"
        mass = exact_sum(self._masses[index].mass or 0.0 for index in guessed)
        self._binder.report(
            "SB522",
            ("defaults", "density"),
            f"{count} the placeholder `todo` as density: {PLACEHOLDER_DENSITY:g} kg/m^3, {mass:.3g} kg in total",
            help=(
                "write the density of their material: `defaults: {density: 1240 kg/m^3}`",
                f"or of one component: `parts: {{{paths[0]}: {{density: 1240 kg/m^3}}}}`, or its weighed `mass`",
            ),
            notes=listed(paths),
        )

    def build(self, name: str, X_WL: Pose) -> Link:
        """Build one link, whose frame as drawn is X_WL."""
        components = self._binder.assembly.components
        indices = self._parts[name]
        X_LC = Poses.of(components[i].X_WC for i in indices).seen_from(X_WL.inverse()).tidy()
        parts = [PlacedComponent(i, self._of[i], pose) for i, pose in zip(indices, X_LC.listed(), strict=True)]
        properties, masses = self._mass(name, parts)
        return Link(
            name,
            properties,
            visuals(self._binder, self.assets, name, parts),
            self._collisions.of(name, parts),
            masses,
            tuple(components[part.index].path for part in parts),
        )

    def report_flat(self) -> None:
        """Report components without collision geometry, and what budgets do to it."""
        self._collisions.report_flat()
        self._collisions.report_budgets()

    def _mass(self, name: str, parts: Sequence[PlacedComponent]) -> tuple[MassProperties, tuple[ComponentMass, ...]]:
        inertial = self._binder.document.links[name].inertial
        if inertial is not None and is_complete(inertial):
            given = ComponentMass("", inertial.mass, None, None, f"inertial of link '{name}'", "given")
            return overruled(MassProperties(), inertial), (given,)
        weighed = [part for part in parts if part.index in self._masses]
        # If an `inertial` gives the total, parts without a density share it by volume.
        by_volume = inertial is not None and any(self._masses[part.index].mass is None for part in weighed)
        masses = tuple(self._masses[part.index] for part in weighed)
        densities = np.array([1.0 if by_volume else _density(known) for known in masses], dtype=np.float64)
        components = self._binder.assembly.components
        bodies = Bodies.of(self._used, [components[part.index].body for part in weighed]).scaled(densities)
        computed = without_residue(bodies.moved(Poses.of(part.X_LC for part in weighed)).combined())
        if inertial is None:
            return computed, masses
        factor = inertial.mass / computed.mass
        origin = f"inertial of link '{name}'"
        return overruled(computed.scaled(factor), inertial), tuple(
            replace(known, mass=mass * factor, density=None, origin=origin)
            for known, mass in zip(masses, bodies.mass.tolist(), strict=True)
        )


def _density(known: ComponentMass) -> float:
    """Density [kg/m^3] of a component with a known mass."""
    if known.density is not None:
        return known.density
    assert known.mass is not None
    assert known.volume is not None
    return known.mass / known.volume


def is_complete(inertial: InertialSection) -> bool:
    """Whether an ``inertial`` is complete, so that nothing needs to be computed."""
    return inertial.com is not None and inertial.inertia is not None


def overruled(computed: MassProperties, inertial: InertialSection) -> MassProperties:
    """Mass properties with the values of an ``inertial`` in place of computed ones."""
    com = computed.com if inertial.com is None else inertial.com
    given = inertial.inertia
    if given is None:
        return replace(computed, mass=inertial.mass, com=com)
    tensor = [[given.ixx, given.ixy, given.ixz], [given.ixy, given.iyy, given.iyz], [given.ixz, given.iyz, given.izz]]
    return MassProperties.of(inertial.mass, com, np.array(tensor))
