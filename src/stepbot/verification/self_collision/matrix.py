"""Classifies all pairs of links by how often they overlap in sampled configurations; the drawn pose is the first."""

from itertools import combinations
from math import isinf

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array
from stepbot.robot.kinematics import Tree, free_parts, neighbours
from stepbot.robot.model import Robot
from stepbot.robot.sampling import sampled
from stepbot.robot.self_collision import PairClass, PairContact, SelfCollision

from .search import LinkPair, placed, separate_links
from .shapes import prepare

_AT_ONCE = 10_000
"""Poses whose frames are in memory at a time."""

__all__ = ["matrix", "prepare"]


def matrix(robot: Robot, samples: int, seed: int = 1) -> SelfCollision:
    """The classes of pairs of links with collision shapes, in at most ``samples`` configurations.

    Pairs of which one is on a part that moves freely are left out: they can meet anywhere.

    Raises:
        DoesNotClose: The drawn pose is not closed.
    """
    tree, q = Tree(robot), sampled(robot, samples, seed)
    part = free_parts(robot)
    separate = [pair for pair in separate_links(robot) if part[pair.a] == part[pair.b]]
    overlapping: list[list[NDArray[np.int64]]] = [[] for _ in separate]
    for start in range(0, len(q), _AT_ONCE):
        X = tree.frames(q[start : start + _AT_ONCE])
        for pair, found in zip(separate, overlapping, strict=True):
            found.append(start + np.flatnonzero(pair.overlapping(placed(tree, X, pair))))
    compared = {
        (pair.a, pair.b): _classified(pair, np.concatenate(found), tree, q)
        for pair, found in zip(separate, overlapping, strict=True)
    }
    close, links = neighbours(robot), [link.name for link in robot.links if link.collisions]
    pairs = (
        PairContact(a, b, PairClass.ADJACENT) if frozenset((a, b)) in close else compared[a, b]
        for a, b in combinations(links, 2)
        if part[a] == part[b] or frozenset((a, b)) in close
    )
    return SelfCollision(len(q), tuple(pairs))


def _classified(pair: LinkPair, overlapping: NDArray[np.int64], tree: Tree, q: Array) -> PairContact:
    """A pair, with the indices of the configurations in which it overlaps."""
    count = len(overlapping)
    if not count:
        return PairContact(pair.a, pair.b, PairClass.NEVER)
    first = int(overlapping[0])
    (R,), (p,) = placed(tree, tree.frames(q[first : first + 1]), pair)
    depth = pair.depth(R, p)
    return PairContact(
        pair.a,
        pair.b,
        PairClass.ALWAYS if count == len(q) else PairClass.SOMETIMES,
        count,
        None if depth is None or isinf(depth) else depth,
        first,
        tuple(zip(tree.joints, q[first].tolist(), strict=True)),
    )
