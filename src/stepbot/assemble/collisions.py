"""Collision geometry of a link: fitted or derived from its components, or shapes given in the sidecar.

Rules under ``parts`` override the link, which overrides ``defaults``; without any, each component gets its convex hull.
With ``auto`` and ``decompose`` the components of a link are one solid (:mod:`.fitted_collisions`).

A box is aligned with the axes of the component's definition. A cylinder or capsule is aligned with one of these axes or
with the widest axis line of the body, whichever gives the smallest volume; a sphere is the smallest enclosing one.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.enclosing_shapes import box_around, capsule_around, cylinder_around, sphere_around
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.solids.collision_sets import CollisionSet
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.spatial import IDENTITY, Array, Pose, tidy
from stepbot.robot.kinematics import neighbours
from stepbot.robot.mesh_names import ascii_name
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, Geometry, MeshRef, Robot, Sphere
from stepbot.robot.surfaces import Surface
from stepbot.sidecar.contact import surface_of
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.shapes import BoxShape, CapsuleShape, CollisionShape, CylinderShape, Shape
from stepbot.step.features.axes import axis_faces, lines
from stepbot.step.structure.paths import quoted

from .assets import MeshAssets
from .binder import Binder, listed
from .collision_rules import CollisionRule, is_merged, link_rule, part_rule, rule_of, useless_budgets
from .fitted_collisions import FittedCollisions, joined_part, joined_parts
from .material_assignment import MaterialAssignment

_Placed = tuple[Geometry, Pose]


class PlacedComponent(Struct, frozen=True):
    """A component of a link."""

    index: int
    material: MaterialAssignment
    X_LC: Pose


class Collisions:
    """Creates the collision geometry of links."""

    def __init__(self, binder: Binder, assets: MeshAssets, fitted: FittedCollisions) -> None:
        self._binder = binder
        self._assets = assets
        self._fitted = fitted
        self._fits: dict[tuple[int, CollisionRule], _Placed | None] = {}
        self._flat: list[str] = []
        self._coarse: list[str] = []
        self._untouched: dict[str, None] = {}
        """Links that list their shapes, with parts that have contact properties."""

    def of(self, link: str, parts: Sequence[PlacedComponent]) -> tuple[Collision, ...]:
        """Collision geometry of a link: by component in file order, then the shapes of the link as a whole."""
        document = self._binder.document
        given, common = document.links[link].collision, link_rule(link, document)
        contact = document.links[link].contact or document.defaults.contact
        placed: list[tuple[_Placed, Surface]] = []
        whole: list[PlacedComponent] = []
        for part in parts:
            own, touch = part.material.collision, part.material.contact
            rule = part_rule(own, touch, link, document)
            if rule is None and touch is not None:
                self._untouched[link] = None
            if rule is None and common is not None and not (common.is_decomposed or is_merged(link, document)):
                rule = common
            if rule is None:
                whole.append(part)
            else:
                placed += ((shape, surface_of(touch, contact)) for shape in self._component(part, rule))
        if isinstance(given, tuple):
            for shape in given:
                geometry, X_LG = self._given(link, shape)
                placed.append(((geometry, tidy(X_LG)), surface_of(shape.contact, contact)))
        elif common is not None and whole:
            made = self._joined(link, whole, common) if common.is_decomposed else self._merged(link, whole, common)
            placed += ((shape, surface_of(contact)) for shape in made)
        return tuple(
            Collision(f"{link}_collision_{i}", geometry, X_LG, surface)
            for i, ((geometry, X_LG), surface) in enumerate(placed, start=1)
        )

    def report_flat(self) -> None:
        """Warn once about all components that need collision geometry but are too flat for it."""
        if self._flat:
            what = f"{len(self._flat)} components are" if len(self._flat) > 1 else f"{self._flat[0]} is"
            self._binder.diagnostics.add(
                "SB308",
                f"{self._binder.assembly.source}: {what} too flat for a convex hull",
                self._binder.span(("links",)),
                help=("set `collision: none` for them in `parts`, or give the link primitive shapes",),
                notes=listed(tuple(self._flat)),
            )

    def report_budgets(self) -> None:
        """Report settings without effect (SB608), and links whose pieces are coarse because of budgets (SB609)."""
        for place, shape, useless in useless_budgets(self._binder.document):
            if useless:
                what = " and ".join(f"`{name}`" for name in useless)
                have = "has" if len(useless) == 1 else "have"
                message = f"{what} {have} no effect on `{shape.value}`"
                help = ("remove it, or set `shape: auto`",)
                self._binder.report("SB608", (*place, "collision"), message, help=help)
        for link in self._untouched:
            message = "`contact` of its parts has no effect, because the link lists its shapes"
            self._binder.report("SB608", ("links", link, "collision"), message, help=("give the shapes a `contact`",))
        if self._coarse:
            count = f"{len(self._coarse)} links" if len(self._coarse) > 1 else "one link"
            self._binder.diagnostics.add(
                "SB609",
                f"{self._binder.assembly.source}: `max_hulls` limits the collision geometry of {count}",
                self._binder.span(("links",)),
                help=("raise it: `collision: {shape: auto, max_hulls: 32}`",),
                notes=listed(tuple(self._coarse)),
            )

    def _given(self, link: str, shape: Shape) -> _Placed:
        """A shape that the link lists; a cylinder for MJX as the prism around it."""
        geometry, X_LG = _given(shape)
        defaults = rule_of(self._binder.document.defaults.collision or CollisionShape.HULL, self._binder.document)
        if not isinstance(geometry, Cylinder) or defaults.max_faces is None:
            return geometry, X_LG
        key = (link, geometry.radius, geometry.length)
        return self._assets.piece(key, f"{ascii_name(link)}_cylinder", _prism(geometry, defaults.max_faces), link), X_LG

    def _component(self, part: PlacedComponent, rule: CollisionRule) -> list[_Placed]:
        body = self._binder.assembly.components[part.index].body
        if rule.shape is CollisionShape.NONE:
            return []
        if rule.is_decomposed:
            joined = joined_part(self._binder.assembly, part.index, rule)
            made = None if joined is None else self._fitted.of(joined)
            if made is not None and not made.left_out:
                name = self._assets.name_of(body)
                return self._placed(("body", body, rule), name, self._binder.path(part.index), part.X_LC, made)
            rule = replace(rule, shape=CollisionShape.HULL)
        if (body, rule) not in self._fits:
            self._fits[body, rule] = self._fit(part.index, body, rule)
        fit = self._fits[body, rule]
        if fit is None:
            self._flat.append(quoted(self._binder.path(part.index)))
            return []
        geometry, X_CG = fit
        return [(geometry, part.X_LC if X_CG.is_identity else tidy(part.X_LC @ X_CG))]

    def _joined(self, link: str, parts: Sequence[PlacedComponent], rule: CollisionRule) -> list[_Placed]:
        """The shapes of all closed solids of a link, and a hull of each component that these do not enclose."""
        joined = joined_parts(self._binder.assembly, [part.index for part in parts], rule)
        placed: list[_Placed] = []
        enclosed: set[int] = set()
        if joined is not None:
            made = self._fitted.of(joined)
            beside = [part.index for part in parts if part.index not in joined.components]
            enclosed = {index for i, index in enumerate(joined.components) if i not in made.left_out}
            enclosed |= {beside[i] for i in made.enclosed}
            if len(made.shapes) >= rule.max_hulls > 1 and made.filled < rule.filled:
                pieces = f"{len(made.shapes)} pieces"
                self._coarse.append(f"link '{link}': its solids fill {made.filled:.2f} of {pieces}")
            first = next(part for part in parts if part.index == joined.components[0])
            placed += self._placed(("link", link), ascii_name(link), link, first.X_LC, made)
        for part in parts:
            if part.index not in enclosed:
                placed += self._component(part, replace(rule, shape=CollisionShape.HULL))
        return placed

    def _placed(self, key: tuple[object, ...], name: str, source: str, X_LA: Pose, made: CollisionSet) -> list[_Placed]:
        """The shapes of a set that is given in A."""
        placed: list[_Placed] = []
        for i, shape in enumerate(made.shapes):
            if isinstance(shape.geometry, TriMesh):
                suffix = "hull" if len(made.shapes) == 1 else f"piece{i + 1}"
                geometry: Geometry = self._assets.piece((*key, i), f"{name}_{suffix}", shape.geometry, source)
            else:
                geometry = shape.geometry
            placed.append((geometry, tidy(X_LA @ shape.X_AG)))
        return placed

    def _fit(self, index: int, body: int, rule: CollisionRule) -> _Placed | None:
        """Geometry of a body and its pose in the definition; None if the body is too flat."""
        if rule.shape is CollisionShape.MESH:
            return self._assets.body(body), IDENTITY
        if rule.shape is CollisionShape.HULL:
            hull = self._assets.hull(body, rule.max_vertices, rule.max_faces)
            return None if hull is None else (hull, IDENTITY)
        component = self._binder.assembly.components[index]
        widest = lines(axis_faces(self._binder.assembly, [index]))[:1]
        axes = [*np.eye(3), *(component.X_WC.inverse().turn(line.direction) for line in widest)]
        return _simple(rule.shape, self._binder.assembly.bodies[body].mesh.vertices, axes)

    def _merged(self, link: str, parts: Sequence[PlacedComponent], rule: CollisionRule) -> list[_Placed]:
        """One shape that encloses all components of a link without own collision geometry, in the link's frame."""
        shape = rule.shape
        if shape is CollisionShape.NONE:
            return []
        bodies = self._binder.assembly.bodies
        meshes = [bodies[self._binder.assembly.components[p.index].body].mesh.moved(p.X_LC) for p in parts]
        points = np.concatenate([mesh.vertices for mesh in meshes])
        fit: _Placed | None
        if shape is CollisionShape.MESH:
            fit = self._assets.merged(link, meshes), IDENTITY
        elif shape is CollisionShape.HULL:
            hull: MeshRef | None = self._assets.merged_hull(link, points, rule.max_vertices, rule.max_faces)
            fit = None if hull is None else (hull, IDENTITY)
        else:
            fit = _simple(shape, points, [*np.eye(3)])
            fit = None if fit is None else (fit[0], tidy(fit[1]))
        if fit is None:
            self._flat.append(f"link '{link}'")
            return []
        return [fit]


