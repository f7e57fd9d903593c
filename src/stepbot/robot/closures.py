"""Loop closures: residuals, their Jacobian, Newton's method, and the range that the loops allow.

A closure constrains two frames up to the degrees of freedom of its kind. Its residual is expressed in the first frame,
F of link A; it vanishes when the closure is closed, and the rank of its Jacobian is the number of degrees of freedom
that it removes. Redundant rows, as in every planar mechanism, are harmless: steps are least-squares steps of least
length.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import atan2

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.spatial import DECIMALS, Array, Pose, cross, perpendicular_frame

from .kinematics import Configuration, Tree, initial_configuration, leader_ranges, within_limits
from .model import JointKind, LoopClosure, Robot
from .multi_dof import unfolded

CLOSED_DISTANCE = 1e-5
"""Maximum gap [m] between the frames of a closed closure in a small mechanism: the CAD's mates are accurate to 0.01 mm.
In a large one, the tolerance of the rank times the reach applies."""
CLOSED_ANGLE = 2e-3
"""Maximum angle [rad] between them: pins that should be parallel are parallel to 1 mrad."""
RANK_TOLERANCE, _RIGID = 1e-4, 1e-8
"""Share of the largest singular value, or of the second number, up to which one is 0: CAD is never quite parallel."""
LARGEST_STEP = 0.1
"""Maximum motion [rad], or share of a prismatic joint's range, of a driven joint between two closed configurations."""
SHORTEST_STEP = 1 / 64
"""Share of the largest step below which a path ends."""
LARGEST_JUMP = 0.7
"""Change [rad or m] of a following joint in one such step beyond which the mechanism has left its branch."""
WORST_CONDITION = 1e-3
"""Ratio of singular values below which the loops count as singular: the range ends before it."""
STEPS_AT_ONCE = 6
"""Steps of Newton's method for many configurations at once: next to a closed one, four are sufficient."""
CONVERGED = 1e-6
"""Length of a step of Newton's method for many configurations after which a configuration is final."""
RANDOM_WAYS = 6
"""Number of paths towards random targets for mechanisms with several degrees of freedom."""


class DoesNotClose(ValueError):
    """No configuration near the guess closes the loops.

    Attributes:
        closure: The closure with the largest gap.
        distance: Its gap [m].
        angle: Angle [rad] between its frames.
    """

    def __init__(self, closure: str, distance: float, angle: float) -> None:
        self.closure, self.distance, self.angle = closure, distance, angle
        super().__init__(f"closure '{closure}' stays open by {distance:.3g} m and {angle:.3g} rad")


def closure_gap(closure: LoopClosure, X_WA: Pose, X_WB: Pose) -> tuple[float, float]:
    """Gap of a closure: distance [m] and angle [rad] between the frames F on both links, given the links' poses."""
    X_FG = (X_WA @ closure.X_AF).inverse() @ (X_WB @ closure.X_BF)
    axis = np.array(closure.axis)
    distance = float(np.linalg.norm(X_FG.p))
    if closure.kind.is_hinge:
        turned = X_FG.turn(axis)
        return distance, atan2(float(np.linalg.norm(cross(axis, turned))), float(axis @ turned))
    if closure.kind is JointKind.PRISMATIC:
        distance = float(np.linalg.norm(X_FG.p - axis * (axis @ X_FG.p)))
    angle = 0.0 if closure.kind is JointKind.BALL else Pose().distance_to(X_FG)[1]
    return distance, angle


