"""Collision shapes for python-fcl, https://github.com/BerkeleyAutomation/python-fcl, and how deep two of them overlap.

Convex meshes, as the default hulls are, and primitives count as solids; any other mesh as a surface that may enclose
the other shape. Contact is not a fault: CAD faces are flush, and vertices are on a grid of nanometres, so a pair counts
only from a penetration of :data:`TOUCHING`.
"""

import importlib.util
from collections.abc import Set
from math import inf
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.fixed_point import distinct_rows
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.predicates import encloses, is_convex
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import (
    Actuator,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Geometry,
    JointDynamics,
    Link,
    MeshRef,
    Robot,
    Sphere,
)

TOUCHING = 1e-6
"""Penetration [m] up to which two shapes touch and do not overlap."""
_DENT = 0.1 * TOUCHING
_MOST_CONTACTS = 1000
"""Contacts of a surface among which the deepest is searched."""


def available() -> str | None:
    """Why self-collision cannot be checked here; None if it can."""
    return None if importlib.util.find_spec("fcl") else "python-fcl is not installed"


def prepare() -> None:
    """Import python-fcl."""
    import fcl  # noqa: F401


def only_collisions(robot: Robot) -> Robot:
    """The robot reduced to its collision geometry and the motion of its joints, on which overlaps depend."""
    touched = {c.geometry.name for link in robot.links for c in link.collisions if isinstance(c.geometry, MeshRef)}
    return Robot(
        robot.name,
        tuple(Link(link.name, collisions=link.collisions) for link in robot.links),
        tuple(replace(joint, dynamics=JointDynamics()) for joint in robot.joints),
        robot.closures,
        # which joints of a loop are driven, whatever their gains
        actuators=tuple(Actuator(actuator.name, actuator.joint, actuator.kind) for actuator in robot.actuators),
        meshes=tuple(mesh for mesh in robot.meshes if mesh.name in touched),
    )


class Shape(Struct, frozen=True, eq=False):
    """A collision shape, in the frame of its link."""

    shape: Any
    """The collision geometry of python-fcl, in G."""
    X_LG: Pose
    """Pose of :attr:`shape`; the identity for a mesh, whose vertices are in the link's frame."""
    low: Array
    high: Array
    """Corners (3,) [m] of its box in the link's frame."""
    surface: TriMesh | None
    """The mesh in the link's frame, if the shape is a surface for python-fcl; None for a solid one."""
    inside: Array
    """Points (n, 3) [m] of the shape in the link's frame, outermost ones of a mesh among them."""
    center: Array
    radius: float
    """Centre (3,) and radius [m] of a sphere around the shape, in the link's frame."""
    is_ball: bool = False


def shapes_of(robot: Robot) -> dict[str, tuple[Shape, ...]]:
    """The collision shapes of each link."""
    convex = {mesh.name for mesh in robot.meshes if is_convex(mesh.mesh, _DENT)}
    return {link.name: tuple(_shape(robot, collision, convex) for collision in link.collisions) for link in robot.links}


def _shape(robot: Robot, collision: Collision, convex: Set[str]) -> Shape:
    if isinstance(collision.geometry, MeshRef):
        mesh = robot.mesh_by_name[collision.geometry.name].mesh.moved(collision.X_LG)
        solid = collision.geometry.name in convex
        low, high = (np.array(corner) for corner in mesh.bounds)
        shape = _convex(mesh) if solid else _surface(_shrunk(mesh))
        center = 0.5 * (low + high)
        radius = float(np.linalg.norm(mesh.vertices - center, axis=1).max()) + TOUCHING
        v = mesh.vertices
        inside = v[[0, *v.argmin(axis=0), *v.argmax(axis=0)]]
        return Shape(shape, Pose(), low, high, None if solid else mesh, inside, center, radius)
    extents, centre = _half_extents(collision.geometry), collision.X_LG.p
    ball = isinstance(collision.geometry, Sphere)
    half = extents if ball else np.abs(collision.X_LG.R) @ extents
    radius = float(extents[0]) if ball else float(np.linalg.norm(extents))
    shape = _primitive(collision.geometry)
    return Shape(shape, collision.X_LG, centre - half, centre + half, None, centre[None], centre, radius, ball)


