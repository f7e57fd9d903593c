"""Configurations over the whole range of a robot: random ones, with closed loops, and those where something is largest.

Without loops, the independent joints are independent and uniform between their limits, so that a share of the samples
estimates a share of the range. Loops are closed by Newton's method on many random walks at once; these samples follow
one another on the walks, and cover the range without being independent.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, cross, dot, rotated

from .closures import LARGEST_JUMP, LARGEST_STEP, Loops, driven_joints, following
from .dynamics import GRAVITY
from .kinematics import MOVING, Tree, initial_configuration, leader_ranges, mimic_relation
from .model import JointKind, Robot
from .multi_dof import unfolded

MOST_WALKS = 250
"""Largest number of random walks through the configurations of closed loops."""
CROSSINGS = 2
"""Length of a walk: as many steps as take a driven joint this many times through its range."""
_PATIENCE = 20
"""Times as many steps as would be sufficient, if all succeeded, after which walks that are stuck are given up."""
_SLACK = 1e-9
_STARTS = 32
"""Number of configurations from the best of which a largest value is sought."""
_GRIDS = (1.0, 0.4, 0.1, 0.025)
"""Widths of the grids on which a largest value is sought, one after the other, as shares of the coordinate's range."""
_POINTS = 9
"""Points of such a grid, with its ends and its middle."""
_EQUAL = 9
"""Decimals of values, relative to the largest, that decide: the last bits of the linear algebra do not."""
_VARIED = 12
"""Largest number of joints, the nearest ones, on whose positions the inertia and the weight of a joint depend here."""
_SEARCHED = 5000
"""Largest product of joints and links of a robot whose worst postures are searched: some seconds."""
_BATCH = 4000
"""Links whose motion is computed for one start of all joints at once: below 100 MB."""


def sampled(robot: Robot, n: int, seed: int = 1) -> Array:
    """At most ``n`` configurations q (m, joints) [rad] or [m] over :attr:`Tree.joints`; the drawn pose is the first.

    Random numbers are from numpy's PCG64, the same on every machine. Fewer than ``n``: the drawn pose alone of a robot
    that cannot move, or loops that jam.

    Raises:
        DoesNotClose: The drawn pose is not closed.
    """
    robot = unfolded(robot)
    tree = Tree(robot)
    random = np.random.Generator(np.random.PCG64(seed))
    drawn = tree.vector(initial_configuration(robot))
    if not len(drawn):
        return tree.follow(drawn[None])
    ranges = np.array(list(leader_ranges(robot, tree.independent).values()))
    anywhere = ranges[:, 0] + random.random((n, len(drawn))) * (ranges[:, 1] - ranges[:, 0])
    if not robot.closures:
        anywhere[0] = drawn
        return tree.follow(anywhere)
    return tree.follow(_Walks(robot, drawn, ranges, random).configurations(n, anywhere))


def where_largest(
    robot: Robot,
    tree: Tree,
    coordinates: Sequence[Sequence[int]],
    values: Callable[[Array], Array],
    runs: int = 1,
    levels: int = 0,
) -> Array:
    """Configurations q (t, joints) [rad] or [m] over :attr:`Tree.joints` in which t values are largest, one for each.

    One coordinate after the other, on finer and finer grids, from the best of the drawn pose and random ones, in which
    joints that are equally deep in the tree are equally far through their range: equal limbs get equal values. The
    result is a local maximum; loops stay open.

    Args:
        robot: Its joints have one degree of freedom each.
        coordinates: Indices of the independent joints that each value depends on, at least one.
        values: The t values at m configurations each (t, m), of configurations (t, m, joints).
        runs: Number of starts, the best of whose results are returned.
        levels: Largest depth of a joint, plus 1, in the robot that this one is a part of; equal limbs get equal starts.
    """
    ranges = leader_ranges(robot, tree.independent)
    low, high = np.array([ranges[name] for name in tree.independent]).T
    each, longest = np.arange(len(coordinates)), max(map(len, coordinates))
    columns = [np.array([coordinate[step % len(coordinate)] for coordinate in coordinates]) for step in range(longest)]

    def best(tried: Array, count: int = 1) -> Array:
        """The configurations (t, count, k) of the largest values among some for each, (t, m, k)."""
        result = values(tree.follow(tried))
        scale = np.maximum(np.abs(result).max(axis=1, keepdims=True), np.finfo(float).tiny)
        order = np.argsort(-np.round(result / scale, _EQUAL), axis=1, kind="stable")[:, :count]
        return np.asarray(np.take_along_axis(tried, order[..., None], axis=1))

    depth = tree.depths()
    shares = np.random.Generator(np.random.PCG64(1)).random((_STARTS, max(levels, *depth + 1)))[:, depth]
    starts = low + shares * (high - low)
    starts[0] = np.clip(tree.vector(initial_configuration(robot)), low, high)
    from_each = best(np.tile(starts, (len(coordinates), 1, 1)), runs)
    for run in range(runs):
        u = from_each[:, run]
        for width in _GRIDS:
            for column in columns:
                start, end, here = low[column], high[column], u[each, column]
                if width < 1.0:
                    reach = 0.5 * width * (end - start)
                    start, end = np.maximum(start, here - reach), np.minimum(end, here + reach)
                tried = np.repeat(u[:, None], _POINTS + 1, axis=1)
                tried[each, 1:, column] = np.linspace(start, end, _POINTS, axis=1)
                u = best(tried)[:, 0]
        from_each[:, run] = u
    return tree.follow(best(from_each)[:, 0])