def constraint_rows(closure: LoopClosure, X_FG: Array, J_F: Array, J_G: Array) -> tuple[Array, Array]:
    """Residual (..., m) of a closure and its Jacobian (..., m, n) over all moving joints.

    Rows are the positions [m], then the orientations [rad], of G, the frame on link B, relative to F, the frame on link
    A, as far as the closure's kind constrains them.

    Args:
        X_FG: Homogeneous pose of G in F, shape (..., 4, 4).
        J_F: Jacobian of F, shape (..., 6, n), along the axes of F.
        J_G: Jacobian of G, shape (..., 6, n), along the axes of F.

    Raises:
        ValueError: There is no closure of this kind.
    """
    R, p = X_FG[..., :3, :3], X_FG[..., :3, 3]
    w_F, w_FG = J_F[..., :3, :], J_G[..., :3, :] - J_F[..., :3, :]
    # the frame F rotates under the lever arm from F to G
    v_FG = J_G[..., 3:, :] - J_F[..., 3:, :] + _crossed(p, w_F)
    across = perpendicular_frame(closure.axis)[:, :2].T
    twist = 0.5 * (R.swapaxes(-1, -2) - R)[..., [1, 2, 0], [2, 0, 1]]
    if closure.kind is JointKind.BALL:
        return p, v_FG
    if closure.kind.is_hinge:
        turned = R @ np.array(closure.axis)
        return _stacked(p, turned @ across.T), _stacked(v_FG, -across @ _crossed(turned, w_FG), axis=-2)
    if closure.kind is JointKind.PRISMATIC:
        return _stacked(p @ across.T, twist), _stacked(across @ v_FG, w_FG, axis=-2)
    if closure.kind is JointKind.FIXED:
        return _stacked(p, twist), _stacked(v_FG, w_FG, axis=-2)
    raise ValueError(f"closure '{closure.name}': no kinematics for {closure.kind} closures")


def _crossed(v: Array, J: Array) -> Array:
    """Cross products of vectors (..., 3) with the columns of J (..., 3, n)."""
    return cross(v[..., None, :], J.swapaxes(-1, -2)).swapaxes(-1, -2)


def _stacked(a: Array, b: Array, axis: int = -1) -> Array:
    return np.concatenate([a, b], axis=axis)