def _half_extents(geometry: Geometry) -> Array:
    """Half the edges (3,) [m] of a primitive's box in its own frame."""
    match geometry:
        case Box(size):
            return np.array(size) / 2.0
        case Sphere(radius):
            return np.full(3, radius)
        case Cylinder(radius, length):
            return np.array([radius, radius, length / 2.0])
        case Capsule(radius, length):
            return np.array([radius, radius, radius + length / 2.0])
        case MeshRef():
            raise ValueError("a mesh is not a primitive")


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


def _shrunk(mesh: TriMesh) -> TriMesh:
    """The surface offset inwards by the contact tolerance, to separate flush faces of two surfaces."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    weighted = np.cross(b - a, c - a)
    _, places = distinct_rows(mesh.vertices)
    normals: NDArray[np.float64] = np.zeros((int(places.max()) + 1, 3))
    for corner in range(3):
        np.add.at(normals, places[mesh.faces[:, corner]], weighted)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    units = normals / np.where(lengths > 0.0, lengths, 1.0)
    return TriMesh.of(mesh.vertices - TOUCHING * units[places], mesh.faces)


class Pair:
    """Two shapes of different links, to be compared at many poses."""

    def __init__(self, a: Shape, b: Shape) -> None:
        import fcl

        self.a, self.b = a, b
        self._objects = (fcl.CollisionObject(a.shape, fcl.Transform(a.X_LG.R, a.X_LG.p)), fcl.CollisionObject(b.shape))
        one, most = (fcl.CollisionRequest(num_max_contacts=n, enable_contact=True) for n in (1, _MOST_CONTACTS))
        self._requests = (one, most) if self.surfaces else (one,)
        """For any contact, and for the deepest, of which two solids have one."""

    @property
    def surfaces(self) -> int:
        """Number of surfaces among the two."""
        return sum(shape.surface is not None for shape in (self.a, self.b))

    def overlap(self, R_AB: Array, p_AB: Array) -> bool:
        """Whether the shapes overlap with link B at R_AB (3, 3), p_AB (3,) [m] in link A."""
        self._place(R_AB, p_AB)
        # Where two surfaces have no contact, they do not have a deeper one either.
        requests = self._requests[: 1 if self.surfaces == 2 else 2]
        return any(self._contact(request) is not None for request in requests) or self._encloses(R_AB, p_AB)

    def deepest(self, R_AB: Array, p_AB: Array) -> tuple[float, Array | None] | None:
        """Penetration depth [m] with link B at R_AB (3, 3), p_AB (3,) [m] in link A, and its point (3,) [m] in A.

        The depth is infinite if the shapes overlap without one, as two surfaces do. A shape inside a surface touches it
        nowhere, and has no point. None if the shapes do not overlap.
        """
        self._place(R_AB, p_AB)
        contact = self._contact(self._requests[-1])
        return contact or ((inf, None) if self._encloses(R_AB, p_AB) else None)

    def _place(self, R_AB: Array, p_AB: Array) -> None:
        import fcl

        X_LG = self.b.X_LG
        at = fcl.Transform(R_AB, p_AB) if X_LG.is_identity else fcl.Transform(R_AB @ X_LG.R, R_AB @ X_LG.p + p_AB)
        self._objects[1].setTransform(at)

    def _contact(self, request: Any) -> tuple[float, Array] | None:
        """Depth and point of the deepest of the contacts that a request finds; None without any beyond touching."""
        import fcl

        result = fcl.CollisionResult()
        fcl.collide(*self._objects, request, result)
        deepest = max(result.contacts, key=lambda contact: contact.penetration_depth, default=None)
        if deepest is None or (self.surfaces < 2 and deepest.penetration_depth <= TOUCHING):
            return None
        return inf if self.surfaces == 2 else float(deepest.penetration_depth), np.array(deepest.pos)

    def _encloses(self, R_AB: Array, p_AB: Array) -> bool:
        """Whether one shape is a surface with the other one inside."""
        a, b = self.a, self.b
        return _holds(a, b.inside @ R_AB.T + p_AB) or _holds(b, (a.inside - p_AB) @ R_AB)


def _holds(shape: Shape, points: Array) -> bool:
    """Whether a shape is a surface around points (n, 3): its faces are searched only if its box holds them all."""
    if shape.surface is None:
        return False
    in_box = (shape.low - TOUCHING <= points) & (points <= shape.high + TOUCHING)
    return bool(in_box.all()) and encloses(shape.surface, points[0])
