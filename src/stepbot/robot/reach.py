"""How far a point of a robot gets from another one, over the limits of its joints."""

from math import atan2, pi

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY

from .kinematics import Tree, complete, initial_configuration, leader_ranges, link_poses
from .model import JointKind, Robot
from .multi_dof import unfolded

_STARTS = 8
_ROUNDS = 60
_SEED = 1
_GRID = 181
"""Positions of a joint that others follow, whose distance is no plain sine."""
_SAME = 1e-9
"""Improvement [m] below which the search ends."""


def reach(robot: Robot, to: str, start: str) -> float:
    """The largest distance [m] between the origins of two links or frames, within all limits; closures are ignored.

    One joint after the other is moved to where the distance is largest, from many poses: along a turning joint the
    squared distance is a sine, whose maximum is known, and along a sliding one a parabola, largest at an end.

    Args:
        to: Name of a link or a frame.
        start: Likewise.
    """
    robot = unfolded(replace(robot, closures=()))
    places = {link.name: (link.name, IDENTITY) for link in robot.links}
    places |= {frame.name: (frame.link, frame.X_LF) for frame in robot.frames if frame.name not in places}
    ends = places[to], places[start]
    led = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    robot = _between(robot, {link for link, _ in ends})
    tree = Tree(robot)
    free = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED and joint.mimic is None]
    ranges = leader_ranges(robot, [joint.name for joint in free])
    slides = {joint.name for joint in free if joint.kind is JointKind.PRISMATIC}

    def squared(q: dict[str, float]) -> float:
        X = link_poses(robot, complete(robot, q), tree)
        a, b = ((X[link] @ X_LF).p for link, X_LF in ends)
        return float(np.dot(a - b, a - b))

    def best_of(q: dict[str, float], name: str) -> float:
        low, high = ranges[name]
        candidates = [low, high, q[name]]
        if name in led:
            candidates += np.linspace(low, high, _GRID).tolist()
        elif name not in slides:
            at = {angle: squared({**q, name: angle}) for angle in (0.0, pi / 2, pi)}
            top = atan2(at[pi / 2] - (at[0.0] + at[pi]) / 2, (at[0.0] - at[pi]) / 2)
            candidates += [turn for k in (-1, 0, 1) if low <= (turn := top + 2 * pi * k) <= high]
        return max(candidates, key=lambda value: squared({**q, name: value}))

    generator, farthest = np.random.default_rng(_SEED), 0.0
    drawn = initial_configuration(robot)
    home = {name: min(max(drawn.get(name, 0.0), low), high) for name, (low, high) in ranges.items()}
    for number in range(_STARTS):
        q = home if not number else {name: float(generator.uniform(*bounds)) for name, bounds in ranges.items()}
        far = squared(q)
        for _ in range(_ROUNDS):
            for name in ranges:
                q = {**q, name: best_of(q, name)}
            now = squared(q)
            if now <= far + _SAME:
                break
            far = now
        farthest = max(farthest, far)
    return float(farthest**0.5)


def _between(robot: Robot, ends: set[str]) -> Robot:
    """The links from the root to the ends, and those of the joints that others of them follow."""
    above = {joint.child: joint for joint in robot.joints}
    wanted, kept = list(ends), {robot.root.name}
    while wanted:
        link = wanted.pop()
        if link not in kept:
            kept.add(link)
            joint = above[link]
            wanted.append(joint.parent)
            if joint.mimic is not None:
                wanted.append(robot.joint_by_name[joint.mimic.joint].child)
    links = tuple(link for link in robot.links if link.name in kept)
    return replace(robot, links=links, joints=tuple(one for one in robot.joints if one.child in kept), frames=())