class Loops:
    """The closures of a robot over its tree: built once, evaluated at many configurations."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.tree = unfolded(robot), Tree(robot)
        index = self.tree.link_index
        self._pairs = [(index[closure.link_a], index[closure.link_b]) for closure in robot.closures]
        self._ends = [a for a, _ in self._pairs] + [b for _, b in self._pairs]
        poses = [c.X_AF.matrix for c in robot.closures] + [c.X_BF.matrix for c in robot.closures]
        self._X_LF = np.array(poses).reshape(-1, 4, 4)
        reach = max((float(np.linalg.norm(X.p)) for c in robot.closures for X in (c.X_AF, c.X_BF)), default=0.0)
        self.per_length = 1.0 / (reach or 1.0)
        """Unit of lengths in residuals [1/m]: the inverse of the mechanism's own reach."""
        self.closed_distance = max(CLOSED_DISTANCE, 2.0 * RANK_TOLERANCE * reach)
        self.closed_share = self.closed_distance * self.per_length
        """Norm of the residual of closed loops, in its unit."""

    @property
    def involved(self) -> list[str]:
        """The independent joints that move the two sides of a closure relative to each other; no other opens a loop."""
        moving = np.any([self.tree.between(a, b) for a, b in self._pairs], axis=0)
        return [name for name, column in zip(self.tree.independent, self.tree.B.T, strict=True) if column[moving].any()]

    def constraints(self, u: Array) -> tuple[Array, Array]:
        """Residual (..., m) of all closures and its Jacobian (..., m, k) over the independent joints u (..., k).

        Mimics are resolved. Lengths are in units of the mechanism's own reach, to weigh them equally with angles.
        """
        X = self.tree.frames(self.tree.follow(u))
        many, count = u.shape[:-1], len(self.robot.closures)
        residuals, jacobians = [np.zeros((*many, 0))], [np.zeros((*many, 0, len(self.tree.joints)))]
        X_WE = X[..., self._ends, :, :] @ self._X_LF
        X_WF, X_WG = X_WE[..., :count, :, :], X_WE[..., count:, :, :]
        R_FW = X_WF[..., :3, :3].swapaxes(-1, -2)
        X_FG = np.zeros((*many, count, 4, 4))
        X_FG[..., :3, :3] = R_FW @ X_WG[..., :3, :3]
        X_FG[..., :3, 3:] = R_FW @ (X_WG - X_WF)[..., :3, 3:] * self.per_length
        turn = np.zeros((*many, count, 6, 6))
        turn[..., :3, :3], turn[..., 3:, 3:] = R_FW, R_FW * self.per_length
        J = self.tree.jacobian(X, self._ends, X_WE[..., :3, 3])
        J_F, J_G = turn @ J[..., :count, :, :], turn @ J[..., count:, :, :]
        for i, closure in enumerate(self.robot.closures):
            residual, rows = constraint_rows(closure, X_FG[..., i, :, :], J_F[..., i, :, :], J_G[..., i, :, :])
            residuals.append(residual)
            jacobians.append(rows)
        return np.concatenate(residuals, axis=-1), np.concatenate(jacobians, axis=-2) @ self.tree.B

    def gaps(self, u: Array) -> dict[str, tuple[float, float]]:
        """:func:`closure_gap` of every closure."""
        X = self.tree.frames(self.tree.follow(u))
        return {
            closure.name: closure_gap(closure, Pose.from_matrix(X[a]), Pose.from_matrix(X[b]))
            for closure, (a, b) in zip(self.robot.closures, self._pairs, strict=True)
        }

    def closed(self, guess: Array, free: Sequence[int]) -> tuple[Array, Array]:
        """:func:`close_loops` over the independent joints (k,); those with indices in ``free`` move.

        Returns:
            The closed configuration (k,) and the Jacobian (m, k) there.

        Raises:
            DoesNotClose: The residual does not fall below the tolerance.
        """
        u = guess.copy()
        residual, J = self.constraints(u)
        for _ in range(50 if free else 0):
            step = np.array(-np.linalg.lstsq(J[:, free], residual, rcond=RANK_TOLERANCE)[0], dtype=np.float64)
            length = float(np.abs(step).max(initial=0.0))
            if length < 1e-14:
                break
            moved = self._stepped(u, free, np.array(step * min(1.0, 0.5 / length)), residual)
            if moved is None:
                break
            u, residual, J = moved
        for name, (distance, angle) in sorted(self.gaps(u).items(), key=lambda gap: gap[1], reverse=True):
            if not (distance <= self.closed_distance and angle <= CLOSED_ANGLE):
                raise DoesNotClose(name, distance, angle)
        u[list(free)] = np.round(u[list(free)], DECIMALS) + 0.0
        return u, J

    def closed_many(self, guess: Array, free: Sequence[int]) -> tuple[Array, Array, Array]:
        """Newton's method for many guesses (n, k) at once; joints with indices in ``free`` move.

        Returns:
            The last step (n, k), whether or not it is closed, and :meth:`constraints` there.
        """
        u = guess.copy()
        residual, J = self.constraints(u)
        moving, following = np.arange(len(u) if free else 0), np.array(free, dtype=np.int64)
        for _ in range(STEPS_AT_ONCE):
            inverse = np.linalg.pinv(J[moving][..., following], rcond=RANK_TOLERANCE)
            step = -(inverse @ residual[moving, :, None])[..., 0]
            length = np.abs(step).max(axis=-1, initial=0.0)
            u[np.ix_(moving, following)] += step * (0.5 / np.maximum(length, 0.5))[:, None]
            residual[moving], J[moving] = self.constraints(u[moving])
            moving = moving[length > CONVERGED]  # the error after a step is about the square of its length
            if not len(moving):
                break
        return u, residual, J

    def singular_many(self, J: Array, free: Sequence[int]) -> NDArray[np.bool_]:
        """Whether the joints with indices in ``free`` are near a singularity of the loops, by Jacobians (n, m, k)."""
        if not free:
            return np.zeros(len(J), dtype=bool)
        sizes = np.linalg.svd(J[..., free], compute_uv=False)
        if sizes.shape[-1] < len(free):
            return np.ones(len(J), dtype=bool)
        return np.asarray(sizes[:, -1] < WORST_CONDITION * sizes[:, 0])

    def _stepped(
        self, u: Array, free: Sequence[int], step: Array, residual: Array
    ) -> tuple[Array, Array, Array] | None:
        """The configuration after the longest halving of ``step`` that reduces the residual; None if none does."""
        for halving in range(8):
            moved = u.copy()
            moved[list(free)] += step * 0.5**halving
            new_residual, J = self.constraints(moved)
            if np.linalg.norm(new_residual) < np.linalg.norm(residual):
                return moved, new_residual, J
        return None


