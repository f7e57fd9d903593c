"""The poses in which the collision shapes of two links overlap.

Boxes around links, then boxes around shapes, exclude most poses in a few array operations. python-fcl compares what is
left, until one pair of shapes overlaps: the time grows with the number of poses in which links are near each other.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.solids.box_pairs import boxes_meet
from stepbot.geometry.spatial import Array
from stepbot.robot.kinematics import Tree, neighbours
from stepbot.robot.model import Robot

from .shapes import Pair, Shape, shapes_of

Placed = tuple[Array, Array]
"""Rotations R_AB (n, 3, 3) and positions p_AB (n, 3) [m] of a link B in a link A."""


class LinkPair:
    """Two links that no joint connects, to be compared at many poses."""

    def __init__(self, a: str, b: str, shapes_a: Sequence[Shape], shapes_b: Sequence[Shape]) -> None:
        self.a, self.b = a, b
        pairs = [Pair(x, y) for x in shapes_a for y in shapes_b]
        self._pairs = sorted(pairs, key=lambda pair: pair.surfaces)  # solids are compared faster
        self._boxes = _around(shapes_a), _around(shapes_b)

    def overlapping(self, X_AB: Placed) -> NDArray[np.bool_]:
        """Whether the links overlap, at each of n poses."""
        overlap = np.zeros(len(X_AB[0]), dtype=bool)
        near = np.flatnonzero(boxes_meet(*self._boxes, *X_AB))
        for pair in self._pairs:
            near = near[~overlap[near]]
            R, p = X_AB[0][near], X_AB[1][near]
            meeting = np.flatnonzero(boxes_meet(_box(pair.a), _box(pair.b), R, p)) if len(near) else near
            overlap[near[meeting]] = [pair.penetration(R[i], p[i]) is not None for i in meeting]
        return overlap

    def boxes_meet(self, R_AB: Array, p_AB: Array) -> bool:
        """Whether the boxes around both links overlap at a pose: if not, the links do not either."""
        return bool(boxes_meet(*self._boxes, R_AB[None], p_AB[None])[0])

    def depth(self, R_AB: Array, p_AB: Array) -> float | None:
        """Largest penetration [m] of any two shapes at a pose; infinite without a depth, None without an overlap."""
        found = self.deepest(R_AB, p_AB)
        return None if found is None else found[0]

    def deepest(self, R_AB: Array, p_AB: Array) -> tuple[float, Array | None] | None:
        """:meth:`.Pair.deepest` of the two shapes that overlap most at a pose; None without an overlap."""
        found = [pair.deepest(R_AB, p_AB) for pair in self._pairs]
        return max((one for one in found if one is not None), key=lambda one: one[0], default=None)


def separate_links(robot: Robot) -> Iterator[LinkPair]:
    """The pairs of links with collision shapes that are not adjacent, in the order of the links."""
    shapes, close = shapes_of(robot), neighbours(robot)
    for a, b in combinations([name for name, found in shapes.items() if found], 2):
        if frozenset((a, b)) not in close:
            yield LinkPair(a, b, shapes[a], shapes[b])


def placed(tree: Tree, X: Array, pair: LinkPair) -> Placed:
    """The poses of one link in the other.

    Args:
        tree: The robot's tree.
        X: The result of :meth:`Tree.frames` for n configurations.
        pair: The links.
    """
    X_WA, X_WB = (X[:, tree.link_index[name]] for name in (pair.a, pair.b))
    R_AW = X_WA[:, :3, :3].swapaxes(-1, -2)
    return R_AW @ X_WB[:, :3, :3], (R_AW @ (X_WB - X_WA)[:, :3, 3:])[..., 0]


def _box(shape: Shape) -> tuple[Array, Array]:
    return shape.low, shape.high


def _around(shapes: Sequence[Shape]) -> tuple[Array, Array]:
    return np.min([shape.low for shape in shapes], axis=0), np.max([shape.high for shape in shapes], axis=0)