def worst_postures(robot: Robot, tree: Tree, of: Sequence[int]) -> tuple[Array, Array, Array] | None:
    """Where independent joints move the largest inertia, and where they hold the largest weight.

    Args:
        of: Indices of the joints (n,), at least one.

    Returns:
        Configurations (2 n, joints) [rad] or [m] over :attr:`Tree.joints`, first those of the inertias; the inertias
            (n,) without armatures; the magnitudes (n,) of the gravity forces. None for robots with loops, and for those
            of so many joints that the search would take longer than a conversion.
    """
    robot = unfolded(robot)
    if robot.closures or len(of) * len(tree.links) > _SEARCHED:
        return None
    postures = np.tile(tree.vector(initial_configuration(robot)), (2, len(of), 1))
    inertias, weights = np.empty(len(of)), np.empty(len(of))
    levels = int(max(tree.depths())) + 1
    for limb, places in _limbs(robot, tree, of):
        part = Tree(limb)
        column = {name: i for i, name in enumerate(part.independent)}
        columns = [i for i, name in enumerate(tree.independent) if name in column]
        size = max(1, _BATCH // (2 * len(part.links)))
        for some in (places[first : first + size] for first in range(0, len(places), size)):
            alone = [column[tree.independent[of[i]]] for i in some]
            u, inertias[some], weights[some] = _worst_postures(limb, part, alone, levels)
            postures[np.ix_((0, 1), some, columns)] = u.reshape(2, len(some), -1)
    return tree.follow(postures.reshape(2 * len(of), -1)), inertias, weights


def _limbs(robot: Robot, tree: Tree, of: Sequence[int]) -> Iterator[tuple[Robot, list[int]]]:
    """For joints whose values depend on the same links, a robot of these links alone, and their places in ``of``.

    The links are those that a joint moves, all above them, and what follows the joints between these.
    """
    above = {joint.child: joint for joint in robot.joints}
    coupled: dict[str, list[str]] = {}
    for name in tree.joints:
        coupled.setdefault(mimic_relation(robot, name)[0], []).append(name)
    limbs: dict[frozenset[str], list[int]] = {}
    for place, coordinate in enumerate(of):
        links, waiting = set[str](), tree.moved_by(coordinate)
        while waiting:
            if (link := waiting.pop()) in links:
                continue
            links.add(link)
            if joint := above.get(link):
                others = coupled[mimic_relation(robot, joint.name)[0]] if joint.name in tree.joints else ()
                waiting += [joint.parent, *(robot.joint_by_name[other].child for other in others)]
        limbs.setdefault(frozenset(links), []).append(place)
    for kept, places in limbs.items():
        alone = tuple(link for link in robot.links if link.name in kept)
        joints = tuple(joint for joint in robot.joints if joint.child in kept)
        yield Robot(robot.name, alone, joints, base=robot.base), places


def _worst_postures(robot: Robot, tree: Tree, of: Sequence[int], levels: int) -> tuple[Array, Array, Array]:
    """:func:`worst_postures` of some joints of a limb, over :attr:`Tree.independent`."""
    bodies = [link.mass_properties for link in robot.links]
    coms, masses, inertias = (
        np.array([getattr(body, field) for body in bodies]) for field in ("com", "mass", "inertia")
    )
    along = tree.B.T[[*of, *of], None]

    def values(q: Array) -> Array:
        """Inertias (n, m), then gravity forces (n, m), at q (2 n, m, joints)."""
        X_WL = tree.frames(q)
        turned, moved = tree.twists(X_WL, along)
        R_WL, p_WL = X_WL[..., :3, :3], X_WL[..., :3, 3]
        moved = moved + cross(turned, p_WL + rotated(R_WL, coms))
        lifted = np.abs((moved[len(of) :] @ np.array(GRAVITY)) @ masses)
        inside = rotated(R_WL.swapaxes(-1, -2), turned)[: len(of)]
        energy = dot(inside, rotated(inertias, inside)).sum(axis=-1) + dot(moved, moved)[: len(of)] @ masses
        return np.concatenate([energy, lifted])

    near = [sorted(tree.related(one), key=lambda other: abs(int(other) - one))[:_VARIED] for one in of]
    q = where_largest(robot, tree, [sorted(one) for one in (*near, *near)], values, levels=levels)
    inertia, weight = np.split(values(q[:, None])[:, 0], 2)
    return q[:, [tree.joints.index(name) for name in tree.independent]], inertia, weight


class _Walks:
    """Random walks of the driven joints of loops, from the drawn pose to one random target after the other."""

    def __init__(self, robot: Robot, drawn: Array, ranges: Array, random: "np.random.Generator") -> None:
        self._loops, self._random, self._ranges = Loops(robot), random, ranges
        tree = self._loops.tree
        names, driven = tree.independent, driven_joints(robot)
        self._free = following(tree, driven)
        self._start, _ = self._loops.closed(drawn, self._free)
        residual, J = self._loops.constraints(self._start)
        self._driven = [i for i, name in enumerate(names) if name in driven and J[:, i].any()]
        self._outside = [i for i, name in enumerate(names) if name in driven and not J[:, i].any()]
        self._open = 2.0 * float(np.linalg.norm(residual))
        joints = [robot.joint_by_name[name] for name in tree.joints]
        at_start = tree.follow(self._start)
        assert all(joint.kind in MOVING for joint in joints)
        self._low = np.minimum([joint.limit.lower for joint in joints], at_start) - _SLACK
        self._high = np.maximum([joint.limit.upper for joint in joints], at_start) + _SLACK
        sliding = [robot.joint_by_name[names[i]].kind is JointKind.PRISMATIC for i in self._driven]
        widths = np.ptp(ranges[self._driven], axis=1)
        self._stride = LARGEST_STEP * np.where(sliding, np.maximum(widths, _SLACK), 1.0)

    def configurations(self, n: int, anywhere: Array) -> Array:
        """At most ``n`` closed configurations (m, k), the drawn one first.

        Args:
            anywhere: Random configurations (n, k) with open loops, for the joints outside the loops.
        """
        widths = np.ptp(self._ranges[self._driven], axis=1) / self._stride
        walks = int(np.clip(n / (CROSSINGS * widths.max(initial=1.0)), 1, MOST_WALKS))
        u = np.tile(self._start, (walks, 1))
        velocity = np.zeros_like(u)
        targets = self._targets(walks)
        rows, count = [self._start[None]], 1
        for _ in range(_PATIENCE * (n // walks + 1) if self._driven else 0):
            if count >= n:
                break
            way = targets - u[:, self._driven]
            strides = (np.abs(way) / self._stride).max(axis=1)
            guess = u + velocity  # continue as before
            guess[:, self._driven] = u[:, self._driven] + way / np.maximum(strides, 1.0)[:, None]
            closed, passed = self._closed(guess, u)
            velocity = np.where(passed[:, None], closed - u, 0.0)
            u = np.where(passed[:, None], closed, u)
            rows.append(u[passed])
            count += int(passed.sum())
            new = ~passed | (strides <= 1.0)
            targets[new] = self._targets(int(new.sum()))
            velocity[new] = 0.0
        closed = np.concatenate(rows)[:n]
        closed[1:, self._outside] = anywhere[1 : len(closed), self._outside]
        return closed

    def _targets(self, n: int) -> Array:
        """Random targets (n, driven joints); one in six positions is an end of the range."""
        low, high = self._ranges[self._driven].T
        shares = np.clip(1.2 * self._random.random((n, len(low))) - 0.1, 0.0, 1.0)
        return np.asarray(low + shares * (high - low))

    def _closed(self, guess: Array, former: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Configurations (walks, k) near a guess, and which of them are closed, within limits and on their branch."""
        loops, free = self._loops, self._free
        u, residual, J = loops.closed_many(guess, free)
        q = loops.tree.follow(u)
        passed = np.linalg.norm(residual, axis=-1) <= max(loops.closed_share, self._open)
        passed &= ((self._low <= q) & (q <= self._high)).all(axis=1)
        passed &= (np.abs(u - former)[:, free] <= LARGEST_JUMP).all(axis=1)
        return u, passed & ~loops.singular_many(J, free)
