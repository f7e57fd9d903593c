"""Forward kinematics, Jacobians and joint ranges of a robot.

A configuration maps names of coordinates to positions [rad] or [m]. The root link's frame is the world's. A joint of
one degree of freedom is its own coordinate: revolute and continuous joints rotate about their axis, prismatic ones
translate along it, screws do both. The coordinates of a multi-dof joint are those of its equivalent chain
(:mod:`stepbot.robot.multi_dof`).
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import combinations
from math import pi

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, Pose, cross, cross_matrix, matrix_product, rotation_about

from .joint_types import kinds_with
from .model import Joint, JointKind, Robot
from .multi_dof import unfolded

Configuration = Mapping[str, float]

MOVING = frozenset(kinds_with(coordinates=1))
"""Types of joints that have one coordinate."""

WIDEST_ANGLE = pi
"""Angle [rad] to either side in which a rotating joint without limits is sampled."""
WIDEST_TRAVEL = 1.0
"""Distance [m] to either side in which a prismatic joint without limits is sampled."""
_SLACK = 1e-9
"""Distance [rad] or [m] by which a position at a limit may be beyond it."""
NO_BOUND = 1e6
"""Limits [rad] or [m] beyond this mean unlimited: formats that require a number get an unreachable one."""


def moving_joints(robot: Robot) -> tuple[Joint, ...]:
    """The coordinates of every Jacobian and mass matrix here, in tree order: joints of one degree of freedom."""
    return tuple(joint for joint in unfolded(robot).joints if joint.kind in MOVING)


def independent_joints(robot: Robot) -> tuple[Joint, ...]:
    """The moving joints that are not mimics."""
    return tuple(joint for joint in moving_joints(robot) if joint.mimic is None)


def mimic_relation(robot: Robot, name: str) -> tuple[str, float, float]:
    """Leader, multiplier and offset of a joint, through the whole chain of mimics; itself, 1 and 0 for a leader.

    Raises:
        KeyError: A joint of the chain does not exist.
        ValueError: The chain is a cycle.
    """
    multiplier, offset = 1.0, 0.0
    if name not in robot.joint_by_name:
        robot = unfolded(robot)
    leader = robot.joint_by_name[name]
    for _ in robot.joints:
        if leader.mimic is None:
            return leader.name, multiplier, offset
        offset += multiplier * leader.mimic.offset
        multiplier *= leader.mimic.multiplier
        leader = robot.joint_by_name[leader.mimic.joint]
    raise ValueError(f"joint '{name}': mimics itself")


def complete(robot: Robot, q: Configuration) -> dict[str, float]:
    """A position [rad] or [m] of every moving joint: from ``q``, else 0; mimics always follow their leader.

    Raises:
        KeyError: ``q`` contains a name that is not a moving joint.
    """
    robot = unfolded(robot)
    joints = moving_joints(robot)
    unknown = sorted(set(q) - {joint.name for joint in joints})
    if unknown:
        raise KeyError(f"no moving joint '{unknown[0]}'")
    full = {}
    for joint in joints:
        leader, multiplier, offset = mimic_relation(robot, joint.name)
        full[joint.name] = multiplier * float(q.get(leader, 0.0)) + offset
    return full


def initial_configuration(robot: Robot) -> dict[str, float]:
    """Positions [rad] or [m] in the pose drawn in the CAD: closures are closed, and simulation starts here."""
    return {joint.name: joint.drawn_position for joint in moving_joints(robot)}


class Tree:
    """A robot's tree as arrays: built once, evaluated at many configurations.

    Configurations are vectors here: ``q`` (n,) over :attr:`joints`, ``u`` (k,) over :attr:`independent`. Those of
    many configurations at once have further dimensions in front, and so have the results. The chains of multi-dof
    joints have links of their own in :attr:`links`.
    """

    def __init__(self, robot: Robot) -> None:
        robot = unfolded(robot)
        self.links = tuple(link.name for link in robot.links)
        self.joints = tuple(joint.name for joint in moving_joints(robot))
        self.independent = tuple(joint.name for joint in independent_joints(robot))
        self.link_index = {name: i for i, name in enumerate(self.links)}
        self._lay_out_joints(robot)
        self._lay_out_mimics(robot)

    def _lay_out_joints(self, robot: Robot) -> None:
        column = {name: i for i, name in enumerate(self.joints)}
        moving = [robot.joint_by_name[name] for name in self.joints]
        self._turn = np.array([joint.kind is not JointKind.PRISMATIC for joint in moving], dtype=np.float64)
        self._advance = np.array([advance(joint) for joint in moving], dtype=np.float64)
        self._axis = np.array([joint.axis for joint in moving], dtype=np.float64).reshape(-1, 3)
        self._K = np.array([cross_matrix(joint.axis) for joint in moving]).reshape(-1, 3, 3)
        self._KK = matrix_product(self._K, self._K)
        self._child = np.array([self.link_index[joint.child] for joint in moving], dtype=int)
        self._above = np.zeros((len(self.links), len(self.joints)), dtype=bool)
        depth = {robot.root.name: 0}
        at_depth: dict[int, list[Joint]] = {}
        for joint in robot.joints:
            child, parent = self.link_index[joint.child], self.link_index[joint.parent]
            depth[joint.child] = depth[joint.parent] + 1
            at_depth.setdefault(depth[joint.child], []).append(joint)
            self._above[child] = self._above[parent]
            if joint.name in column:
                self._above[child, column[joint.name]] = True
        self._levels = []
        for level in at_depth.values():
            links, parents = ([self.link_index[getattr(joint, end)] for joint in level] for end in ("child", "parent"))
            moved = [i for i, joint in enumerate(level) if joint.name in column]
            columns = [column[level[i].name] for i in moved]
            self._levels.append((links, parents, np.array([joint.X_PC.matrix for joint in level]), moved, columns))

    def _lay_out_mimics(self, robot: Robot) -> None:
        column = {name: i for i, name in enumerate(self.independent)}
        self.B = np.zeros((len(self.joints), len(self.independent)))
        self.c = np.zeros(len(self.joints))
        for row, name in enumerate(self.joints):
            leader, multiplier, offset = mimic_relation(robot, name)
            self.B[row, column[leader]], self.c[row] = multiplier, offset

    def between(self, a: int, b: int) -> NDArray[np.bool_]:
        """Whether each joint (n,) moves one of two links, given by index, relative to the other."""
        return np.asarray(self._above[a] != self._above[b])

    def above(self, link: int) -> NDArray[np.intp]:
        """Indices of the joints that move a link, given by index."""
        return np.flatnonzero(self._above[link])

    def related(self, coordinate: int) -> NDArray[np.intp]:
        """Indices of the independent joints that move a link which the given one moves: above it, itself, below it."""
        return np.flatnonzero(self._moved[self._moved[:, coordinate]].any(axis=0))

    def moved_by(self, coordinate: int) -> list[str]:
        """Names of the links that an independent joint moves."""
        return [self.links[i] for i in np.flatnonzero(self._moved[:, coordinate])]

    def depths(self) -> NDArray[np.intp]:
        """The largest number of independent joints above a link that each of them moves."""
        return np.array([int(self._moved[links].sum(axis=1).min()) - 1 for links in self._moved.T], dtype=np.intp)

    @cached_property
    def _moved(self) -> NDArray[np.bool_]:
        """Whether each link (links, k) is moved by each independent joint."""
        return np.asarray(self._above @ (self.B != 0.0))

    def _axes(self, X: Array) -> tuple[Array, Array]:
        """Directions of the joints' axes, and their origins [m], (..., n, 3) in the world."""
        frames = X[..., self._child, :, :]
        return np.einsum("...nij,nj->...ni", frames[..., :3, :3], self._axis), frames[..., :3, 3]

    def twists(self, X: Array, along: Array) -> tuple[Array, Array]:
        """Velocities of all links, per unit speed along a direction of the joints.

        Args:
            X: Homogeneous X_WL [m] of all links, shape (..., links, 4, 4).
            along: Speeds of the joints, shape (..., n).

        Returns:
            Angular velocities [rad/s], and velocities [m/s] of the point of each link that is at the world's origin,
                both of shape (..., links, 3).
        """
        a_W, p_WC = self._axes(X)
        turned, slid = self._turn[:, None] * a_W, self._advance[:, None] * a_W
        speeds = along[..., None, :] * self._above
        return speeds @ turned, speeds @ (slid + cross(p_WC, turned))

    def follow(self, u: Array) -> Array:
        """Vector q (..., n) [rad] or [m] of all moving joints from u (..., k) of the independent ones."""
        return np.asarray(u @ self.B.T + self.c)

    def vector(self, q: Configuration) -> Array:
        """Vector u (k,) [rad] or [m] of a configuration by name; missing coordinates are 0."""
        return np.array([float(q.get(name, 0.0)) for name in self.independent])

    def named(self, u: Array) -> dict[str, float]:
        """Positions of all moving joints by name."""
        return dict(zip(self.joints, self.follow(u).tolist(), strict=True))

    def frames(self, q: Array) -> Array:
        """Homogeneous X_WL [m] of all links, shape (..., links, 4, 4), at q (..., n)."""
        motion = np.tile(np.eye(4), (*q.shape, 1, 1))
        angle = (self._turn * q)[..., None, None]
        # Rodrigues; 1 - cos as 2 sin^2 of half the angle keeps its digits at small angles.
        motion[..., :3, :3] += np.sin(angle) * self._K + 2.0 * np.sin(0.5 * angle) ** 2 * self._KK
        motion[..., :3, 3] = self._axis * (self._advance * q)[..., None]
        X = np.empty((*q.shape[:-1], len(self.links), 4, 4))
        X[..., 0, :, :] = np.eye(4)
        for links, parents, X_PC, moved, columns in self._levels:
            X_WC = matrix_product(X[..., parents, :, :], X_PC)
            X_WC[..., moved, :, :] = matrix_product(X_WC[..., moved, :, :], motion[..., columns, :, :])
            X[..., links, :, :] = X_WC
        return X

    def jacobian(self, X: Array, link: int | Sequence[int], p_WQ: Array) -> Array:
        """Jacobian of a point Q of a link over all joints, mimics not resolved.

        Args:
            X: Homogeneous X_WL [m] of all links, shape (..., links, 4, 4).
            link: Index of the link, or those of several links (m,).
            p_WQ: The point [m] in the world, shape (..., 3), or that of each link, (..., m, 3).

        Returns:
            Shape (..., 6, n) or (..., m, 6, n): angular velocity [rad/s], then velocity of Q [m/s], in the world, per
                unit speed of a joint.
        """
        a_W, p_WC = self._axes(X)
        if not isinstance(link, int):
            a_W, p_WC = a_W[..., None, :, :], p_WC[..., None, :, :]
        arm = p_WQ[..., None, :] - p_WC
        swept = cross(a_W, arm)
        turn, slide = self._turn[:, None], self._advance[:, None]
        turned = np.broadcast_to(turn * a_W, swept.shape)
        rows = np.concatenate([turned, turn * swept + slide * a_W], axis=-1)
        return np.asarray(np.where(self._above[link][..., None], rows, 0.0).swapaxes(-1, -2))

    def bias(self, X: Array, v: Array, links: Sequence[int], p_WQ: Array) -> tuple[Array, Array]:
        """Accelerations of links at constant joint speeds: the time derivative of J, times v.

        Args:
            X: Homogeneous X_WL [m] of all links, shape (..., links, 4, 4).
            v: Speed of every joint (..., n).
            links: Indices of links (m,).
            p_WQ: A point Q (..., m, 3) [m] of each, in the world.

        Returns:
            Angular acceleration (..., m, 3) [rad/s^2] of the links, and acceleration (..., m, 3) [m/s^2] of the points.
        """
        a_W, p_WC = self._axes(X)
        twists = (self.jacobian(X, self._child.tolist(), p_WC) * v[..., None, None, :]).sum(axis=-1)
        a_W, p_WC, twists = (each[..., None, :, :] for each in (a_W, p_WC, twists))
        turned = cross(twists[..., :3], a_W)  # an axis moves with the link that it is fixed to
        v_Q = (self.jacobian(X, links, p_WQ)[..., 3:, :] * v[..., None, None, :]).sum(axis=-1)
        swept = cross(turned, p_WQ[..., None, :] - p_WC) + cross(a_W, v_Q[..., None, :] - twists[..., 3:])
        rows = self._turn[:, None] * swept + self._advance[:, None] * turned
        speeds = np.where(self._above[links], v[..., None, :], 0.0)
        turning = ((self._turn * speeds)[..., None] * turned).sum(axis=-2)
        return np.asarray(turning), np.asarray((speeds[..., None] * rows).sum(axis=-2))


