"""Links that overlap in one configuration after the other, for a page that moves the robot."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isinf

import numpy as np

from stepbot.geometry.spatial import Vector3, vector3
from stepbot.robot.kinematics import Tree
from stepbot.robot.model import Robot

from .search import placed, separate_links
from .shapes import prepare

__all__ = ["Contact", "contacts", "prepare"]


@dataclass(frozen=True)
class Contact:
    """Two links that overlap."""

    link_a: str
    link_b: str
    depth: float | None
    """Penetration [m]; None between two surfaces, which have none."""
    point: Vector3 | None
    """Where the shapes overlap most [m], in the frame of ``link_a``; None for a link inside another."""


class _Search:
    """The links of one robot."""

    def __init__(self, robot: Robot) -> None:
        self.tree, self.pairs = Tree(robot), tuple(separate_links(robot))

    def contacts(self, q: Mapping[str, float]) -> tuple[Contact, ...]:
        """The links that overlap."""
        X = self.tree.frames(np.array([[q[name] for name in self.tree.joints]], dtype=np.float64))
        found = []
        for pair in self.pairs:
            (R,), (p,) = placed(self.tree, X, pair)
            if not pair.boxes_meet(R, p):
                continue
            deepest = pair.deepest(R, p)
            if deepest is not None:
                depth, point = deepest
                at = None if point is None else vector3(point)
                found.append(Contact(pair.a, pair.b, None if isinf(depth) else depth, at))
        return tuple(found)


class _Kept:
    """What this process keeps from one call to the next."""

    search: _Search | None = None


def contacts(robot: Robot | None, q: Mapping[str, float]) -> tuple[Contact, ...]:
    """The pairs of links that overlap in a configuration, except adjacent ones, in the order of the links.

    Args:
        robot: The robot; None for that of the previous call.
        q: Positions [rad] or [m] of all moving joints, by name.

    Raises:
        KeyError: A position is missing.
    """
    if robot is not None:
        _Kept.search = _Search(robot)
    assert _Kept.search is not None  # the first call has a robot
    return _Kept.search.contacts(q)
