"""The robot of a URDF, SDFormat or MJCF file, as the file describes it.

A body that MJCF moves by several joints, or by a joint beside its origin, gets links without shape in between. What the
page cannot show is listed, never left out in silence.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan

import numpy as np

from stepbot.engines.description import DescribedShape, Description
from stepbot.engines.observation import ObservedClosure, ObservedJoint, ObservedLink
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, ZERO3, ZERO33, Pose, perpendicular_frame
from stepbot.robot.kinematics import MOVING, TURNING
from stepbot.robot.model import (
    GREY,
    Actuator,
    ActuatorKind,
    Base,
    Collision,
    Frame,
    Geometry,
    Joint,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Robot,
    Visual,
)
from stepbot.robot.shared_meshes import share_meshes
from stepbot.robot.unique_names import free_name

_CLOSING = TURNING | {JointKind.BALL, JointKind.PRISMATIC, JointKind.FIXED}
"""Kinds of closures that the loop solver has."""


@dataclass(frozen=True)
class Described:
    """A robot, and what the page does not show of its file."""

    robot: Robot
    missing: tuple[str, ...]


def robot_of_description(description: Description, name: str, source: str) -> Described:
    """The robot of a description.

    Args:
        description: The content of the file.
        name: Name of the robot if the file has none.
        source: File name.
    """
    seen = description.observation
    missing = [f"mesh '{uri}' is missing or of an unsupported type" for uri in description.unread]
    assets = _Meshes()
    shown = description.seen
    solid = [shape for shape in description.shapes if shape.collides]
    links = {link.name: _link(link, shown, solid, assets) for link in seen.links}
    joints, extra = _tree(description, missing)
    order = [next(iter(links)), *(joint.child for joint in joints)]
    robot = Robot(
        seen.name or name,
        tuple(links.get(one) or extra[one] for one in order),
        _without_broken_mimics(joints, missing),
        tuple(_closures(seen.closures or (), set(links), missing)),
        tuple(Frame(one, link, X_LF) for one, (link, X_LF) in (seen.frames or {}).items() if link in links),
        _actuators(description, {joint.name for joint in joints}),
        assets.all(),
        Base.FLOATING if seen.base == Base.FLOATING else Base.FIXED,
        source,
    )
    return Described(_at_initial(share_meshes(robot), seen.initial or {}), tuple(missing))


class _Meshes:
    """Assets by number; equal objects are one."""

    def __init__(self) -> None:
        self._found: dict[int, tuple[TriMesh, MeshAsset]] = {}

    def geometry(self, shape: DescribedShape) -> Geometry:
        mesh = shape.geometry
        if not isinstance(mesh, TriMesh):
            return mesh
        if id(mesh) not in self._found:
            self._found[id(mesh)] = mesh, MeshAsset(f"mesh_{len(self._found)}", mesh)
        return MeshRef(self._found[id(mesh)][1].name)

    def all(self) -> tuple[MeshAsset, ...]:
        return tuple(sorted((asset for _, asset in self._found.values()), key=lambda asset: asset.name))


def _link(
    link: ObservedLink, shown: Sequence[DescribedShape], solid: Sequence[DescribedShape], assets: _Meshes
) -> Link:
    mass = MassProperties()
    if link.mass is not None:
        mass = MassProperties.of(link.mass, link.com or ZERO3, np.array(link.inertia or ZERO33))
    visuals = (
        Visual(f"{link.name}_{i}", assets.geometry(one), one.X_LG, one.rgba or GREY)
        for i, one in enumerate(shown)
        if one.link == link.name
    )
    collisions = (
        Collision(f"{link.name}_collision_{i}", assets.geometry(one), one.X_LG)
        for i, one in enumerate(solid)
        if one.link == link.name
    )
    return Link(link.name, mass, tuple(visuals), tuple(collisions))


def _tree(description: Description, missing: list[str]) -> tuple[list[Joint], dict[str, Link]]:
    """Joints from the root on, each parent before its children, and the links that stand between several joints."""
    seen = description.observation
    names = [link.name for link in seen.links]
    root = names[0]
    above: dict[str, list[ObservedJoint]] = {}
    for joint in seen.joints:
        if joint.child in names and joint.child != root and joint.parent in names:
            above.setdefault(joint.child, []).append(joint)
    below: dict[str, list[str]] = {}
    for child, found in above.items():
        below.setdefault(found[0].parent, []).append(child)
    joints: list[Joint] = []
    extra: dict[str, Link] = {}
    taken = {*names, *(joint.name for joint in seen.joints)}
    reached = [root]
    poses = seen.poses[0] if seen.poses else {}
    while True:
        for parent in reached:
            for child in below.pop(parent, []):
                joints += _chain(above[child], description.X_PC.get(child, IDENTITY), taken, extra, missing)
                reached.append(child)
        left = [name for name in names if name not in reached]
        if not left:
            return joints, extra
        loose = next((name for name in left if name not in above), left[0])
        X_RL = poses[root].inverse() @ poses[loose] if root in poses and loose in poses else IDENTITY
        joints.append(Joint(free_name(f"{loose}_fixed", "_joint", taken), JointKind.FIXED, root, loose, X_RL))
        reached.append(loose)
        for children in below.values():
            children[:] = [child for child in children if child != loose]


def _chain(
    found: Sequence[ObservedJoint], X_PC: Pose, taken: set[str], extra: dict[str, Link], missing: list[str]
) -> list[Joint]:
    """The joints between a parent and a child; anchors beside the child's origin become links in between."""
    steps = [step for joint in found for step in (joint.steps or (joint,))]
    steps = [replace(step, anchor=ZERO3) if step.kind == JointKind.FIXED else step for step in steps]
    parent, child = found[0].parent, found[0].child
    chain: list[Joint] = []
    X_PJ = X_PC @ Pose.of(position=steps[0].anchor)
    for index, step in enumerate(steps):
        is_last = index == len(steps) - 1
        to = child if is_last and step.anchor == ZERO3 else free_name(f"{child}_{index + 1}", "_link", taken)
        name = step.name or free_name(f"{child}_fixed", "_joint", taken)
        chain.append(_joint(step, name, parent, to, X_PJ, missing))
        if to != child:
            extra[to] = Link(to)
        if not is_last:
            X_PJ = Pose.of(position=np.subtract(steps[index + 1].anchor, step.anchor))
        parent = to
    if parent != child:
        X_JC = Pose.of(position=np.negative(steps[-1].anchor))
        chain.append(Joint(free_name(f"{child}_fixed", "_joint", taken), JointKind.FIXED, parent, child, X_JC))
    return chain


