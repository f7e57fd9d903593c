"""Collision geometry of a link: hulls, meshes or simple shapes of its components, or shapes given in the sidecar.

Rules under ``parts`` override the link; the default is the convex hull of each component. A box is aligned with the
axes of the component's definition. A cylinder or capsule is aligned with one of these axes or with the widest axis line
of the body, whichever gives the smallest volume; a sphere is the smallest enclosing one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepbot.geometry.enclosing_shapes import box_around, capsule_around, cylinder_around, sphere_around
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, Geometry, MeshRef, Sphere
from stepbot.sidecar.document import BoxShape, CapsuleShape, CollisionShape, CylinderShape, MergedCollision, Shape
from stepbot.step.features.axes import axis_faces, lines
from stepbot.step.structure.paths import quoted

from .assets import MeshAssets
from .binder import Binder, listed
from .material_assignment import MaterialAssignment

_Placed = tuple[Geometry, Pose]


@dataclass(frozen=True)
class Placed:
    """A component of a link."""

    index: int
    material: MaterialAssignment
    X_LC: Pose


class Collisions:
    """Creates the collision geometry of links."""

    def __init__(self, binder: Binder, assets: MeshAssets) -> None:
        self._binder = binder
        self._assets = assets
        self._fits: dict[tuple[int, CollisionShape], _Placed | None] = {}
        self._flat: list[str] = []

    def of(self, link: str, parts: Sequence[Placed]) -> tuple[Collision, ...]:
        """Collision geometry of a link: by component in file order, then the shapes of the link as a whole."""
        given = self._binder.document.links[link].collision
        shape = given if isinstance(given, CollisionShape) else CollisionShape.HULL if given is None else None
        placed: list[_Placed] = []
        whole: list[Placed] = []
        for part in parts:
            own = part.material.collision or shape
            if own is None:
                whole.append(part)
            else:
                placed += self._component(part, own)
        if isinstance(given, MergedCollision) and whole:
            placed += self._merged(link, whole, given.merge)
        elif isinstance(given, tuple):
            placed += map(_given, given)
        return tuple(
            Collision(f"{link}_collision_{i}", geometry, X_LG) for i, (geometry, X_LG) in enumerate(placed, start=1)
        )

    def report_flat(self) -> None:
        """Warn once about all components that need collision geometry but are too flat for it."""
        if self._flat:
            what = f"{len(self._flat)} components are" if len(self._flat) > 1 else f"{self._flat[0]} is"
            self._binder.found.add(
                "SB308",
                f"{self._binder.assembly.source}: {what} too flat for a convex hull",
                self._binder.span(("links",)),
                help=("set `collision: none` for them in `parts`, or give the link primitive shapes",),
                notes=listed(tuple(self._flat)),
            )

    def _component(self, part: Placed, shape: CollisionShape) -> list[_Placed]:
        body = self._binder.assembly.components[part.index].body
        if shape is CollisionShape.NONE:
            return []
        if (body, shape) not in self._fits:
            self._fits[body, shape] = self._fit(part.index, body, shape)
        fit = self._fits[body, shape]
        if fit is None:
            self._flat.append(quoted(self._binder.path(part.index)))
            return []
        geometry, X_CG = fit
        return [(geometry, part.X_LC @ X_CG)]

    def _fit(self, index: int, body: int, shape: CollisionShape) -> _Placed | None:
        """Geometry of a body and its pose in the definition; None if the body is too flat."""
        if shape is CollisionShape.MESH:
            return self._assets.body(body), IDENTITY
        if shape is CollisionShape.HULL:
            hull = self._assets.hull(body)
            return None if hull is None else (hull, IDENTITY)
        component = self._binder.assembly.components[index]
        widest = lines(axis_faces(self._binder.assembly, [index]))[:1]
        axes = [*np.eye(3), *(component.X_WC.inverse().turn(line.direction) for line in widest)]
        return _simple(shape, self._binder.assembly.bodies[body].mesh.vertices, axes)

    def _merged(self, link: str, parts: Sequence[Placed], shape: CollisionShape) -> list[_Placed]:
        """One shape that encloses all components of a link without own collision geometry, in the link's frame."""
        if shape is CollisionShape.NONE:
            return []
        bodies = self._binder.assembly.bodies
        meshes = [bodies[self._binder.assembly.components[p.index].body].mesh.moved(p.X_LC) for p in parts]
        points = np.concatenate([mesh.vertices for mesh in meshes])
        fit: _Placed | None
        if shape is CollisionShape.MESH:
            fit = self._assets.merged(link, meshes), IDENTITY
        elif shape is CollisionShape.HULL:
            hull: MeshRef | None = self._assets.merged_hull(link, points)
            fit = None if hull is None else (hull, IDENTITY)
        else:
            fit = _simple(shape, points, [*np.eye(3)])
        if fit is None:
            self._flat.append(f"link '{link}'")
            return []
        return [fit]


def _simple(shape: CollisionShape, points: Array, axes: Sequence[Array]) -> _Placed | None:
    if shape is CollisionShape.BOX:
        return box_around(points)
    if shape is CollisionShape.SPHERE:
        return sphere_around(points)
    if shape is CollisionShape.CYLINDER:
        return cylinder_around(points, axes)
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
