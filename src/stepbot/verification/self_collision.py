"""Finds links that overlap in the drawn pose although no joint connects them, with python-fcl.

Convex meshes, as the default hulls are, and primitives count as solids; any other mesh as a surface that may enclose
the other shape. Contact is not a fault: CAD faces are flush, and vertices are on a grid of nanometres, so a pair counts
only from a penetration of :data:`TOUCHING`. https://github.com/BerkeleyAutomation/python-fcl
"""

import importlib.util
from collections.abc import Set
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.predicates import encloses, is_convex
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import initial_configuration, link_poses, neighbours
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, Geometry, MeshRef, Robot, Sphere

TOUCHING = 1e-6
"""Penetration [m] up to which two shapes touch and do not overlap."""
_DENT = 0.1 * TOUCHING

Overlap = tuple[str, str, float | None]
"""Two links, and their penetration depth [m]; None between two surfaces, which have none."""


def available() -> str | None:
    """Why self-collision cannot be checked here; None if it can."""
    return None if importlib.util.find_spec("fcl") else "python-fcl is not installed"


def prepare() -> None:
    """Import python-fcl."""
    import fcl  # noqa: F401


def without_visuals(robot: Robot) -> Robot:
    """The robot reduced to its collision geometry, to be sent to a worker."""
    touched = {c.geometry.name for link in robot.links for c in link.collisions if isinstance(c.geometry, MeshRef)}
    links = tuple(replace(link, visuals=()) for link in robot.links)
    return replace(robot, links=links, meshes=tuple(mesh for mesh in robot.meshes if mesh.name in touched))


def overlaps(robot: Robot) -> tuple[Overlap, ...]:
    """The pairs of links that overlap in the drawn pose, except adjacent ones, in the order of the links."""
    poses = link_poses(robot, initial_configuration(robot))
    convex = {mesh.name for mesh in robot.meshes if is_convex(mesh.mesh, _DENT)}
    shapes = {link.name: [_solid(robot, c, poses[link.name], convex) for c in link.collisions] for link in robot.links}
    close = neighbours(robot)
    names = list(shapes)
    found = []
    for i, a in enumerate(names):
        for b in names[i + 1 :]:
            if frozenset((a, b)) in close:
                continue
            depths = [_penetration(x, y) for x, y in product(shapes[a], shapes[b]) if x.may_meet(y)]
            deep = [depth for depth in depths if depth is not None]
            if deep:
                deepest = max(deep)
                found.append((a, b, None if np.isinf(deepest) else deepest))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Solid:
    """A collision shape in the world."""

    shape: Any
    """The object of python-fcl."""
    low: Array
    high: Array
    """Corners [m] of its box."""
    mesh: TriMesh | None
    """In the world, for a shape that is a surface for python-fcl; None for a solid one."""
    inside: Array
    """A point (3,) of the shape, in the world."""

    def may_meet(self, other: "_Solid") -> bool:
        """Whether the boxes overlap."""
        return bool((self.low < other.high - TOUCHING).all() and (other.low < self.high - TOUCHING).all())


def _solid(robot: Robot, collision: Collision, X_WL: Pose, convex: Set[str]) -> _Solid:
    import fcl

    X_WG = X_WL @ collision.X_LG
    if isinstance(collision.geometry, MeshRef):
        mesh = robot.mesh_by_name[collision.geometry.name].mesh
        moved, is_convex = mesh.moved(X_WG), collision.geometry.name in convex
        shape = fcl.CollisionObject(_convex(moved) if is_convex else _surface(_shrunk(moved)), fcl.Transform())
        low, high = moved.bounds
        return _Solid(shape, np.array(low), np.array(high), None if is_convex else moved, moved.vertices[0])
    shape = fcl.CollisionObject(_primitive(collision.geometry), fcl.Transform(X_WG.R, X_WG.p))
    reach = _reach(collision.geometry)
    return _Solid(shape, X_WG.p - reach, X_WG.p + reach, None, X_WG.p)


def _reach(geometry: Geometry) -> float:
    """Largest distance [m] of a primitive from its centre."""
    match geometry:
        case Box(size):
            return float(np.linalg.norm(size)) / 2
        case Sphere(radius):
            return radius
        case Cylinder(radius, length):
            return float(np.hypot(radius, length / 2))
        case Capsule(radius, length):
            return radius + length / 2
        case MeshRef():
            raise ValueError("a mesh has no radius")


def _primitive(geometry: Geometry) -> Any:
    import fcl

    match geometry:
        case Box(size):
            return fcl.Box(*size)
        case Sphere(radius):
            return fcl.Sphere(radius)
        case Cylinder(radius, length):
            return fcl.Cylinder(radius, length)
        case Capsule(radius, length):
            return fcl.Capsule(radius, length)
        case MeshRef():
            raise ValueError("a mesh is not a primitive")


def _convex(mesh: TriMesh) -> Any:
    import fcl

    counted = np.hstack([np.full((len(mesh.faces), 1), 3), mesh.faces])
    return fcl.Convex(mesh.vertices, len(mesh.faces), counted.astype(int).ravel())


def _surface(mesh: TriMesh) -> Any:
    import fcl

    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def _penetration(a: _Solid, b: _Solid) -> float | None:
    """Penetration depth [m] of two shapes; infinite if they overlap without a depth, None if they do not overlap."""
    import fcl

    result = fcl.CollisionResult()
    fcl.collide(a.shape, b.shape, fcl.CollisionRequest(num_max_contacts=1000, enable_contact=True), result)
    depths = [contact.penetration_depth for contact in result.contacts]
    if a.mesh is not None and b.mesh is not None:
        return np.inf if depths or encloses(a.mesh, b.inside) or encloses(b.mesh, a.inside) else None
    deepest = max(depths, default=0.0)
    if deepest > TOUCHING:
        return float(deepest)
    enclosed = any(one.mesh is not None and encloses(one.mesh, other.inside) for one, other in ((a, b), (b, a)))
    return np.inf if enclosed else None


def _shrunk(mesh: TriMesh) -> TriMesh:
    """The surface offset inwards by the contact tolerance, to separate flush faces of two surfaces."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    weighted = np.cross(b - a, c - a)
    _, places = np.unique(mesh.vertices, axis=0, return_inverse=True)
    normals: NDArray[np.float64] = np.zeros((int(places.max()) + 1, 3))
    for corner in range(3):
        np.add.at(normals, places.reshape(-1)[mesh.faces[:, corner]], weighted)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    units = normals / np.where(lengths > 0.0, lengths, 1.0)
    return TriMesh.of(mesh.vertices - TOUCHING * units[places.reshape(-1)], mesh.faces)
