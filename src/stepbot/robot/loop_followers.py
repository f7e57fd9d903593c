"""Joints of loops that follow one driven joint along a straight line: what a format without loops can show by mimics.

In a parallelogram, as in most two-finger grippers, the passive joints turn by the same angle as the driven one.
"""

from collections.abc import Mapping, Sequence
from math import inf
from weakref import WeakKeyDictionary

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array

from .closures import DoesNotClose, Loops, driven_joints, following, loop_ways, walk
from .kinematics import Configuration, initial_configuration, leader_ranges
from .model import JointKind, Mimic, Robot

ANGLE, TRAVEL = 1e-3, 1e-4
"""Maximum deviation [rad] and [m] of a follower from its line over the range that the loops allow."""
_STILL = 1e-6
"""Motion [rad] or [m] below which a joint does not depend on a driven one."""
_NEAR = 0.2
"""Motion [rad] or [m] of a driven joint that is tested first."""
_DIGITS = 9
"""Decimals of multipliers and offsets: those of the solved loops are noise beyond."""


class Follower(Struct, frozen=True):
    """A passive joint of a loop, as a mimic of a driven joint."""

    joint: str
    mimic: Mimic
    """The line through the drawn pose that is closest to the joint's positions."""
    deviation: float
    """Maximum deviation [rad] or [m] from the line over the range that the loops allow."""


_KNOWN: WeakKeyDictionary[Robot, tuple[Follower, ...]] = WeakKeyDictionary()
"""The followers of the robots in use: the report and each format without loops need them."""


def loop_followers(robot: Robot) -> tuple[Follower, ...]:
    """The passive joints that follow one driven joint along a line, in the robot's order.

    The driven joints move one after the other over their whole range, as far as loops and limits allow; with several of
    them, lines are also tested on paths towards random targets.
    """
    if not robot.closures:
        return ()
    if robot not in _KNOWN:
        try:
            _KNOWN[robot] = tuple(_followers(robot))
        except DoesNotClose:  # reported where the loops are verified
            _KNOWN[robot] = ()
    return _KNOWN[robot]


def _followers(robot: Robot) -> list[Follower]:
    loops, driven = Loops(robot), driven_joints(robot)
    names, leading = loops.tree.independent, [name for name in loops.involved if name in driven]
    free = following(loops.tree, driven)
    start, _ = loops.closed(loops.tree.vector(initial_configuration(robot)), free)
    actuated = {actuator.joint for actuator in robot.actuators}
    passive = [i for i in free if names[i] in robot.joint_by_name and names[i] not in actuated]
    followers: list[Follower] = []
    for near in (True, False):  # most mechanisms are not linear, which shows near the drawn pose already
        if passive:
            paths = {name: _path(robot, loops, start, free, name, near=near) for name in leading}
            followers = [line for i in passive if (line := _line(robot, names, paths, i)) is not None]
            passive = [names.index(line.joint) for line in followers]
    if followers and len(driven) > 1:
        ways = loop_ways(robot)
        followers = [follower for follower in followers if _holds_everywhere(robot, follower, ways)]
    order = [joint.name for joint in robot.joints]
    return sorted(followers, key=lambda follower: order.index(follower.joint))


def _path(robot: Robot, loops: Loops, start: Array, free: list[int], name: str, *, near: bool) -> Array:
    """Closed configurations (n, k) from the drawn pose, the first one, to both ends of a driven joint's range."""
    ends = list(leader_ranges(robot, [name])[name])
    if near:
        here = float(start[loops.tree.independent.index(name)])
        ends = [here + max(-_NEAR, min(_NEAR, end - here)) for end in ends]
    ways = [walk(loops, start, free, {name: end}) for end in ends]
    return np.array([start, *(u for way in ways for u in way)])


def _line(robot: Robot, names: tuple[str, ...], paths: Mapping[str, Array], i: int) -> Follower | None:
    """The line of a joint through the drawn pose; None if it follows no or several joints, or not along a line."""
    leaders = [name for name, path in paths.items() if np.ptp(path[:, i]) > _STILL]
    if len(leaders) != 1:
        return None
    (leader,) = leaders
    x, y = paths[leader][:, names.index(leader)], paths[leader][:, i]
    dx, dy = x - x[0], y - y[0]
    multiplier = round(float(dx @ dy / (dx @ dx)), _DIGITS)
    offset = round(float(y[0] - multiplier * x[0]), _DIGITS) + 0.0
    deviation = float(np.abs(multiplier * x + offset - y).max())
    follower = Follower(names[i], Mimic(leader, multiplier, offset), deviation)
    return follower if deviation <= _limit(robot, names[i]) else None


def _limit(robot: Robot, name: str) -> float:
    return TRAVEL if robot.joint_by_name[name].kind is JointKind.PRISMATIC else ANGLE


def _holds_everywhere(robot: Robot, follower: Follower, ways: Sequence[Sequence[Configuration]]) -> bool:
    """Whether a line also holds while the other driven joints move."""
    mimic, limit = follower.mimic, _limit(robot, follower.joint)
    return all(
        abs(mimic.multiplier * q[mimic.joint] + mimic.offset - q[follower.joint]) <= limit for way in ways for q in way
    )


def loop_sensitivity(robot: Robot, configurations: Sequence[Configuration], driven: Sequence[str]) -> float:
    """Largest motion [rad/m], [m/m] of the following joints per gap of the loops.

    It is the inverse of the least singular value of the Jacobian of the closures: next to a dead centre, a small gap
    leaves room for a large motion.

    Args:
        configurations: Closed configurations.
        driven: The joints that do not move with the gaps.
    """
    if not (configurations and robot.closures):
        return 0.0
    loops = Loops(robot)
    free = following(loops.tree, driven)
    if not free:
        return 0.0
    _, J = loops.constraints(np.array([loops.tree.vector(q) for q in configurations]))
    sizes = np.linalg.svd(J[..., free], compute_uv=False)
    least = float(sizes[:, -1].min()) if sizes.shape[-1] == len(free) else 0.0
    return loops.per_length / least if least > 0.0 else inf