def advance(joint: Joint) -> float:
    """Translation [m] of a joint of one degree of freedom along its axis per unit of its coordinate."""
    return {JointKind.PRISMATIC: 1.0, JointKind.SCREW: joint.pitch}.get(joint.kind, 0.0)


def displacement(joint: Joint, q: float) -> Pose:
    """Pose [m] of the child link at ``q`` [rad] or [m] in its frame at q = 0, for at most one degree of freedom."""
    if joint.kind not in MOVING:
        return Pose()
    turned = 0.0 if joint.kind is JointKind.PRISMATIC else q
    return Pose.of(rotation_about(joint.axis, turned), np.array(joint.axis) * (advance(joint) * q))


def link_poses(robot: Robot, q: Configuration, tree: Tree | None = None) -> dict[str, Pose]:
    """X_WL of every link at one configuration; see :func:`link_poses_at`."""
    return link_poses_at(robot, [q], tree)[0]


def link_poses_at(robot: Robot, qs: Sequence[Configuration], tree: Tree | None = None) -> list[dict[str, Pose]]:
    """X_WL of every link, in tree order, at each configuration, which is completed first.

    Args:
        qs: Positions [rad] or [m].
        tree: The robot's tree, if already computed.

    Raises:
        KeyError: A configuration contains a name that is not a moving joint.
    """
    tree = tree or Tree(robot)
    rows = [[q[name] for name in tree.joints] for q in (complete(robot, q) for q in qs)]
    X = tree.frames(np.array(rows).reshape(len(rows), len(tree.joints)))
    names = [link.name for link in robot.links]
    placed = X[:, [tree.link_index[name] for name in names], :3]
    return [dict(zip(names, map(Pose.from_matrix, at), strict=True)) for at in placed]


