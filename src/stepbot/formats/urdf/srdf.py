"""SRDF, with which MoveIt plans: https://wiki.ros.org/srdf.

Its links and joints are the URDF's.
"""

from collections.abc import Sequence

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.kinematics import neighbours
from stepbot.robot.model import Base, Joint, Robot
from stepbot.robot.self_collision import PairClass, SelfCollision

from ..xml import Element, document, element, root
from .chains import passive_joints
from .grippers import groups

REASONS = {PairClass.ADJACENT: "Adjacent", PairClass.ALWAYS: "Always", PairClass.NEVER: "Never"}
"""As MoveIt's setup assistant words them; pairs that sometimes overlap are checked."""
_STATED = "User"
"""The same for pairs that somebody excluded."""
HOME = "home"
"""Name of the state with the drawn pose."""
ZERO = "zero"
"""Name of the state with all joints at q = 0, where their limits allow it."""


def srdf(
    name: str,
    self_collision: SelfCollision | None,
    source: str,
    robot: Robot | None = None,
    *,
    excluded: Sequence[tuple[str, str]] = (),
) -> bytes:
    """The SRDF of a robot: ``disable_collisions`` for adjacent pairs, and those that overlap always or never.

    Without a search, of adjacent pairs and those that the robot's source excludes.

    Args:
        name: Name of the robot in the URDF.
        self_collision: Which links can overlap; None if that was not searched.
        source: File name that the robot was built from.
        robot: The robot as the URDF expresses it, for its groups, their drawn pose, and how its root is connected with
            the world; None for pairs alone.
    """
    top = root("robot", source, name=name)
    if robot is not None:
        _groups(top, robot)
    disabled: dict[tuple[str, ...], str] = {}
    if self_collision is not None:
        disabled = {
            (pair.link_a, pair.link_b): REASONS[pair.kind] for pair in self_collision.pairs if pair.kind in REASONS
        }
    elif robot is not None:
        disabled = dict.fromkeys(sorted(tuple(sorted(pair)) for pair in neighbours(robot)), REASONS[PairClass.ADJACENT])
    known = {frozenset(pair) for pair in disabled}
    disabled |= {pair: _STATED for pair in excluded if frozenset(pair) not in known}
    for (a, b), reason in disabled.items():
        element(top, "disable_collisions", link1=a, link2=b, reason=reason)
    return document(top)


def report_guesses(robot: Robot, diagnostics: Diagnostics) -> None:
    """Report grippers that are known by their names alone (SB642)."""
    _, grippers = groups(robot)
    for gripper in (one for one in grippers if one.is_by_name):
        (jaw,) = gripper.joints
        message = f"joint '{jaw.name}' is taken as a gripper by its name: group '{gripper.name}' of MoveIt"
        diagnostics.add("SB642", message, Span(f"{robot.name}.srdf"))


def _groups(top: Element, robot: Robot) -> None:
    planned, grippers = groups(robot)
    for chain in planned:
        element(element(top, "group", name=chain.name), "chain", base_link=chain.base, tip_link=chain.tip)
    for gripper in grippers:
        group = element(top, "group", name=gripper.name)
        for joint in gripper.joints:
            element(group, "joint", name=joint.name)
    for chain in planned:
        _states(top, chain.name, chain.joints)
    for gripper in grippers:
        _states(top, gripper.name, gripper.independent)
        ends = {"parent_link": gripper.link, "group": gripper.name, "parent_group": gripper.arm}
        element(top, "end_effector", name=gripper.name, **ends)
    kind = "fixed" if robot.base is Base.FIXED else "floating"
    name = f"{robot.root.name}_to_world"
    element(top, "virtual_joint", name=name, type=kind, parent_frame="world", child_link=robot.root.name)
    for passive in passive_joints(robot):  # MoveIt waits for the positions of all others
        element(top, "passive_joint", name=passive)


def _states(top: Element, group: str, joints: Sequence[Joint]) -> None:
    """The drawn pose, and q = 0 if that is another pose and within the limits."""
    poses = {HOME: {joint.name: joint.drawn_position for joint in joints}}
    if any(poses[HOME].values()) and all(joint.limit.lower <= 0.0 <= joint.limit.upper for joint in joints):
        poses[ZERO] = dict.fromkeys(poses[HOME], 0.0)
    for name, pose in poses.items():
        state = element(top, "group_state", name=name, group=group)
        for joint, position in pose.items():
            element(state, "joint", name=joint, value=position)
