"""Bounding boxes of shapes and of links, exact for every rotation."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import Pose, Vector3, bounds, join_bounds, vector3

from .kinematics import Configuration, link_poses
from .model import Box, Capsule, Cylinder, Geometry, MeshRef, Robot, Sphere

Bounds = tuple[Vector3, Vector3]


def primitive_bounds(shape: Box | Cylinder | Sphere | Capsule, X_LG: Pose) -> Bounds:
    """Lowest and highest corner [m] of a primitive in the link's frame, exact for every rotation."""
    along = np.abs(X_LG.R[:, 2])
    if isinstance(shape, Box):
        half = np.abs(X_LG.R) @ (0.5 * np.array(shape.size))
    elif isinstance(shape, Sphere):
        half = np.full(3, shape.radius)
    elif isinstance(shape, Capsule):
        half = 0.5 * shape.length * along + shape.radius
    else:
        half = 0.5 * shape.length * along + shape.radius * np.sqrt(np.clip(1.0 - along**2, 0.0, None))
    return vector3(X_LG.p - half), vector3(X_LG.p + half)


def mesh_bounds(vertices: ArrayLike, X_LG: Pose) -> Bounds:
    """Lowest and highest corner [m] of vertices (n, 3) in the link's frame."""
    return bounds(X_LG.apply(vertices))


def robot_bounds(robot: Robot, q: Configuration, links: Iterable[str] | None = None) -> Bounds | None:
    """Lowest and highest corner [m] of links in the frame of the root: of their collisions, or else of their visuals.

    Args:
        q: Positions [rad] or [m].
        links: Names of links; None for all.

    Returns:
        None if the links have no shapes.
    """
    X_WL = link_poses(robot, q)
    chosen = [robot.link_by_name[name] for name in (X_WL if links is None else links)]
    placed = [(X_WL[link.name], link.collision_poses) for link in chosen]
    if not any(poses for _, poses in placed):
        placed = [(X_WL[link.name], link.visual_poses) for link in chosen]
    boxes = [_bounds(robot, geometry, X_LG.seen_from(X)) for X, of in placed for geometry, X_LG in of.items()]
    return join_bounds(boxes) if boxes else None


def _bounds(robot: Robot, geometry: Geometry, placed: Poses) -> Bounds:
    """The box around a geometry at all of its poses."""
    if isinstance(geometry, MeshRef):
        low, high = bounds_at(robot.mesh_by_name[geometry.name].mesh.vertices, placed)
        return vector3(low.min(axis=0)), vector3(high.max(axis=0))
    return join_bounds(primitive_bounds(geometry, X_WG) for X_WG in placed.listed())
