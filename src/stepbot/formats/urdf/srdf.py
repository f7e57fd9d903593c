"""SRDF, which tells MoveIt which pairs of links need no collision check: https://wiki.ros.org/srdf.

Its links are the URDF's, which adds links to those of the robot and renames none.
"""

from stepbot.robot.self_collision import PairClass, SelfCollision

from ..xml import document, element, root

REASONS = {PairClass.ADJACENT: "Adjacent", PairClass.ALWAYS: "Always", PairClass.NEVER: "Never"}
"""As MoveIt's setup assistant words them; pairs that sometimes overlap are checked."""


def srdf(name: str, found: SelfCollision, source: str) -> bytes:
    """The SRDF of a robot: ``disable_collisions`` for adjacent pairs, and those that overlap always or never.

    Args:
        name: Name of the robot in the URDF.
        found: Which links can overlap.
        source: File name that the robot was built from.
    """
    top = root("robot", source, name=name)
    for pair in found.pairs:
        if pair.kind in REASONS:
            element(top, "disable_collisions", link1=pair.link_a, link2=pair.link_b, reason=REASONS[pair.kind])
    return document(top)
