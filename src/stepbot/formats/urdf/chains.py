"""The serial chains of a robot's tree: what MoveIt plans for."""

from collections import Counter
from collections.abc import Mapping, Sequence

from msgspec import Struct

from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import ActuatorKind, Joint, JointKind, Robot

from ..lowering.joints import UNLIMITED


class Chain(Struct, frozen=True):
    """A chain of links without branches, with joints that move on their own."""

    name: str
    """That of its tip."""
    base: str
    """The parent link of its first moving joint."""
    tip: str
    """The last link: of several fixed to it, such as frames of tools, the last in the file."""
    joints: tuple[Joint, ...]
    """The joints on it that move on their own, from the base on."""


def chains(robot: Robot) -> tuple[Chain, ...]:
    """The chains from the root or a branching on to the next branching or the end, in the order of the joints.

    An arm has the joints before it that it shares with short chains alone. Links fixed to each other count as one. A
    chain all of whose joints mimic others has nothing to plan, and one that begins with three unbounded slides is an
    object that nothing holds.
    """
    body, moving = rigid_bodies(robot.root.name, robot.joints), moving_joints(robot)
    last = {body[link.name]: link.name for link in robot.links}  # parents come before their children
    to_tips = []
    for along in _with_few_before(_unbranched(robot, moving), body):
        tip = last[along[-1].child]
        independent = tuple(joint for joint in along if joint.mimic is None)
        if independent and not _is_free(along):
            to_tips.append(Chain(tip, along[0].parent, tip, independent))
    return tuple(to_tips)


def _unbranched(robot: Robot, moving: Mapping[str, Sequence[Joint]]) -> list[list[Joint]]:
    """The joints of each chain from the root or a branching on to the next one or the end."""
    unbranched = []
    starts = [joint for at, joints in moving.items() if at == robot.root.name or len(joints) > 1 for joint in joints]
    for start in starts:
        along = [start]
        while len(after := moving.get(along[-1].child, [])) == 1:
            along += after
        unbranched.append(along)
    return unbranched


_FEW, _MANY = 2, 4
"""Most joints of a short chain, and of what it shares with an arm; least joints of an arm beyond them."""


def _with_few_before(unbranched: list[list[Joint]], body: Mapping[str, str]) -> list[list[Joint]]:
    """The chains; an arm has the joints that it shares with short chains alone: a Sawyer's first turns its head, too.

    Joints that two arms share, such as those of a torso, remain a chain of their own.
    """
    kept = list(unbranched)
    for before in unbranched:
        after = [along for along in unbranched if body[along[0].parent] == body[before[-1].child]]
        arms = [along for along in after if len(along) > _FEW]
        if len(before) <= _FEW and len(after) > 1 and len(arms) == 1 and len(arms[0]) >= _MANY:
            kept = [before + one if one is arms[0] else one for one in kept if one is not before]
    return kept


def is_planned(robot: Robot, chain: Chain) -> bool:
    """Whether there is something to plan for a chain: an actuator that is not a wheel's, or no actuator at all."""
    driven = {actuator.joint: actuator.kind for actuator in robot.actuators}
    kinds = [(joint.kind, driven[joint.name]) for joint in chain.joints if joint.name in driven]
    wheel = (JointKind.CONTINUOUS, ActuatorKind.VELOCITY)
    return not driven or any(kind != wheel for kind in kinds)


def passive_joints(robot: Robot) -> list[str]:
    """Joints that move on their own, without an actuator, on a robot that has some: hardware may not measure them."""
    driven = {actuator.joint for actuator in robot.actuators}
    moving = (joint for joint in robot.joints if joint.kind is not JointKind.FIXED and joint.mimic is None)
    return [joint.name for joint in moving if driven and joint.name not in driven]


def _is_free(along: Sequence[Joint]) -> bool:
    """Whether a chain is a floating joint, as URDF expresses it."""
    slides = along[:3]
    unbounded = (
        slide.kind is JointKind.PRISMATIC and min(-slide.limit.lower, slide.limit.upper) >= UNLIMITED
        for slide in slides
    )
    return len(slides) == 3 and all(unbounded)


def module_of_joint(robot: Robot) -> dict[str, str]:
    """The module that each joint is in, by the joint's name, as part of a name.

    Of modules in modules, the innermost, with the prefix of what it is in, as its elements have: ``arm_hand`` for
    ``arm/hand``, or ``hand`` if ``arm`` has no prefix. Joints between modules are left out, and all those of a robot
    that is one module alone.
    """
    inside: dict[str, str] = {}
    names = _module_names(robot)
    for module in robot.modules:  # modules of modules come after them
        links = set(module.links)
        for joint in robot.joints:
            if joint.parent in links and joint.child in links:
                inside[joint.name] = names[module.name]
    moving = {inside.get(joint.name, "") for joint in robot.joints if joint.kind is not JointKind.FIXED}
    return inside if len(moving) > 1 else {}


def _module_names(robot: Robot) -> dict[str, str]:
    """The names of modules in files, by their paths; of several that would have one name, the path is the name."""
    prefixes, names = {module.name: module.prefix for module in robot.modules}, dict[str, str]()
    for path in prefixes:
        around, _, name = path.rpartition("/")
        names[path] = f"{prefixes.get(around, '')}{name}"
    often = Counter(names.values())
    return {path: name if often[name] == 1 else path.replace("/", "_") for path, name in names.items()}


def moving_joints(robot: Robot) -> dict[str, list[Joint]]:
    """For each body, by its first link, the joints between it and those that move on it."""
    body, moving = rigid_bodies(robot.root.name, robot.joints), dict[str, list[Joint]]()
    for joint in robot.joints:
        if joint.kind is not JointKind.FIXED:
            moving.setdefault(body[joint.parent], []).append(joint)
    return moving
