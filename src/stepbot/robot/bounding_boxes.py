"""Bounding boxes of shapes and of links, exact for every rotation, and the height at which a robot stands."""

import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import IDENTITY, Array, Pose, Vector3, bounds, join_bounds, vector3

from .kinematics import Configuration, initial_configuration, link_poses, rigid_bodies
from .model import Base, Box, Capsule, Cylinder, Geometry, MeshRef, Robot, Sphere

Bounds = tuple[Vector3, Vector3]
_TOUCHING = 0.005
"""Height [m] over the floor up to which the lowest point of a link stands on it."""


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


def robot_bounds(
    robot: Robot, q: Configuration, links: Iterable[str] | None = None, X_WR: Pose = IDENTITY
) -> Bounds | None:
    """Lowest and highest corner [m] of links in a frame W: of their collisions, or else of their visuals.

    Args:
        q: Positions [rad] or [m].
        links: Names of links; None for all.
        X_WR: The pose of the root; W is its frame by default.

    Returns:
        None if the links have no shapes.
    """
    X_WL = link_poses(robot, q)
    if not X_WR.is_identity:
        X_WL = {name: X_WR @ X_RL for name, X_RL in X_WL.items()}
    chosen = [robot.link_by_name[name] for name in (X_WL if links is None else links)]
    placed = [(X_WL[link.name], link.collision_poses) for link in chosen]
    if not any(poses for _, poses in placed):
        placed = [(X_WL[link.name], link.visual_poses) for link in chosen]
    everywhere: dict[Geometry, list[Poses]] = {}
    for X, points in placed:
        for geometry, X_LG in points.items():
            everywhere.setdefault(geometry, []).append(X_LG.seen_from(X))
    boxes = [_bounds(robot, geometry, Poses.joined(poses)) for geometry, poses in everywhere.items()]
    return join_bounds(boxes) if boxes else None


def _bounds(robot: Robot, geometry: Geometry, placed: Poses) -> Bounds:
    """The box around a geometry at all of its poses."""
    if isinstance(geometry, MeshRef):
        low, high = bounds_at(robot.mesh_by_name[geometry.name].mesh.vertices, placed)
        return vector3(low.min(axis=0)), vector3(high.max(axis=0))
    return join_bounds(primitive_bounds(geometry, X_WG) for X_WG in placed.listed())


_DIGITS = 9
"""Decimals [m] of heights: vertices lie on a grid of one nanometre."""


def standing_height(robot: Robot, q: Configuration, X_WR: Pose = IDENTITY) -> float:
    """Height [m] of the base's frame above a floor at z = 0 that the lowest point of a floating robot touches.

    The lowest point is that of the collisions, or of the visuals of a robot without collisions. 0 for a fixed base, and
    for a robot without shapes.

    Args:
        X_WR: How the base is turned, about the origin.
    """
    around = robot_bounds(robot, q, X_WR=X_WR) if robot.base is Base.FLOATING else None
    return 0.0 if around is None else round(-around[0][2], _DIGITS) + 0.0


def floor_height(robot: Robot) -> float:
    """Height [m] of the floor in the frame of the base, or in the world of a floating robot.

    A robot with a fixed base stands on the lowest point of the links that do not move. If a link that moves is lower in
    the drawn pose, the robot hangs, and the floor is a whole height of the robot below its lowest point.
    """
    drawn = initial_configuration(robot)
    around = robot_bounds(robot, drawn)
    if robot.base is Base.FLOATING or around is None:
        return 0.0
    root = robot.root.name
    still = [link for link, body in rigid_bodies(root, robot.joints).items() if body == root]
    standing = robot_bounds(robot, drawn, still)
    (_, _, lowest), (_, _, highest) = around
    if standing is not None and standing[0][2] <= lowest:
        return round(lowest, _DIGITS) + 0.0
    return round(lowest - (highest - lowest), _DIGITS) + 0.0


def extent(robot: Robot) -> tuple[tuple[float, float, float], float]:
    """Centre [m] and half diagonal [m] of the box around the robot in the drawn pose, where it stands."""
    drawn = initial_configuration(robot)
    around = robot_bounds(robot, drawn)
    low, high = around or ((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0))
    x, y, z = (0.5 * (np.array(low) + np.array(high))).tolist()
    return (x, y, z + standing_height(robot, drawn)), 0.5 * float(np.linalg.norm(np.array(high) - np.array(low)))


_JAW = re.compile(r"(?<![a-z])(?:jaw|gripper|finger|claw|pincer|thumb)s?(?![a-z])", re.IGNORECASE)
_WIDEST = 2.5
"""Largest range [rad] or [m] of a jaw; the wrist that turns a gripper has more."""


def is_jaw(names: Iterable[str], lower: float, upper: float) -> bool:
    """Whether the last joint of an arm is that of a single jaw.

    Args:
        names: Names of the joint and of the link below.
        lower: Lower limit [rad] or [m].
        upper: Upper limit [rad] or [m].
    """
    return upper - lower <= _WIDEST and any(_JAW.search(name) for name in names)


def standing(robot: Robot, configuration: Configuration) -> tuple[float, float | None]:
    """Height of the base, and how far the com is inside the polygon of the links that stand on the floor.

    A link stands at the centre of its bounding box: exact for wheels and round feet.
    """
    height, X = standing_height(robot, configuration), link_poses(robot, configuration)
    feet = []
    for link in robot.links:
        box = robot_bounds(robot, configuration, [link.name])
        if box is not None and box[0][2] + height <= _TOUCHING:
            feet.append([0.5 * (box[0][0] + box[1][0]), 0.5 * (box[0][1] + box[1][1])])
    total = exact_sum(link.mass_properties.mass for link in robot.links)
    weighted = [link.mass_properties.mass * X[link.name].apply(link.mass_properties.com)[:2] for link in robot.links]
    com = np.sum(weighted, axis=0) / total if total else np.zeros(2)
    return height, _margin(feet, com)


def _margin(points: Sequence[Sequence[float]], com: Array) -> float | None:
    """Distance [m] of a point to the nearest edge of the convex hull of others, negative outside; None for a line."""
    order = sorted(map(tuple, points))
    hull: list[Array] = []
    for row in (order, order[::-1]):
        half: list[Array] = []
        for point in map(np.array, row):
            while len(half) > 1 and _turn(half[-2], half[-1], point) <= 1e-12:
                half.pop()
            half.append(point)
        hull += half[:-1]
    if len(hull) < 3:
        return None
    edges = zip(hull, [*hull[1:], hull[0]], strict=True)
    return round(min(_turn(a, b, com) / float(np.linalg.norm(b - a)) for a, b in edges), _DIGITS) + 0.0


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
