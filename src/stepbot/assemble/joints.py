"""Builds the joints of the tree and the loop closures from the resolved frames.

An origin gives the joint's frame, which is also the child's at q = 0. The CAD draws the joint at its ``zero``: there
the child's frame, and everything below it, is rotated or translated by that amount. A closure constrains the links as
drawn, the only pose in which the loop is known to close.
"""

from collections.abc import Iterable

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, Vector3, tidy, vector3
from stepbot.robot.joint_table import Evidence, JointRow
from stepbot.robot.model import SECOND_AXIS, Joint, JointKind, LoopClosure, Mimic
from stepbot.sidecar.document import Document
from stepbot.sidecar.joint_settings import joint_dynamics, joint_limits

from .binder import Binder
from .frames import Frames, OriginRequest

_DECIMALS = 12


def tree_order(document: Document) -> tuple[str, tuple[str, ...]]:
    """The root link, and the joints from the root down, depth first, in the sidecar's order.

    Raises:
        ValueError: There is no single root; the sidecar's own check should have reported it.
    """
    children = {joint.child for joint in document.joints.values()}
    roots = [link for link in document.links if link not in children]
    if len(roots) != 1:
        raise ValueError(f"a tree has one root; found {roots}")
    joints_of: dict[str, list[str]] = {}
    for name, joint in document.joints.items():
        joints_of.setdefault(joint.parent, []).append(name)
    order: list[str] = []
    waiting = joints_of.get(roots[0], [])[::-1]
    while waiting:
        name = waiting.pop()
        order.append(name)
        waiting += joints_of.get(document.joints[name].child, [])[::-1]
    return roots[0], tuple(order)


def build_joints(binder: Binder, frames: Frames, order: tuple[str, ...]) -> tuple[Joint, ...] | None:
    """The joints in tree order; None if a frame is unknown."""
    built = [_joint(binder.document, frames, name) for name in order]
    joints = tuple(joint for joint in built if joint is not None)
    return joints if len(joints) == len(built) else None


def build_closures(binder: Binder, frames: Frames) -> tuple[LoopClosure, ...] | None:
    """The closures, in the sidecar's order; None if a frame is unknown."""
    built = [_closure(binder.document, frames, name) for name in binder.document.closures]
    closures = tuple(closure for closure in built if closure is not None)
    return closures if len(closures) == len(built) else None


def joint_table(frames: Frames, joints: Iterable[Joint], closures: Iterable[LoopClosure]) -> tuple[JointRow, ...]:
    """The pose of every joint, then of every closure, as drawn, and how it was found."""
    rows = []
    for joint in joints:
        X_WJ, evidence = frames.joint(joint.name), frames.evidence("joints", joint.name, "origin")
        assert X_WJ is not None  # a joint without a frame is omitted
        row = _row(joint.name, joint.kind, (joint.parent, joint.child), X_WJ, joint.axis, evidence)
        is_universal = joint.kind is JointKind.UNIVERSAL
        rows.append(replace(row, axis2=direction_in(X_WJ, joint.axis2)) if is_universal else row)
    for closure in closures:
        X_WA, evidence = frames.link(closure.link_a), frames.evidence("closures", closure.name, "origin")
        assert X_WA is not None  # a closure without a frame is omitted
        ends = closure.link_a, closure.link_b
        row = _row(closure.name, closure.kind, ends, X_WA @ closure.X_AF, closure.axis, evidence)
        rows.append(replace(row, is_closure=True))
    return tuple(rows)


def _row(name: str, kind: JointKind, ends: tuple[str, str], X_WF: Pose, axis: Vector3, evidence: Evidence) -> JointRow:
    direction = direction_in(X_WF, axis) if kind.has_axis else None
    return JointRow(name, kind.value, *ends, tidy(X_WF).position, direction, evidence=evidence)


def direction_in(X_WF: Pose, axis: Vector3) -> Vector3:
    """An axis given in a frame, expressed in the assembly's, without the noise of the last bits."""
    return vector3(np.round(X_WF.turn(axis), _DECIMALS) + 0.0)


def _joint(document: Document, frames: Frames, name: str) -> Joint | None:
    section = document.joints[name]
    X_WP, X_WJ = frames.link(section.parent), frames.joint(name)
    if X_WP is None or X_WJ is None:
        return None
    X_PC = tidy(X_WP.inverse() @ X_WJ)  # at q = 0 the child's frame C is the joint's frame J
    leader = None if section.mimic is None else section.mimic.joint
    return joint_of(document, name, (section.parent, section.child), X_PC, leader)


def joint_of(document: Document, name: str, ends: tuple[str, str], X_PC: Pose, leader: str | None) -> Joint:
    """A joint of the sidecar between two links of the robot; ``leader`` is the joint that it mimics, if it does."""
    section = document.joints[name]
    mimic = section.mimic
    return Joint(
        name,
        section.type,
        *ends,
        X_PC,
        axis=section.axis,
        axis2=section.axis2 or SECOND_AXIS,
        limit=joint_limits(document, name),
        dynamics=joint_dynamics(document, name),
        mimic=None if mimic is None or leader is None else Mimic(leader, mimic.multiplier.value, mimic.offset.value),
        pitch=section.pitch or 0.0,
        drawn_position=section.zero.value,
    )


def _closure(document: Document, frames: Frames, name: str) -> LoopClosure | None:
    section = document.closures[name]
    ends, is_ball = (section.link_a, section.link_b), section.type is JointKind.BALL
    X_WF = frames.resolve(section.origin, OriginRequest(("closures", name, "origin"), ends, is_ball=is_ball))
    X_WA, X_WB = frames.link(section.link_a), frames.link(section.link_b)
    if X_WF is None or X_WA is None or X_WB is None:
        return None
    X_AF, X_BF = tidy(X_WA.inverse() @ X_WF), tidy(X_WB.inverse() @ X_WF)
    return LoopClosure(name, section.type, section.link_a, X_AF, section.link_b, X_BF, section.axis)
