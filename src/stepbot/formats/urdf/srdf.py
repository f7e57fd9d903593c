"""SRDF, with which MoveIt plans: https://wiki.ros.org/srdf.

Its links and joints are the URDF's.
"""

from stepbot.robot.model import Base, Robot
from stepbot.robot.self_collision import PairClass, SelfCollision

from ..xml import Element, document, element, root
from .chains import chains

REASONS = {PairClass.ADJACENT: "Adjacent", PairClass.ALWAYS: "Always", PairClass.NEVER: "Never"}
"""As MoveIt's setup assistant words them; pairs that sometimes overlap are checked."""
HOME = "home"
"""Name of the state with the drawn pose."""


def srdf(name: str, found: SelfCollision, source: str, robot: Robot | None = None) -> bytes:
    """The SRDF of a robot: ``disable_collisions`` for adjacent pairs, and those that overlap always or never.

    Args:
        name: Name of the robot in the URDF.
        found: Which links can overlap.
        source: File name that the robot was built from.
        robot: The robot as the URDF expresses it, for its groups, their drawn pose, and how its root is connected with
            the world; None for pairs alone.
    """
    top = root("robot", source, name=name)
    if robot is not None:
        _groups(top, robot)
    for pair in found.pairs:
        if pair.kind in REASONS:
            element(top, "disable_collisions", link1=pair.link_a, link2=pair.link_b, reason=REASONS[pair.kind])
    return document(top)


def _groups(top: Element, robot: Robot) -> None:
    found = chains(robot)
    for chain in found:
        element(element(top, "group", name=chain.name), "chain", base_link=chain.base, tip_link=chain.tip)
    for chain in found:
        state = element(top, "group_state", name=HOME, group=chain.name)
        for joint in chain.joints:
            element(state, "joint", name=joint.name, value=joint.drawn_position)
    kind = "fixed" if robot.base is Base.FIXED else "floating"
    name = f"{robot.root.name}_to_world"
    element(top, "virtual_joint", name=name, type=kind, parent_frame="world", child_link=robot.root.name)