def rank(J: Array, least: float | None = None) -> int:
    """Numerical rank of a Jacobian; with ``least``, the number of singular values above it."""
    sizes = np.linalg.svd(J, compute_uv=False) if J.size else np.zeros(0)
    return int(np.count_nonzero(sizes > (RANK_TOLERANCE * sizes.max(initial=_RIGID) if least is None else least)))


def independent_columns(J: Array, order: Iterable[int]) -> list[int]:
    """Columns of a Jacobian, each if it adds to the rank: joints that can follow, unless they hardly move the loop."""
    chosen: list[int] = []
    least = RANK_TOLERANCE * max(float(np.linalg.norm(J, 2)), _RIGID) if J.size else 0.0
    for column in order:
        if rank(J[:, [*chosen, column]], least) > len(chosen):
            chosen.append(column)
    return chosen


def degrees_of_freedom(robot: Robot) -> int:
    """Number of joints that can be moved independently in the drawn pose, with loops and mimics."""
    loops = Loops(robot)
    return len(loops.tree.independent) - rank(loops.constraints(loops.tree.vector(initial_configuration(robot)))[1])


def held_by_a_point(robot: Robot) -> tuple[str, ...]:
    """Revolute closures for which constraining one point of the axis is sufficient, as in planar mechanisms."""
    freedom = degrees_of_freedom(robot)
    enough: list[str] = []
    for closure in robot.closures:
        if not closure.kind.is_hinge:
            continue
        as_points = {*enough, closure.name}
        closures = tuple(replace(c, kind=JointKind.BALL) if c.name in as_points else c for c in robot.closures)
        if degrees_of_freedom(replace(robot, closures=closures)) == freedom:
            enough.append(closure.name)
    return tuple(enough)


def driven_joints(robot: Robot) -> tuple[str, ...]:
    """As many independent joints as there are degrees of freedom: actuated ones first, then those nearest the root.

    The others follow from them through the closures.
    """
    loops = Loops(robot)
    _, J = loops.constraints(loops.tree.vector(initial_configuration(robot)))
    tree, names = loops.tree, loops.tree.independent
    links = (tree.link_index[loops.robot.joint_by_name[name].child] for name in names)
    above = [np.count_nonzero(tree.between(0, link)) for link in links]
    actuated = {actuator.joint for actuator in robot.actuators}
    # Try the least preferred joints as followers first; a joint that adds no rank cannot follow, so it drives.
    followers = independent_columns(J, sorted(range(len(names)), key=lambda i: (names[i] in actuated, -above[i], -i)))
    return tuple(name for i, name in enumerate(names) if i not in followers)


def close_loops(robot: Robot, guess: Configuration, driven: Sequence[str]) -> dict[str, float]:
    """The closed configuration nearest to ``guess``, with the driven joints at their values in the guess.

    Newton's method until it converges, with steps halved if they increase the residual.

    Raises:
        DoesNotClose: The residual does not fall below the tolerance.
    """
    loops = Loops(robot)
    free = following(loops.tree, driven)
    return loops.tree.named(loops.closed(loops.tree.vector(guess), free)[0])


