"""The poses in which the collision shapes of two links overlap.

Boxes around links, then spheres and boxes around shapes, exclude most poses in a few array operations; of two balls,
the spheres are the answer. python-fcl compares what is left, until one pair of shapes overlaps: the time grows with the
number of poses in which links are near each other.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import isinf

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.solids.box_pairs import boxes_meet
from stepbot.geometry.spatial import Array
from stepbot.robot.kinematics import Tree, complete, initial_configuration, neighbours
from stepbot.robot.model import JointKind, Robot
from stepbot.robot.sampling import sampled
from stepbot.robot.self_collision import PairClass, PairContact, SelfCollision

from .shapes import TOUCHING, Pair, Shape, prepare, shapes_of

_MOST_DISTANCES = 1_000_000
"""Distances of shapes that are in memory at a time."""

Placed = tuple[Array, Array]
"""Rotations R_AB (n, 3, 3) and positions p_AB (n, 3) [m] of a link B in a link A."""


class LinkPair:
    """Two links that no joint connects, to be compared at many poses."""

    def __init__(self, a: str, b: str, shapes_a: Sequence[Shape], shapes_b: Sequence[Shape]) -> None:
        self.a, self.b = a, b
        self._shapes = shapes_a, shapes_b
        self._boxes = _around(shapes_a), _around(shapes_b)
        self._centers = tuple(np.array([shape.center for shape in shapes]) for shapes in self._shapes)
        radii, balls, surfaces = (
            tuple(np.array([value(shape) for shape in shapes]) for shapes in self._shapes)
            for value in (lambda one: one.radius, lambda one: one.is_ball, lambda one: int(one.surface is not None))
        )
        self._reach = np.add.outer(*radii)
        """Distance [m] of centres (a, b) below which the spheres around two shapes overlap."""
        self._are_balls = np.logical_and.outer(*balls)
        """Whether two shapes are balls (a, b), which overlap if and only if these spheres do."""
        order = np.argsort(np.add.outer(*surfaces).ravel(), kind="stable")
        self._order = [divmod(number, len(shapes_b)) for number in order.tolist()]  # solids are compared faster
        self._pairs: dict[tuple[int, int], Pair] = {}

    def overlapping(self, X_AB: Placed) -> NDArray[np.bool_]:
        """Whether the links overlap, at each of n poses."""
        overlap = np.zeros(len(X_AB[0]), dtype=bool)
        near = np.flatnonzero(boxes_meet(*self._boxes, *X_AB))
        step = max(_MOST_DISTANCES // self._reach.size, 1)
        for start in range(0, len(near), step):
            some = near[start : start + step]
            overlap[some] = self._overlapping(X_AB[0][some], X_AB[1][some])
        return overlap

    def _overlapping(self, R_AB: Array, p_AB: Array) -> NDArray[np.bool_]:
        squared = self._squared(R_AB, p_AB)
        touching = self._reach - TOUCHING
        overlap = np.asarray((self._are_balls & (squared < touching * touching)).any(axis=(1, 2)))
        meet = (squared <= self._reach * self._reach) & ~self._are_balls
        for i, j in self._order:
            near = np.flatnonzero(meet[:, i, j] & ~overlap)
            if len(near):
                R, p = R_AB[near], p_AB[near]
                pair = self._pair(i, j)
                boxes = np.flatnonzero(boxes_meet(_box(pair.a), _box(pair.b), R, p))
                overlap[near[boxes]] = [pair.overlap(R[k], p[k]) for k in boxes]
        return overlap

    def boxes_meet(self, R_AB: Array, p_AB: Array) -> bool:
        """Whether the boxes around both links overlap at a pose: if not, the links do not either."""
        return bool(boxes_meet(*self._boxes, R_AB[None], p_AB[None])[0])

    def depth(self, R_AB: Array, p_AB: Array) -> float | None:
        """Largest penetration [m] of any two shapes at a pose; infinite without a depth, None without an overlap."""
        contact = self.deepest(R_AB, p_AB)
        return None if contact is None else contact[0]

    def deepest(self, R_AB: Array, p_AB: Array) -> tuple[float, Array | None] | None:
        """:meth:`.Pair.deepest` of the two shapes that overlap most at a pose; None without an overlap."""
        (meet,) = self._squared(R_AB[None], p_AB[None]) <= self._reach * self._reach
        contacts = [self._pair(i, j).deepest(R_AB, p_AB) for i, j in self._order if meet[i, j]]
        return max(
            (contact for contact in contacts if contact is not None), key=lambda contact: contact[0], default=None
        )

    def _squared(self, R_AB: Array, p_AB: Array) -> Array:
        """Squared distances (n, a, b) [m^2] of the centres of all shapes, at each of n poses."""
        of_a, of_b = self._centers
        moved = of_b @ R_AB.swapaxes(-1, -2) + p_AB[:, None, :]
        gap = of_a[None, :, None, :] - moved[:, None, :, :]
        return np.asarray(gap[..., 0] ** 2 + gap[..., 1] ** 2 + gap[..., 2] ** 2)

    def _pair(self, i: int, j: int) -> Pair:
        if (i, j) not in self._pairs:
            self._pairs[i, j] = Pair(self._shapes[0][i], self._shapes[1][j])
        return self._pairs[i, j]


def separate_links(robot: Robot) -> Iterator[LinkPair]:
    """The pairs of links with collision shapes that are not adjacent, in the order of the links."""
    shapes, close = shapes_of(robot), neighbours(robot)
    for a, b in combinations([name for name, pieces in shapes.items() if pieces], 2):
        if frozenset((a, b)) not in close:
            yield LinkPair(a, b, shapes[a], shapes[b])


def placed(tree: Tree, X: Array, pair: LinkPair) -> Placed:
    """The poses of one link in the other.

    Args:
        X: The result of :meth:`Tree.frames` for n configurations.
    """
    X_WA, X_WB = (X[:, tree.link_index[name]] for name in (pair.a, pair.b))
    R_AW = X_WA[:, :3, :3].swapaxes(-1, -2)
    return R_AW @ X_WB[:, :3, :3], (R_AW @ (X_WB - X_WA)[:, :3, 3:])[..., 0]


def _box(shape: Shape) -> tuple[Array, Array]:
    return shape.low, shape.high


def _around(shapes: Sequence[Shape]) -> tuple[Array, Array]:
    return np.min([shape.low for shape in shapes], axis=0), np.max([shape.high for shape in shapes], axis=0)


Overlap = tuple[str, str, float | None]
"""Two links, and their penetration depth [m]; None between two surfaces, which have none."""


def overlaps(robot: Robot) -> tuple[Overlap, ...]:
    """The pairs of links that overlap in the drawn pose, except adjacent ones, in the order of the links."""
    tree = Tree(robot)
    X = tree.frames(tree.follow(tree.vector(complete(robot, initial_configuration(robot))))[None])
    results = []
    for pair in separate_links(robot):
        R, p = placed(tree, X, pair)
        depth = pair.depth(R[0], p[0])
        if depth is not None:
            results.append((pair.a, pair.b, None if isinf(depth) else depth))
    return tuple(results)


_AT_ONCE = 10_000
"""Poses whose frames are in memory at a time."""

__all__ = ["Overlap", "matrix", "overlaps", "prepare"]


def matrix(robot: Robot, samples: int, seed: int = 1) -> SelfCollision:
    """The classes of pairs of links with collision shapes, in at most ``samples`` configurations.

    Pairs of which one is on a part that moves freely are left out: they can meet anywhere.

    Raises:
        DoesNotClose: The drawn pose is not closed.
    """
    tree, q = Tree(robot), sampled(robot, samples, seed)
    part = _free_parts(robot)
    separate = [pair for pair in separate_links(robot) if part[pair.a] == part[pair.b]]
    overlapping: list[list[NDArray[np.int64]]] = [[] for _ in separate]
    for start in range(0, len(q), _AT_ONCE):
        X = tree.frames(q[start : start + _AT_ONCE])
        for pair, overlap in zip(separate, overlapping, strict=True):
            overlap.append(start + np.flatnonzero(pair.overlapping(placed(tree, X, pair))))
    compared = {
        (pair.a, pair.b): _classified(pair, np.concatenate(overlap), tree, q)
        for pair, overlap in zip(separate, overlapping, strict=True)
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


def _free_parts(robot: Robot) -> dict[str, str]:
    """For each link the root of the part that moves freely: the robot's root, or the child of a floating joint."""
    part = {robot.root.name: robot.root.name}
    for joint in robot.joints:
        part[joint.child] = joint.child if joint.kind is JointKind.FLOATING else part[joint.parent]
    return part
