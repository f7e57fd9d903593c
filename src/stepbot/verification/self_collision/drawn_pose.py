"""Finds links that overlap in the drawn pose although no joint connects them."""

from math import isinf

from stepbot.robot.kinematics import Tree, complete, initial_configuration
from stepbot.robot.model import Robot

from .search import placed, separate_links
from .shapes import prepare

Overlap = tuple[str, str, float | None]
"""Two links, and their penetration depth [m]; None between two surfaces, which have none."""

__all__ = ["Overlap", "overlaps", "prepare"]


def overlaps(robot: Robot) -> tuple[Overlap, ...]:
    """The pairs of links that overlap in the drawn pose, except adjacent ones, in the order of the links."""
    tree = Tree(robot)
    X = tree.frames(tree.follow(tree.vector(complete(robot, initial_configuration(robot))))[None])
    found = []
    for pair in separate_links(robot):
        R, p = placed(tree, X, pair)
        depth = pair.depth(R[0], p[0])
        if depth is not None:
            found.append((pair.a, pair.b, None if isinf(depth) else depth))
    return tuple(found)
