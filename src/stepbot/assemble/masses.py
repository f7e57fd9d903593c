"""Mass of each component: density times volume, or its share of a given mass.

A given mass on a component scales it; on a subassembly it is the total of each occurrence, divided among the components
below it by computed mass, or by volume if any density is missing there. Given masses below it are kept, and the
remainder is divided; if the remainder is not positive, only the outer mass counts. Ignored components get no mass.
"""

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.diagnostics import Finding
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, Pose
from stepbot.report.robot import MeasuredBody
from stepbot.robot.inertial_doubts import density_doubt, inertial_doubts
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import ComponentMass, Joint, Link
from stepbot.robot.validity import inertia_fault
from stepbot.sidecar.document import Document, MassMode, MeshSection
from stepbot.step.assembly import MeshTolerance, ReadOptions
from stepbot.step.structure.paths import subtree_ends

from .binder import Binder
from .claims import Claims
from .material_assignment import GivenMass, MaterialAssignment

MASS_TOLERANCE = 1e-3
"""Relative deviation from the exact mass properties up to which a mesh counts as equal."""


def read_options(document: Document) -> ReadOptions:
    """Options for reading the sidecar's STEP; a link's own tolerance applies to its parts.

    If a link has its own, the paths of all links count: a part of one link may be inside a subassembly of another.
    """
    common = _tolerance(document.mesh, MeshTolerance())
    links = [(link, common if link.mesh is None else _tolerance(link.mesh, common)) for link in document.links.values()]
    is_own = any(tolerance != common for _, tolerance in links)
    return ReadOptions(
        tolerance=next((tolerance for link, tolerance in links if link.rest), common),
        tolerance_of=tuple((path, tolerance) for link, tolerance in links for path in link.parts) if is_own else (),
        encoding=document.step_encoding or "",
        refine_mass_to=MASS_TOLERANCE if document.mass == MassMode.MESH else 0.0,
    )


def _tolerance(section: MeshSection, inherited: MeshTolerance) -> MeshTolerance:
    relative, absolute = inherited.relative, inherited.absolute
    if section.tolerance is not None:
        relative, absolute = section.tolerance
    angle = inherited.angle if section.angle is None else section.angle
    return MeshTolerance(relative, absolute, angle)


_EQUAL = 1e-9


def masses(
    binder: Binder, materials: Sequence[MaterialAssignment], bodies: Sequence[MeasuredBody]
) -> dict[int, ComponentMass]:
    """Mass of every component that has a volume and is not ignored, by index."""
    computed: dict[int, ComponentMass] = {}
    for component in binder.assembly.components:
        assignment = materials[component.index]
        body = bodies[component.body] if component.body >= 0 else None
        if body is not None and body.used is not None and not assignment.ignored:
            volume, density = body.used.mass, assignment.density
            computed[component.index] = ComponentMass(
                component.path,
                None if density is None else density * volume,
                density,
                volume,
                assignment.density_origin,
                body.written,
                assignment.material,
            )
    return _Sharing(binder, materials, computed).settle()