def _simple(shape: CollisionShape, points: Array, axes: Sequence[Array]) -> _Placed | None:
    if shape is CollisionShape.BOX:
        return box_around(points)
    if shape is CollisionShape.SPHERE:
        return sphere_around(points)
    if shape in (CollisionShape.CYLINDER, CollisionShape.WHEEL):
        fit = cylinder_around(points, axes)
        return fit if fit is None or shape is CollisionShape.CYLINDER else (Sphere(fit[0].radius), fit[1])
    assert shape is CollisionShape.CAPSULE
    return capsule_around(points, axes)


def _given(shape: Shape) -> _Placed:
    """A primitive given in the sidecar, and its pose in the link."""
    X_LG = Pose.from_xyz_rpy(shape.origin.xyz, shape.origin.rpy)
    if isinstance(shape, BoxShape):
        return Box(shape.size), X_LG
    if isinstance(shape, CylinderShape):
        return Cylinder(shape.radius, shape.length), X_LG
    if isinstance(shape, CapsuleShape):
        return Capsule(shape.radius, shape.length), X_LG
    return Sphere(shape.radius), X_LG


def _prism(cylinder: Cylinder, faces: int) -> TriMesh:
    """The prism with some faces, ends included, whose sides touch a cylinder from outside."""
    sides = faces - 2
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = cylinder.radius / np.cos(np.pi / sides) * np.column_stack([np.cos(angles), np.sin(angles)])
    ends = [np.column_stack([ring, np.full(sides, z)]) for z in (-0.5 * cylinder.length, 0.5 * cylinder.length)]
    hull = convex_hull(np.vstack(ends))
    assert hull is not None  # a cylinder has a volume
    return hull


def without_contacts_of(robot: Robot, sidecar: Sidecar, diagnostics: Diagnostics) -> Robot:
    """The robot with the sidecar's excluded pairs; those of adjacent links are reported (SB146)."""
    if not sidecar.document.excluded_contacts:
        return robot
    adjacent, pairs = neighbours(robot), dict[tuple[str, str], int]()
    for index, pair in enumerate(sidecar.document.excluded_contacts):
        pairs.setdefault((min(pair), max(pair)), index)
    for (a, b), index in pairs.items():
        if frozenset((a, b)) in adjacent:
            message = f"links '{a}' and '{b}' are adjacent; their contacts are excluded in any case"
            span = sidecar.span("excluded_contacts", index)
            diagnostics.add("SB146", f"excluded_contacts[{index}]: {message}", span, help=["remove the pair"])
    kept = (pair for pair in pairs if pair[0] != pair[1] and frozenset(pair) not in adjacent)
    return replace(robot, excluded_contacts=tuple(sorted(kept)))
