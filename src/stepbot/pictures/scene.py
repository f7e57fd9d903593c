"""What is drawn: placed meshes with an owner each, and the axes of joints."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import pi

import numpy as np
from msgspec import Struct

from stepbot.geometry.mesh import AROUND, TriMesh, joined, revolved
from stepbot.geometry.spatial import Array, Pose, Vector3, vector3
from stepbot.robot.kinematics import Configuration, link_poses
from stepbot.robot.model import Box, Capsule, Cylinder, Geometry, MeshRef, Rgba, Robot, Sphere

from .camera import View
from .raytrace import Scene, linear

NEVER = -np.inf


class Shape(Struct, frozen=True, eq=False):
    """A mesh at its place."""

    mesh: TriMesh
    X_WG: Pose
    colors: Array
    """sRGB of each face, shape (m, 3), or of all, shape (3,); every shape is drawn opaque."""
    owner: int
    """Index of its name in :attr:`Subject.names`."""


class Axis(Struct, frozen=True):
    """The axis of a joint."""

    name: str
    point: Vector3
    """The origin of the joint [m] in the world."""
    direction: Vector3
    """Unit vector in the world."""
    turns: bool
    """Whether the joint turns about the axis."""
    slides: bool
    """Whether the joint slides along it."""


class Subject(Struct, frozen=True, eq=False):
    """What a picture shows."""

    shapes: tuple[Shape, ...]
    names: tuple[str, ...]
    """Names of the owners of the shapes: links, or components."""
    axes: tuple[Axis, ...] = ()


def scene_of(subject: Subject, view: View) -> Scene | None:
    """The triangles of a subject in the world; None if there are none."""
    shapes = [shape for shape in subject.shapes if len(shape.mesh.faces)]
    if not shapes:
        return None
    points = np.concatenate([shape.X_WG.apply(shape.mesh.vertices) for shape in shapes])
    floor = float(points[:, 2].min()) if view.floor and view.elevation >= 0.0 else NEVER
    colors = np.concatenate([np.broadcast_to(linear(shape.colors), (len(shape.mesh.faces), 3)) for shape in shapes])
    owners = np.concatenate([np.full(len(shape.mesh.faces), shape.owner, dtype=np.int32) for shape in shapes])
    return Scene(points, joined([shape.mesh for shape in shapes]).faces, colors, floor, owners)


def exploded(boxes: Array, parents: Sequence[int], units: Collection[int], apart: float) -> Array:
    """A displacement [m] for each component of a tree.

    Args:
        boxes: Lowest and highest corner [m] of each component and everything below it, shape (n, 2, 3); NaN for empty
            ones.
        parents: Index of the component above each; -1 for the root, which is the first; parents precede their children.
        units: Components whose parts stay together.
        apart: Displacement relative to the distance between the centres of a component and its parent.

    Returns:
        Shape (n, 3).
    """
    centres: Array = boxes.mean(axis=1)
    moves: Array = np.zeros(centres.shape)
    inside = np.zeros(len(parents), dtype=bool)
    for index, parent in enumerate(parents):
        if parent < 0:
            continue
        moves[index] = moves[parent]
        inside[index] = inside[parent] or parent in units
        if not inside[index] and np.isfinite(boxes[index]).all():
            moves[index] += apart * (centres[index] - centres[parent])
    return moves


def mesh_of(geometry: Geometry, robot: Robot) -> TriMesh:
    """The triangles of a shape of a robot."""
    match geometry:
        case MeshRef(name):
            return robot.mesh_by_name[name].mesh
        case Box(size):
            return box_mesh(size)
        case Cylinder(radius, length):
            return cylinder_mesh(radius, length)
        case Capsule(radius, length):
            return capsule_mesh(radius, length)
        case Sphere(radius):
            return capsule_mesh(radius, 0.0)


def box_mesh(size: Vector3) -> TriMesh:
    """A box of full edge lengths [m] around the origin."""
    signs = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return TriMesh.of(signs * np.array(size), [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def cylinder_mesh(radius: float, length: float) -> TriMesh:
    """A cylinder along z around the origin [m]."""
    return revolved(np.array([(0.0, -0.5), (radius, -0.5), (radius, 0.5), (0.0, 0.5)]) * (1.0, length))


def capsule_mesh(radius: float, length: float) -> TriMesh:
    """A cylinder along z [m] with half spheres on both ends; a sphere if the length is 0."""
    angles = np.linspace(-pi / 2, pi / 2, AROUND // 2 + 1)
    arc = radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    half = len(arc) // 2 + 1
    down, up = np.array((0.0, -length / 2)), np.array((0.0, length / 2))
    return revolved(np.concatenate((arc[:half] + down, arc[half - 1 :] + up) if length else (arc,)))


def robot_subject(robot: Robot, q: Configuration, links: Collection[str] | None = None) -> Subject:
    """The visuals of a robot's links at a complete configuration, and the axes of its joints.

    Args:
        q: Positions [rad] or [m].
        links: The links to draw, and the axes between them; None for all.
    """
    poses = link_poses(robot, q)
    drawn = [link for link in robot.links if links is None or link.name in links]
    axes = _axes(robot, poses, {link.name for link in drawn})
    shapes = [
        Shape(mesh_of(visual.geometry, robot), poses[link.name] @ visual.X_LG, rgb(visual.rgba), owner)
        for owner, link in enumerate(drawn)
        for visual in link.visuals
    ]
    return Subject(tuple(shapes), tuple(link.name for link in drawn), tuple(axes))


def _axes(robot: Robot, poses: Mapping[str, Pose], links: Collection[str]) -> Iterator[Axis]:
    """The axes of all joints and closures between some links that have one, in the world."""
    for joint in robot.joints:
        is_drawn = joint.parent in links and joint.child in links
        if is_drawn and (joint.kind.turns or joint.kind.slides):
            # The axis keeps its direction in the parent, its point in the child.
            axis_W = (poses[joint.parent] @ joint.X_PC).turn(joint.axis)
            yield Axis(joint.name, poses[joint.child].position, vector3(axis_W), joint.kind.turns, joint.kind.slides)
    for closure in robot.closures:
        is_drawn = closure.link_a in links and closure.link_b in links
        if is_drawn and (closure.kind.turns or closure.kind.slides):
            X_WF, kind = poses[closure.link_a] @ closure.X_AF, closure.kind
            yield Axis(closure.name, X_WF.position, vector3(X_WF.turn(closure.axis)), kind.turns, kind.slides)


def rgb(rgba: Rgba) -> Array:
    """A colour without its opacity, shape (3,)."""
    return np.array(rgba[:3])
