"""The truth of a drawn mechanism as a description of it, such as a URDF: links with points, joints with positions."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from random import Random

import numpy as np

from stepbot.engines.description import DescribedShape, Description
from stepbot.engines.observation import Observation, ObservedClosure, ObservedJoint, ObservedLink
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, Pose, rotation_about, vector3
from stepbot.robot.model import JointKind, Limit
from stepbot.step.assembly import Assembly

from .kit import SCREWS, Kit, Truth

_BODY = {"mass": 1.0, "com": (0.0, 0.0, 0.0), "inertia": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))}


def description_of(
    kit: Kit, assembly: Assembly, link_of: Mapping[str, str], random: Random, *, shown: float = 1.0
) -> tuple[Description, dict[str, float]]:
    """A description, whose frames are turned at random, and for each child its position as drawn.

    Args:
        kit: What was drawn.
        assembly: Its assembly, with meshes.
        link_of: The link of each path.
        random: The source of every choice.
        shown: The share of links whose shapes the description has.
    """

    def turn() -> Array:
        return rotation_about(vector3(np.eye(3)[random.randrange(3)]), random.uniform(-3.0, 3.0))

    X_W = {kit.root: random.choice((Pose(), Pose.of(turn(), (0.1, -0.2, 0.3))))}
    joints, X_PC, drawn, closures = list[ObservedJoint](), dict[str, Pose](), dict[str, float](), list[Truth]()
    for parent, child, joint in _tree(kit, closures):
        X_W[child] = Pose.of(turn(), vector3(joint.point))
        kind = JointKind(joint.kind)
        axis = X_W[child].inverse().turn(joint.direction)
        q = 0.0 if kind is JointKind.BALL else round(random.uniform(-0.02, 0.02) * (1 if kind.slides else 20), 4)
        moved = Pose.of(position=axis * q) if kind.slides else Pose.of(rotation_about(vector3(axis), q))
        X_PC[child] = X_W[parent].inverse() @ X_W[child] @ moved.inverse()
        drawn[child] = q
        limit = Limit(q - 0.5, q + 0.5, 2.0, 3.0)
        along = None if kind is JointKind.BALL else vector3(axis)
        joints.append(ObservedJoint(f"to_{child}", str(kind), parent, child, along, limit=limit))
    seen = Observation(
        *("test", "1", "mjcf"),
        links=tuple(ObservedLink(name, **_BODY) for name in X_W),
        joints=tuple(joints),
        closures=tuple(_closure(one, X_W) for one in closures),
    )
    bare = {name for name in X_W if random.random() >= shown}
    shapes = [one for one in _shapes(assembly, link_of, X_W) if one.link not in bare]
    return Description(seen, X_PC, tuple(shapes)), drawn


def _tree(kit: Kit, closures: list[Truth]) -> Iterator[tuple[str, str, Truth]]:
    """Parent, child and joint from the root outwards; what is left over closes loops."""
    near = defaultdict[str, list[Truth]](list)
    for joint in kit.joints:
        near[joint.a].append(joint)
        near[joint.b].append(joint)
    known, used = [kit.root], set[int]()
    for parent in known:
        for joint in near[parent]:
            child = joint.b if joint.a == parent else joint.a
            if id(joint) in used:
                continue
            used.add(id(joint))
            if child in known:
                closures.append(joint)
            else:
                known.append(child)
                yield parent, child, joint


def _closure(joint: Truth, X_W: Mapping[str, Pose]) -> ObservedClosure:
    ends = X_W[joint.a].inverse(), X_W[joint.b].inverse()
    points = tuple(vector3(X.apply(joint.point)) for X in ends)
    axes = tuple(vector3(X.turn(joint.direction)) for X in ends)
    return ObservedClosure(f"{joint.a}_{joint.b}", joint.kind, joint.a, joint.b, points=points, axes=axes)  # type: ignore[arg-type]


def _shapes(assembly: Assembly, link_of: Mapping[str, str], X_W: Mapping[str, Pose]) -> Iterator[DescribedShape]:
    for one in assembly.components:
        link = link_of.get(one.path, SCREWS)
        if one.body >= 0 and link in X_W:
            mesh = assembly.bodies[one.body].mesh
            placed = TriMesh.of(one.X_WC.apply(mesh.vertices), mesh.faces)
            yield DescribedShape(link, one.path, placed, X_W[link].inverse())