def loop_ways(robot: Robot, n: int = 24, seed: int = 1) -> tuple[tuple[dict[str, float], ...], ...]:
    """About ``n`` closed configurations over the range that loops and limits allow, as paths from the drawn pose.

    The driven joints of the loops follow straight paths: to both ends of each one's range, and, if there are several,
    towards random targets (PCG64, ``seed``). A path ends when a joint reaches its limit or the loops become singular.
    Joints outside the loops do not move. Empty for a robot without closures.

    Returns:
        Paths, each starting with the drawn pose.

    Raises:
        DoesNotClose: The drawn pose is not closed.
    """
    if not robot.closures:
        return ()
    loops = Loops(robot)
    driven = driven_joints(robot)
    free = following(loops.tree, driven)
    start, J = loops.closed(loops.tree.vector(initial_configuration(robot)), free)
    # Joints below which both sides of every loop are, such as those of an arm below a hand, have rounding errors alone.
    moved = np.abs(J).max(axis=0) > RANK_TOLERANCE
    in_loops = [name for i, name in enumerate(loops.tree.independent) if name in driven and moved[i]]
    walked = [walk(loops, start, free, target) for target in _targets(robot, in_loops, seed)]
    walked = [way for way in walked if way]
    total = sum(len(way) for way in walked)
    ways = []
    for way in walked:
        share = min(len(way), max(1, round((n - 1) * len(way) / total)))
        chosen = [start, *(way[(i + 1) * len(way) // share - 1] for i in range(share))]
        ways.append(tuple(loops.tree.named(u) for u in chosen))
    return tuple(ways) or ((loops.tree.named(start),),)


def following(tree: Tree, driven: Sequence[str]) -> list[int]:
    """Indices of the independent joints that are not driven."""
    return [i for i, name in enumerate(tree.independent) if name not in driven]


def _targets(robot: Robot, driven: Sequence[str], seed: int) -> list[dict[str, float]]:
    """Targets of the driven joints of the loops."""
    ranges = leader_ranges(robot, driven)
    targets = [{name: end} for name in driven for end in ranges[name]]
    if len(driven) > 1:
        random = np.random.Generator(np.random.PCG64(seed))
        for shares in random.random((RANDOM_WAYS, len(driven))).tolist():
            ends = zip(shares, ranges.items(), strict=True)
            targets.append({name: low + share * (high - low) for share, (name, (low, high)) in ends})
    return targets


def walk(loops: Loops, start: Array, free: Sequence[int], target: Mapping[str, float]) -> list[Array]:
    """Closed configurations (k,) on the driven joints' straight path from ``start`` to ``target``, as far as possible.

    If a step fails, a shorter one is tried, so that the path ends close to the end of the range.
    """
    index = {name: loops.tree.independent.index(name) for name in target}
    goal = start.copy()
    for name, end in target.items():
        goal[index[name]] = end
    driven = [i for i in range(len(start)) if i not in free]
    strides = max(abs(goal[i] - start[i]) / _stride(loops.robot, name) for name, i in index.items())
    if strides == 0.0:
        return []
    longest = min(1.0, 1.0 / strides)
    way, gone, step = [start], [0.0], longest
    while gone[-1] < 1.0 and step > longest * SHORTEST_STEP:
        share = min(1.0, gone[-1] + step)
        guess = way[-1].copy()
        if len(way) > 1:  # continue as before
            guess += (way[-1] - way[-2]) * (share - gone[-1]) / (gone[-1] - gone[-2])
        guess[driven] = start[driven] + share * (goal[driven] - start[driven])
        closed = _next(loops, guess, way[-1], free)
        if closed is None:
            step *= 0.5
            continue
        way.append(closed)
        gone.append(share)
    return way[1:]


def _next(loops: Loops, guess: Array, former: Array, free: Sequence[int]) -> Array | None:
    """The closed configuration at a guess; None if there is none on the same branch."""
    try:
        closed, J = loops.closed(guess, free)
    except DoesNotClose:
        return None
    jumped = float(np.abs(closed - former)[list(free)].max(initial=0.0)) > LARGEST_JUMP
    if jumped or not within_limits(loops.robot, loops.tree.named(closed)) or loops.singular_many(J[None], free)[0]:
        return None
    return closed


def _stride(robot: Robot, name: str) -> float:
    """Maximum motion [rad] or [m] of a driven joint between two closed configurations."""
    if robot.joint_by_name[name].kind is not JointKind.PRISMATIC:
        return LARGEST_STEP
    low, high = leader_ranges(robot, [name])[name]
    return LARGEST_STEP * max(high - low, 1e-9)