def sampling_range(joint: Joint) -> tuple[float, float]:
    """Finite bounds [rad] or [m] to sample a joint in: its limits, truncated if they are infinite."""
    widest = WIDEST_TRAVEL if joint.kind is JointKind.PRISMATIC else WIDEST_ANGLE
    lower, upper = joint.limit.lower, joint.limit.upper
    open_below, open_above = lower < -NO_BOUND, upper > NO_BOUND
    if open_below and open_above:
        return -widest, widest
    if open_below:
        return min(-widest, upper - widest), upper
    if open_above:
        return lower, max(widest, lower + widest)
    return lower, upper


def leader_ranges(robot: Robot, names: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Bounds [rad] or [m] of independent joints that also keep their mimics within their limits, by name.

    If no position satisfies all of them, the joint's own bounds.
    """
    robot = unfolded(robot)
    own = {name: sampling_range(robot.joint_by_name[name]) for name in names}
    kept = dict(own)
    for follower in moving_joints(robot):
        if follower.mimic is None:
            continue
        leader, multiplier, offset = mimic_relation(robot, follower.name)
        if leader in own and multiplier != 0.0:
            ends = sorted((end - offset) / multiplier for end in (follower.limit.lower, follower.limit.upper))
            kept[leader] = max(kept[leader][0], ends[0]), min(kept[leader][1], ends[1])
    return {name: kept[name] if kept[name][0] <= kept[name][1] else own[name] for name in own}


def configurations(robot: Robot, n: int = 32, seed: int = 1) -> tuple[dict[str, float], ...]:
    """``n`` configurations [rad] or [m] within all limits, uniform and independent; loops stay open.

    The random numbers are from numpy's PCG64 with the given seed, the same on every machine.
    """
    robot = unfolded(robot)
    random = np.random.Generator(np.random.PCG64(seed))
    ranges = leader_ranges(robot, [joint.name for joint in independent_joints(robot)])
    drawn = []
    for _ in range(n):
        shares = random.random(len(ranges)).tolist()
        q = {
            name: low + share * (high - low) for share, (name, (low, high)) in zip(shares, ranges.items(), strict=True)
        }
        drawn.append(complete(robot, q))
    return tuple(drawn)


def rates(robot: Robot, n: int = 32, seed: int = 1) -> tuple[tuple[dict[str, float], dict[str, float]], ...]:
    """``n`` velocities [rad/s], [m/s] and accelerations [rad/s^2], [m/s^2] of all moving joints, in [-1, 1].

    Mimics are coordinates like any other here. Random numbers as for :func:`configurations`.
    """
    random = np.random.Generator(np.random.PCG64(seed + 1))
    names = [joint.name for joint in moving_joints(robot)]
    drawn = [(2.0 * random.random((2, len(names))) - 1.0).tolist() for _ in range(n)]
    return tuple((dict(zip(names, v, strict=True)), dict(zip(names, a, strict=True))) for v, a in drawn)


def within_limits(robot: Robot, q: Configuration) -> bool:
    """Whether every moving joint of a complete configuration is within its limits, but for rounding."""
    return all(
        joint.limit.lower - _SLACK <= q[joint.name] <= joint.limit.upper + _SLACK for joint in moving_joints(robot)
    )


def rigid_bodies(root: str, joints: Iterable[Joint]) -> dict[str, str]:
    """For each link the link nearest to the root that fixed joints connect it to, in the order of the links.

    Args:
        joints: Parents before their children.
    """
    body = {root: root}
    for joint in joints:
        body[joint.child] = body[joint.parent] if joint.kind is JointKind.FIXED else joint.child
    return body


def neighbours(robot: Robot) -> frozenset[frozenset[str]]:
    """Pairs of links connected by a joint or a closure, where links fixed to each other count as one.

    A floating joint connects nothing: what is free lies on, falls on or hits what is beside it.
    """
    rigid = rigid_bodies(robot.root.name, robot.joints)
    held = [(joint.parent, joint.child) for joint in robot.joints if joint.kind is not JointKind.FLOATING]
    held += [(closure.link_a, closure.link_b) for closure in robot.closures]
    bodies = {frozenset((rigid[a], rigid[b])) for a, b in held}
    return frozenset(
        frozenset((a, b))
        for a, b in combinations(rigid, 2)
        if frozenset((rigid[a], rigid[b])) in bodies or rigid[a] == rigid[b]
    )


def without_contacts(robot: Robot) -> frozenset[frozenset[str]]:
    """Pairs of links whose contacts the written files exclude.

    Adjacent ones, those that the source excludes, and those that :attr:`.Robot.self_collision` excludes.
    """
    search = robot.self_collision
    stated = frozenset(frozenset(pair) for pair in robot.excluded_contacts)
    return neighbours(robot) | stated | (search.excluded if search is not None else frozenset())