class _Sharing:
    """Divides given masses among the components below them."""

    def __init__(
        self, binder: Binder, materials: Sequence[MaterialAssignment], computed: dict[int, ComponentMass]
    ) -> None:
        self._binder = binder
        self._materials = materials
        self._computed = computed
        self._ends = subtree_ends(binder.assembly.components)
        self._empty: dict[str, int] = {}
        self._heavy: set[str] = set()
        self._given = {
            index: one.given
            for index, one in enumerate(materials)
            if one.given is not None and self._has_volume(index, one.given)
        }
        self._indices = list(self._given)
        self._result = dict(computed)

    def settle(self) -> dict[int, ComponentMass]:
        for index in self._topmost(0, len(self._ends)):
            self._settle(index, self._given[index])
        return self._result

    def _settle(self, index: int, given: GivenMass) -> None:
        """Divide one mass among the components below a component."""
        end = self._ends[index]
        inner = self._topmost(index + 1, end, beside=given.pattern)
        inside = {i for at in inner for i in range(at, self._ends[at])}
        members = [i for i in range(index, end) if i in self._computed and i not in inside]
        rest = given.mass - exact_sum(self._given[i].mass for i in inner)
        fits = rest > _EQUAL * given.mass if members else abs(rest) <= _EQUAL * given.mass
        if inner and not fits:
            self._report_contradiction(index, given, inner)
            self._share([i for i in range(index, end) if i in self._computed], given, given.mass)
            return
        self._share(members, given, rest)
        for i in inner:
            self._settle(i, self._given[i])

    def _share(self, members: list[int], given: GivenMass, total: float) -> None:
        parts = [self._computed[i] for i in members]
        self._report_density(given, total, exact_sum(part.volume or 0.0 for part in parts))
        computed = [part.mass for part in parts if part.mass is not None]
        weights = computed if len(computed) == len(parts) else [part.volume or 0.0 for part in parts]
        whole = exact_sum(weights)
        for i, part, weight in zip(members, parts, weights, strict=True):
            self._result[i] = replace(part, mass=total * weight / whole, density=None, origin=given.origin)

    def _report_density(self, given: GivenMass, mass: float, volume: float) -> None:
        """Warn, once for each rule, of a mass that no material has in this volume: grams without a unit."""
        doubt = density_doubt(mass, volume, self._binder.sidecar.plain_number(*given.keys) is None)
        if doubt is None or given.pattern in self._heavy:
            return
        self._heavy.add(given.pattern)
        whole = "a mass is that of each component that the path matches, with everything below it"
        self._binder.report(doubt.code, given.keys, doubt.message, help=(*doubt.help, whole))

    def _topmost(self, start: int, end: int, beside: str = "") -> list[int]:
        """Topmost components with a given mass in a range of indices, without those of the rule ``beside``."""
        top: list[int] = []
        for index in self._indices[bisect_left(self._indices, start) : bisect_left(self._indices, end)]:
            if self._given[index].pattern != beside and (not top or index >= self._ends[top[-1]]):
                top.append(index)
        return top

    def _has_volume(self, index: int, given: GivenMass) -> bool:
        """Whether any component below can receive a mass; reports an error if one should."""
        below = range(index, self._ends[index])
        if any(i in self._computed for i in below):
            return True
        if any(self._binder.assembly.components[i].body >= 0 and not self._materials[i].ignored for i in below):
            pattern = given.pattern
            if index < self._empty.get(pattern, 0):
                return False  # an enclosing component has reported it
            self._empty[pattern] = self._ends[index]
            self._binder.report(
                "SB503",
                given.keys,
                f"'{self._binder.path(index)}' has no volume for its mass of {given.mass:g} kg",
                help=(
                    "give its link an `inertial` with mass, com and inertia, or set `mass` on a component with solids",
                ),
            )
        return False

    def _report_contradiction(self, index: int, given: GivenMass, inner: list[int]) -> None:
        within = exact_sum(self._given[i].mass for i in inner)
        self._binder.report(
            "SB504",
            given.keys,
            f"'{self._binder.path(index)}' weighs {given.mass:g} kg, but the masses below it add up to {within:g} kg",
            notes=tuple(
                f"'{self._binder.path(i)}': {self._given[i].mass:g} kg by {self._given[i].origin}" for i in inner
            ),
        )


_UNDRAWN = "if the maker publishes this value, or the CAD omits a heavy part, ignore it with the reason: "


def report_given_inertials(
    binder: Binder, claims: Claims, links: Sequence[Link], joints: Sequence[Joint], X_WL: Mapping[str, Pose]
) -> None:
    """Warn about each given mass, com and inertia that nothing within the link's geometry has.

    The geometry is that of all solids and surfaces of the link and of the links fixed to it: descriptions often draw
    on one link what they weigh on another. Links without geometry are not checked.
    """
    body_of = rigid_bodies(links[0].name, joints)
    for link in links:
        section = binder.document.links[link.name].inertial
        if section is None:
            continue
        members = [name for name in binder.document.links if body_of[name] == body_of[link.name]]
        has_unit = binder.sidecar.plain_number("links", link.name, "inertial", "mass") is None
        heavy = density_doubt(section.mass, _volume(binder, claims, members), has_unit)
        if heavy is not None:
            _report(binder, link.name, heavy, "mass")
        if section.com is None and section.inertia is None:
            continue
        if inertia_fault(link.mass_properties) or not link.mass_properties.mass:
            continue  # an error of its own
        points = _points(binder, claims, members, X_WL[link.name].inverse())
        for doubt in inertial_doubts(link.mass_properties, points):
            _report(binder, link.name, doubt)


def _report(binder: Binder, link: str, doubt: Finding, *key: str) -> None:
    ignored = f"{_UNDRAWN}`ignore_findings: [{{code: {doubt.code}, reason: ...}}]`"
    binder.report(doubt.code, ("links", link, "inertial", *key), doubt.message, help=(*doubt.help, ignored))


def _volume(binder: Binder, claims: Claims, links: Iterable[str]) -> float:
    """Volume [m^3] of all solids of links; 0 with other bodies, whose thickness is unknown."""
    components, bodies = binder.assembly.components, binder.assembly.bodies
    drawn = [components[index].body for link in links for index in claims.parts_of(link)]
    exact = [bodies[body].exact for body in drawn if body >= 0]
    volumes = [one.volume for one in exact if one is not None]
    return exact_sum(volumes) if len(volumes) == len(exact) else 0.0


def _points(binder: Binder, claims: Claims, links: Iterable[str], X_LW: Pose) -> Array:
    """Vertices (n, 3) [m] of all bodies of links, in the frame L."""
    assembly = binder.assembly
    points = [np.zeros((0, 3))]
    for index in (index for link in links for index in claims.parts_of(link)):
        component = assembly.components[index]
        if component.body >= 0:
            points.append((X_LW @ component.X_WC).apply(assembly.bodies[component.body].mesh.vertices))
    return np.concatenate(points)
