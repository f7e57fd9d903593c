"""The robot's meshes: one per body and group of colours, plus its hull, shared by all occurrences.

A mesh is named after the product of its body. Names are assigned to all bodies of the assembly in file order, so that
editing the sidecar renames no mesh.
"""

from weakref import WeakKeyDictionary

import numpy as np
from msgspec import Struct

from stepbot.geometry.fixed_point import distinct
from stepbot.geometry.mesh import TriMesh, joined
from stepbot.geometry.solids.collision_sets import bounded_hull
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.spatial import Array
from stepbot.robot.mesh_names import FALLBACK, UniqueNames, ascii_name
from stepbot.robot.model import MeshAsset, MeshRef, Rgba
from stepbot.step.assembly import Assembly, Component
from stepbot.step.structure.naming import BODY, base_name


class ColorGroup(Struct, frozen=True):
    """The faces of a body that share one colour, in the displayed occurrence."""

    geometry: MeshRef
    rgba: Rgba


class MeshAssets:
    """Creates each mesh once, on first use."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._names = UniqueNames()
        self._first = self._first_components()
        self._bases = [
            self._names.unique(self._product_name(self._first[body]) if body in self._first else FALLBACK)
            for body in range(len(self._assembly.bodies))
        ]
        self._made: dict[tuple[object, ...], MeshAsset | None] = {}
        self._colors: dict[int, list[int]] = {}

    def all(self) -> tuple[MeshAsset, ...]:
        """Every mesh used so far, sorted by name."""
        return tuple(
            sorted((asset for asset in self._made.values() if asset is not None), key=lambda asset: asset.name)
        )

    def body(self, body: int) -> MeshRef:
        """The whole mesh of a body."""
        key = ("body", body)
        if key not in self._made:
            self._made[key] = MeshAsset(self._bases[body], self._assembly.bodies[body].mesh, self._source(body))
        return self._reference(key)

    def by_color(
        self, body: int, component: Component, overruled: Rgba | None, default: Rgba
    ) -> tuple[ColorGroup, ...]:
        """The mesh of a body split by colour, in the order of the body's colours.

        Returns the whole mesh if ``colour`` overrides the STEP's colours or if all faces have the same colour.
        """
        solid = self._assembly.bodies[body]
        plain = component.color or default
        colors = [overruled or color or plain for color in solid.colors]
        groups: dict[Rgba, list[int]] = {}
        for index in self._used_colors(body):
            groups.setdefault(colors[index] if colors else overruled or plain, []).append(index)
        if len(groups) <= 1:
            return (ColorGroup(self.body(body), next(iter(groups), overruled or plain)),)
        return tuple(ColorGroup(self._group(body, tuple(indices)), rgba) for rgba, indices in groups.items())

    def name_of(self, body: int) -> str:
        """The name of a body's mesh."""
        return self._bases[body]

    def hull(self, body: int, max_vertices: int | None = None, max_faces: int | None = None) -> MeshRef | None:
        """The convex hull of a body, or one that encloses it with fewer vertices; None if the body is flat."""
        key = ("hull", body, max_vertices, max_faces)
        if key not in self._made:
            mesh = _bounded(_hull_of(self._assembly.bodies[body].mesh), max_vertices, max_faces)
            self._made[key] = (
                None if mesh is None else self._named(f"{self._bases[body]}_hull", mesh, self._source(body))
            )
        return None if self._made[key] is None else self._reference(key)

    def merged(self, link: str, meshes: list[TriMesh]) -> MeshRef:
        """The meshes of a link merged into one, in the link's frame."""
        key = ("merged", link)
        self._made[key] = self._named(f"{ascii_name(link)}_merged", joined(meshes), link)
        return self._reference(key)

    def piece(self, key: tuple[object, ...], name: str, mesh: TriMesh, source: str) -> MeshRef:
        """A convex piece of a body or a link."""
        key = ("piece", *key)
        if key not in self._made:
            self._made[key] = self._named(name, mesh, source)
        return self._reference(key)

    def merged_hull(
        self, link: str, points: Array, max_vertices: int | None = None, max_faces: int | None = None
    ) -> MeshRef | None:
        """The convex hull of points (n, 3) [m] of a link, in the link's frame; None if they are coplanar."""
        key = ("merged hull", link)
        mesh = _bounded(convex_hull(points), max_vertices, max_faces)
        self._made[key] = None if mesh is None else self._named(f"{ascii_name(link)}_hull", mesh, link)
        return None if mesh is None else self._reference(key)

    def _used_colors(self, body: int) -> list[int]:
        if body not in self._colors:
            self._colors[body] = distinct(self._assembly.bodies[body].face_colors).tolist()
        return self._colors[body]

    def _group(self, body: int, indices: tuple[int, ...]) -> MeshRef:
        key = ("group", body, indices)
        if key not in self._made:
            solid = self._assembly.bodies[body]
            piece = solid.mesh.subset(np.isin(solid.face_colors, indices))
            self._made[key] = self._named(f"{self._bases[body]}_color{indices[0] + 1}", piece, self._source(body))
        return self._reference(key)

    def _named(self, name: str, mesh: TriMesh, source: str) -> MeshAsset:
        return MeshAsset(self._names.unique(name), mesh, source)

    def _source(self, body: int) -> str:
        return self._first[body].path if body in self._first else ""

    def _reference(self, key: tuple[object, ...]) -> MeshRef:
        asset = self._made[key]
        assert asset is not None
        return MeshRef(asset.name)

    def _first_components(self) -> dict[int, Component]:
        """For each body, the first component that displays it."""
        first: dict[int, Component] = {}
        for component in self._assembly.components:
            if component.body >= 0:
                first.setdefault(component.body, component)
        return first

    def _product_name(self, component: Component) -> str:
        """Name of the nearest product, of the component itself or an ancestor, whose name is not generic."""
        name = base_name(component.product, component.occurrence)
        if name != BODY:
            return ascii_name(name)
        return self._product_name(self._assembly.components[component.parent]) if component.parent >= 0 else FALLBACK


_HULLS: WeakKeyDictionary[TriMesh, TriMesh | None] = WeakKeyDictionary()
"""Hulls of the meshes that are in memory: a page builds the same bodies again after each edit."""


def _hull_of(mesh: TriMesh) -> TriMesh | None:
    if mesh not in _HULLS:
        _HULLS[mesh] = convex_hull(mesh.vertices)
    return _HULLS[mesh]


def _bounded(hull: TriMesh | None, max_vertices: int | None, max_faces: int | None) -> TriMesh | None:
    return None if hull is None else bounded_hull(hull, max_vertices, max_faces)
