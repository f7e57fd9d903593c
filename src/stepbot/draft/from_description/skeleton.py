"""The tree of an existing description: links with their masses and points, joints with their frames at q = 0.

The frame of each link is that of the joint above it. Links without mass and shape at the end of a fixed joint become
named frames; a ``world`` above the first link with mass is removed.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.description import Description
from stepbot.engines.observation import ObservedJoint, ObservedLink
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO3, ZERO33, Array, Pose
from stepbot.robot.kinematics import displacement
from stepbot.robot.model import Base, Frame, Joint, JointDynamics, JointKind, Limit

_CLOSING = {"connect": JointKind.BALL}
_ONE_AXIS = 1e-6


class SkeletonLink(Struct, frozen=True, eq=False):
    """A link."""

    name: str
    inertial: MassProperties
    points: Array
    """Vertices (n, 3) [m] of its shapes, in its frame; empty without shapes, or if their files are missing."""


class SkeletonClosure(Struct, frozen=True, eq=False):
    """A joint that closes a loop, in the frame of its first link."""

    name: str
    kind: JointKind
    link_a: str
    link_b: str
    point: Array
    axis: Array | None


class Skeleton(Struct, frozen=True, eq=False):
    """A described robot."""

    links: Mapping[str, SkeletonLink]
    """The root first, each parent before its children."""
    joints: Mapping[str, Joint]
    """By child, in the order of the links."""
    frames: tuple[Frame, ...]
    closures: tuple[SkeletonClosure, ...]
    base: Base
    notes: tuple[str, ...]
    """Elements that were not used."""

    @property
    def root(self) -> str:
        """The root link."""
        return next(iter(self.links))

    def poses(self, X_WR: Pose, q: Mapping[str, float]) -> dict[str, Pose]:
        """X_WL of all links, from the pose of the root and joint positions by child; missing positions are 0."""
        poses = {self.root: X_WR}
        for child, joint in self.joints.items():
            poses[child] = poses[joint.parent] @ joint.X_PC @ displacement(joint, q.get(child, 0.0))
        return poses

    def rigid_groups(self) -> dict[str, str]:
        """For each link the first of those that are fixed together."""
        first = {self.root: self.root}
        for child, joint in self.joints.items():
            first[child] = first[joint.parent] if joint.kind is JointKind.FIXED else child
        return first


def skeleton(description: Description) -> Skeleton | None:
    """The tree of a description; None without links."""
    seen = description.observation
    above: dict[str, ObservedJoint] = {}
    notes: list[str] = []
    for joint in seen.joints:
        if joint.child in above:
            notes.append(f"joint '{joint.name}' is one of several of link '{joint.child}': only the first is taken")
        else:
            above.setdefault(joint.child, joint)
    links = {link.name: link for link in seen.links}
    trees = [_tree(name, above) for name in links if name not in above or above[name].parent not in links]
    if not trees:
        return None
    order = max(trees, key=len)
    if len(trees) > 1:
        notes.append(f"bodies beside the robot are left out: {', '.join(t[0] for t in trees if t is not order)}")
    points = _points(description, order)
    shift = {name: Pose.of(position=above[name].anchor) if name in above else Pose() for name in order}
    whole = {name: _link(links[name], points[name], shift[name]) for name in order}
    joints = {n: _joint(above[n], shift[above[n].parent].inverse() @ description.X_PC[n] @ shift[n]) for n in order[1:]}
    base = Base.FLOATING if seen.base == "floating" else Base.FIXED
    root = order[0]
    held = [joint.kind for joint in joints.values() if joint.parent == root]
    if root == "world" and _is_empty(whole[root]) and held == [JointKind.FIXED]:
        del whole[root], joints[next(iter(joints))]
    frames, kept, gone = _frames(whole, joints)
    for name, (link, X_LF) in (seen.frames or {}).items():
        if link in kept and not _is_of_closure(name, description):
            frames.append(Frame(name, link, shift[link].inverse() @ X_LF))
    notes += _left_out(description)
    return Skeleton(
        kept,
        {child: joint for child, joint in joints.items() if child not in gone},
        tuple(frames),
        _closures(description, shift, kept),
        base,
        tuple(notes),
    )


def _tree(root: str, above: Mapping[str, ObservedJoint]) -> list[str]:
    """Links from a root down, parents first."""
    order = [root]
    for name in order:
        order += [child for child, joint in above.items() if joint.parent == name and child not in order]
    return order


def _points(description: Description, names: Sequence[str]) -> dict[str, Array]:
    by_link: dict[str, list[Array]] = {name: [np.zeros((0, 3))] for name in names}
    for shape in description.seen:
        if shape.link in by_link:
            by_link[shape.link].append(shape.points)
    return {name: np.concatenate(points) for name, points in by_link.items()}


def _link(link: ObservedLink, points: Array, shift: Pose) -> SkeletonLink:
    inertial = MassProperties.of(link.mass or 0.0, link.com or ZERO3, np.array(link.inertia or ZERO33))
    back = shift.inverse()
    return SkeletonLink(link.name, inertial.moved(back), back.apply(points))


def _joint(joint: ObservedJoint, X_PC: Pose) -> Joint:
    kind = JointKind(joint.kind) if joint.kind in set(JointKind) else JointKind.FIXED
    limit = joint.limit or Limit()
    if kind is JointKind.CONTINUOUS and np.isfinite([limit.lower, limit.upper]).any():
        kind = JointKind.REVOLUTE
    mimic = joint.mimic
    return Joint(
        joint.name or f"{joint.child}_joint",
        kind,
        joint.parent,
        joint.child,
        X_PC,
        axis=joint.axis or (0.0, 0.0, 1.0),
        axis2=joint.axis2 or (1.0, 0.0, 0.0),
        limit=limit,
        dynamics=joint.dynamics or JointDynamics(),
        mimic=mimic,
        pitch=joint.pitch or 0.0,
    )


def _is_empty(link: SkeletonLink) -> bool:
    return not link.inertial.mass and not len(link.points)


def _frames(
    links: Mapping[str, SkeletonLink], joints: Mapping[str, Joint]
) -> tuple[list[Frame], dict[str, SkeletonLink], set[str]]:
    """Empty links at the end of fixed joints as frames, the remaining links, and the names of the others."""
    root = next(iter(links))
    gone: dict[str, Frame] = {}
    for name in reversed(list(links)):
        has_children = any(joint.parent == name and child not in gone for child, joint in joints.items())
        if name != root and _is_empty(links[name]) and joints[name].kind is JointKind.FIXED and not has_children:
            gone[name] = Frame(name, joints[name].parent, joints[name].X_PC)
    frames = []
    for frame in reversed(gone.values()):
        while frame.link in gone:
            outer = gone[frame.link]
            frame = replace(frame, link=outer.link, X_LF=outer.X_LF @ frame.X_LF)
        frames.append(frame)
    return frames, {name: link for name, link in links.items() if name not in gone}, set(gone)


def _closures(
    description: Description, shift: Mapping[str, Pose], kept: Mapping[str, SkeletonLink]
) -> tuple[SkeletonClosure, ...]:
    closures = []
    for seen in description.observation.closures or ():
        if seen.points is None or seen.link_a not in kept or seen.link_b not in kept:
            continue
        kind = JointKind(seen.kind) if seen.kind in set(JointKind) else _CLOSING.get(seen.kind, JointKind.BALL)
        axis = None if seen.axes is None else np.array(seen.axes[0])
        if axis is not None and kind is JointKind.BALL and float(np.linalg.norm(axis)) > _ONE_AXIS:
            kind = JointKind.REVOLUTE  # two points on one line are constrained
        point = shift[seen.link_a].inverse().apply(seen.points[0])
        closures.append(SkeletonClosure(seen.name, kind, seen.link_a, seen.link_b, point, axis))
    return tuple(closures)


def _is_of_closure(frame: str, description: Description) -> bool:
    """Whether a frame is a site of a closure."""
    names = [closure.name for closure in description.observation.closures or () if closure.name]
    return any(frame.startswith(f"{name}/") for name in names)


def _left_out(description: Description) -> list[str]:
    """Elements of a description that a draft does not support."""
    seen = description.observation
    notes = []
    for noun, count in (("actuator", len(seen.actuators or ())), ("sensor", len(seen.sensors or ()))):
        if count:
            notes.append(f"{count} {noun}{'s' * (count > 1)} of the description not taken over")
    if description.unread:
        shown = ", ".join(description.unread[:3]) + (", ..." if len(description.unread) > 3 else "")
        notes.append(f"{len(description.unread)} mesh files of the description missing or not read: {shown}")
    return notes
