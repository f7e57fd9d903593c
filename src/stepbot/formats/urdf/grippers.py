"""The grippers of a robot's tree: what MoveIt calls end effectors.

A gripper is at the end of an arm: several joints of one body, two of which turn or slide in opposite directions. All
that moves there follows one joint; or each finger is a single prismatic joint of its own. A single jaw, which closes on
its own hand, moves as any last joint of an arm does: its name decides, if its range is that of a jaw.
"""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.bounding_boxes import is_jaw
from stepbot.robot.kinematics import link_poses, rigid_bodies
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Joint, JointKind, Robot

from .chains import Chain, chains, is_planned, module_of_joint, moving_joints

_OPPOSITE = -0.99
"""Cosine below which two directions are opposite."""


class Gripper(Struct, frozen=True):
    """The fingers at the end of a chain."""

    name: str
    """That of the link with the fingers, with ``_gripper``."""
    arm: str
    """Name of the chain that carries it."""
    link: str
    """The last link of that chain which carries the fingers."""
    joints: tuple[Joint, ...]
    """All joints of the fingers, those that follow others too."""
    is_by_name: bool = False
    """Whether the name of its only joint, or of the link below, is the evidence."""

    @property
    def independent(self) -> tuple[Joint, ...]:
        """The joints that move on their own."""
        return tuple(joint for joint in self.joints if joint.mimic is None)


Groups = tuple[tuple[Chain, ...], tuple[Gripper, ...]]


def groups(robot: Robot) -> Groups:
    """The chains of a robot that something drives, without those of its grippers, and the grippers."""
    all_chains = chains(robot)
    grippers = _grippers(robot, all_chains)
    fingers = {joint.name for gripper in grippers for joint in gripper.joints}
    arms = [chain for chain in all_chains if chain.joints[0].name not in fingers and is_planned(robot, chain)]
    carriers = {gripper.arm for gripper in grippers}
    split = [(arm, None) if arm.name in carriers else _without_jaw(robot, arm) for arm in arms]
    return _named(robot, [arm for arm, _ in split], [*grippers, *(jaw for _, jaw in split if jaw is not None)])


def _named(robot: Robot, arms: Sequence[Chain], grippers: Sequence[Gripper]) -> Groups:
    """The groups with the names of the modules that they are: a chain or gripper that is the only one of a module."""
    inside = module_of_joint(robot)
    every: list[Chain | Gripper] = [*arms, *grippers]
    modules = {one.name: {inside.get(joint.name, "") for joint in one.joints} for one in every}
    counts = Counter(module for of_one in modules.values() for module in of_one)
    new = {name: next(iter(of_one)) for name, of_one in modules.items() if len(of_one) == 1}
    new = {name: module if counts[module] == 1 and module else name for name, module in new.items()}
    return (
        tuple(replace(arm, name=new.get(arm.name, arm.name)) for arm in arms),
        tuple(replace(g, name=new.get(g.name, g.name), arm=new.get(g.arm, g.arm)) for g in grippers),
    )


def _without_jaw(robot: Robot, chain: Chain) -> tuple[Chain, Gripper | None]:
    """A chain without the single jaw at its end, and the jaw."""
    body, jaw = rigid_bodies(robot.root.name, robot.joints), chain.joints[-1]
    named = is_jaw((jaw.name, jaw.child), jaw.limit.lower, jaw.limit.upper)
    ends = body[jaw.child] == body[chain.tip]
    opens = jaw.kind.bounded
    if not (named and ends and opens) or len(chain.joints) < 2:
        return chain, None
    tip = [link.name for link in robot.links if body[link.name] == body[jaw.parent]][-1]
    arm = replace(chain, name=tip, tip=tip, joints=chain.joints[:-1])
    name = free_name(f"{jaw.parent}_gripper", "_group", {arm.name, jaw.name})
    return arm, Gripper(name, arm.name, jaw.parent, (jaw,), is_by_name=True)


def _grippers(robot: Robot, arms: Sequence[Chain]) -> tuple[Gripper, ...]:
    body, below = rigid_bodies(robot.root.name, robot.joints), moving_joints(robot)
    taken, poses = {chain.name for chain in arms}, link_poses(robot, {})
    grippers = []
    for chain in arms:
        hand = body[chain.tip]
        fingers = below.get(hand, [])
        if hand != body[robot.root.name] and _grip(fingers, below, poses):
            name = free_name(f"{fingers[0].parent}_gripper", "_group", taken)
            link = _on_chain(robot, chain, fingers[0].parent)
            grippers.append(Gripper(name, chain.name, link, tuple(_all_below(hand, below))))
    return tuple(grippers)


def _all_below(hand: str, below: Mapping[str, Sequence[Joint]]) -> list[Joint]:
    return [one for joint in below.get(hand, ()) for one in (joint, *_all_below(joint.child, below))]


def _grip(fingers: Sequence[Joint], below: Mapping[str, Sequence[Joint]], poses: Mapping[str, Pose]) -> bool:
    """Whether joints of one body, and all that is below them, are the fingers of a gripper."""
    moving = [one for finger in fingers for one in (finger, *_all_below(finger.child, below))]
    names = {joint.name for joint in moving}
    if any(joint.mimic is not None and joint.mimic.joint not in names for joint in moving):
        return False
    independent = [joint for joint in moving if joint.mimic is None]
    slides = all(joint.kind is JointKind.PRISMATIC for joint in moving) and len(moving) == len(fingers)
    if not (len(independent) == 1 or slides):
        return False
    ways = [(joint.kind is JointKind.PRISMATIC, _direction(joint, poses)) for joint in fingers]
    return any(a[0] == b[0] and float(a[1] @ b[1]) < _OPPOSITE for i, a in enumerate(ways) for b in ways[:i])


def _direction(joint: Joint, poses: Mapping[str, Pose]) -> Array:
    """The direction in which a joint moves when the gripper does, in the frame of the root."""
    axis = np.array(poses[joint.child].turn(joint.axis))
    return -axis if joint.mimic is not None and joint.mimic.multiplier < 0.0 else axis


def _on_chain(robot: Robot, chain: Chain, link: str) -> str:
    """The nearest link above that is between the base of a chain and its tip, and so in MoveIt's group."""
    above = {joint.child: joint.parent for joint in robot.joints}
    path, at = {chain.tip}, chain.tip
    while at != chain.base:
        at = above[at]
        path.add(at)
    while link not in path:
        link = above[link]
    return link