def _joint(seen: ObservedJoint, name: str, parent: str, child: str, X_PC: Pose, missing: list[str]) -> Joint:
    known = seen.kind in set(JointKind)
    kind = JointKind(seen.kind) if known else JointKind.FIXED
    if not known:
        missing.append(f"joint '{name}' of type '{seen.kind}' is shown as fixed")
    limit = seen.limit or Limit()
    axis = seen.axis or (0.0, 0.0, 1.0)
    if kind in MOVING and not 0.99 < float(np.linalg.norm(axis)) < 1.01:
        missing.append(f"joint '{name}' without an axis is shown as fixed")
        kind = JointKind.FIXED
    return Joint(
        name,
        kind,
        parent,
        child,
        X_PC,
        axis,
        seen.axis2 or (1.0, 0.0, 0.0),
        Limit(*(_bound(getattr(limit, field), other) for field, other in _UNLIMITED)),
        mimic=seen.mimic if kind in MOVING else None,
        pitch=seen.pitch or 0.0,
    )


_UNLIMITED = (("lower", -inf), ("upper", inf), ("velocity", inf), ("effort", inf))


def _bound(value: float, unlimited: float) -> float:
    """A bound; unlimited if the engine could not express it."""
    return unlimited if isnan(value) else value


def _without_broken_mimics(joints: Sequence[Joint], missing: list[str]) -> tuple[Joint, ...]:
    """The joints; a mimic whose leader does not move, or that follows itself, is dropped and listed."""
    by_name = {joint.name: joint for joint in joints if joint.kind in MOVING}
    found = []
    for joint in joints:
        leader: Joint | None = joint
        for _ in joints:
            if leader is None or leader.mimic is None:
                break
            leader = by_name.get(leader.mimic.joint)
        if joint.mimic is not None and (leader is None or leader.mimic is not None):
            missing.append(f"joint '{joint.name}' mimics '{joint.mimic.joint}', which does not move by itself")
            joint = replace(joint, mimic=None)
        found.append(joint)
    return tuple(found)


def _closures(seen: Iterable[ObservedClosure], links: set[str], missing: list[str]) -> Iterable[LoopClosure]:
    for number, one in enumerate(seen, start=1):
        name = one.name or f"closure {number}"
        kind = JointKind(one.kind) if one.kind in set(JointKind) else None
        X_AF, X_BF, axis = one.X_AF, one.X_BF, one.axis or (0.0, 0.0, 1.0)
        if kind is None and one.points is not None:
            kind = JointKind.BALL if one.axes is None else JointKind.REVOLUTE
            directions = one.axes or (axis, axis)
            X_AF, X_BF = (Pose.of(perpendicular_frame(d), p) for d, p in zip(directions, one.points, strict=True))
            axis = (0.0, 0.0, 1.0)
        if kind not in _CLOSING or X_AF is None or X_BF is None or not {one.link_a, one.link_b} <= links:
            missing.append(f"closure '{name}' of type '{one.kind}'")
            continue
        yield LoopClosure(name, kind, one.link_a, X_AF, one.link_b, X_BF, axis)


def _actuators(description: Description, joints: set[str]) -> tuple[Actuator, ...]:
    return tuple(
        Actuator(one.name or one.joint, one.joint, ActuatorKind(one.kind), one.kp, one.kv)
        for one in description.observation.actuators or ()
        if one.joint in joints and one.kind in set(ActuatorKind)
    )


def _at_initial(robot: Robot, initial: Mapping[str, float]) -> Robot:
    """The robot in the initial pose of its file."""
    joints = tuple(replace(joint, drawn_position=initial.get(joint.name, 0.0)) for joint in robot.joints)
    return replace(robot, joints=joints)
