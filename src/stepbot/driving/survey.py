"""Poses for the tests, chosen where MuJoCo finds no contact; runs in a worker process.

Poses are random within the limits (PCG64, fixed seed) and close the loops. One survey serves all engines, so that they
do the same motions.
"""

from collections.abc import Iterator, Mapping
from functools import partial
from math import inf, isfinite, pi

import numpy as np
from msgspec import Struct

from stepbot.engines.mujoco.simulation import MujocoSimulation
from stepbot.engines.simulation import Cube, Mechanism, Motor, Setup
from stepbot.robot.model import ActuatorKind, Joint
from stepbot.robot.posing import NotReached, posed

from .grasping import Grasp, find_grasp
from .jaws import find_jaw_grasp
from .mechanism import Fingers

SEED = 20261122
"""Seed of all random numbers of drive tests; arbitrary but constant."""
POSES = 4
"""Number of random poses to hold."""
TRIES = 80
"""Maximum number of random poses that are tried."""
STEP_ANGLE = 0.5
"""Step [rad] of a turning joint; at most a quarter of its range."""
STEP_SHARE = 0.25
"""Step of a sliding joint, and largest one of a turning joint, relative to its range."""
_MARGIN = 0.05
"""Share of a range at each end that random poses avoid."""
_CLEAR = 1e-4
"""Depth [m] by which a contact may be deeper than in the home pose."""
_ON_THE_WAY = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0)
"""Parts of a step, or of a sweep in a robot with loops, at which nothing may be in the way."""
_SAME = 1e-6
"""Difference [rad] or [m] of positions that are the same."""
_NEAR_LIMIT = 0.01
"""Distance from a limit, relative to the range, from which a joint is at it: paths of closed loops take steps."""
_STRIDES = 48
"""Number of positions tried along a joint's range."""

Q = Mapping[str, float]


class Move(Struct, frozen=True):
    """A motion of one motor, the others at home."""

    motor: str
    ends: tuple[float, ...]
    """Positions [rad] or [m] to visit in turn, from home."""


class SweptRange(Struct, frozen=True):
    """What part of the range of a bounded joint its sweep covers."""

    joint: str
    angular: bool
    swept: tuple[float, float]
    """Ends [rad] or [m] that are visited."""
    limits: tuple[float, float]
    """Ends [rad] or [m] of its range."""
    stops: tuple[str, str]
    """Why each end of the range is not visited; empty where it is."""

    @property
    def share(self) -> float:
        """Share of the range that is covered."""
        return (self.swept[1] - self.swept[0]) / (self.limits[1] - self.limits[0])


class Survey(Struct, frozen=True):
    """Poses and motions of all tests."""

    poses: tuple[Q, ...]
    """Configurations to hold."""
    steps: tuple[Move, ...]
    """Step of each position motor: one end."""
    sweeps: tuple[Move, ...]
    """Range of each position motor that is free of contact: lower end, upper end, home."""
    covered: float
    """Share of the ranges of all bounded joints that the sweeps cover, on average; 1 without bounded joints."""
    grasps: tuple[Grasp, ...]
    misses: Mapping[str, str]
    """Why no cube can be gripped, for the first motor of each pair of links that may be fingers, or of each jaw."""
    ranges: tuple[SweptRange, ...] = ()
    """What the sweep of each bounded joint covers."""
    overlaps: Mapping[tuple[str, str], float] = {}
    """How deep [m] links are in each other in the initial pose."""


def survey(
    file: str, mechanism: Mechanism, fingers: tuple[Fingers, ...], mass: float, objects: tuple[Cube, ...] = ()
) -> Survey:
    """Choose the poses.

    Args:
        file: The MJCF; empty for a robot without one, whose contacts are not known and that grips nothing.
        fingers: Links that may be fingers or jaws.
        mass: Mass [kg] of the cube to grip.
        objects: What pairs of fingers grip in its place.
    """
    place = _Place(file, mechanism)
    overlaps = place.overlaps()
    swept = tuple(place.sweep(motor) for motor in place.servos)
    sweeps = tuple(move for move, _ in swept)
    ranges = tuple(
        swept_range
        for motor, (move, stops) in zip(place.servos, swept, strict=True)
        for swept_range in _range(motor, move, stops)
    )
    shares = [one.share for one in ranges]
    tried: dict[tuple[Fingers, Cube | None], Grasp | str] = {}
    for pair in fingers if file else ():
        for given in objects if objects and not pair.fixed else (None,):
            find = find_jaw_grasp if pair.fixed else partial(find_grasp, given=given)
            tried[pair, given] = find(file, mechanism, pair, mass)
    return Survey(
        poses=tuple(place.poses()),
        steps=tuple(move for motor in place.servos for move in place.step(motor)),
        sweeps=sweeps,
        covered=float(np.mean(shares)) if shares else 1.0,
        grasps=tuple(grasp for grasp in tried.values() if not isinstance(grasp, str)),
        misses={
            f"{pair.motors[0]}, {given}" if given else pair.motors[0]: reason
            for (pair, given), reason in tried.items()
            if isinstance(reason, str)
        },
        ranges=ranges,
        overlaps=overlaps,
    )


def _range(motor: Motor, sweep: Move, stops: tuple[str, str]) -> Iterator[SweptRange]:
    limits = (motor.limit.lower, motor.limit.upper)
    if isfinite(limits[1] - limits[0]) and limits[1] > limits[0]:
        yield SweptRange(motor.joint, motor.angular, (sweep.ends[0], sweep.ends[1]), limits, stops)


class _Place:
    """The robot in the air, to look for contacts."""

    def __init__(self, file: str, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._simulation = MujocoSimulation(file, mechanism, Setup(held=True)) if file else None
        self.servos = [motor for motor in mechanism.motors if motor.kind is ActuatorKind.POSITION]
        self._allowed = inf
        self._allowed = self._depth(mechanism.home) + _CLEAR

    def overlaps(self) -> Mapping[tuple[str, str], float]:
        """The overlaps of links in the initial pose."""
        if self._simulation is None:
            return {}
        self._simulation.reset(self._mechanism.home)
        return self._simulation.overlaps(_CLEAR)

    def _depth(self, q: Q) -> float:
        if self._simulation is None:
            return 0.0
        self._simulation.reset(q)
        return self._simulation.penetration()

    def _reach(self, targets: Q) -> dict[str, float]:
        """The configuration with some joints at given positions, or as near as the loops allow."""
        robot = self._mechanism.robot
        try:
            return posed(robot, targets)
        except NotReached as error:
            home = self._mechanism.home
            try:
                return posed(robot, {name: home[name] + 0.9 * (q - home[name]) for name, q in error.reached.items()})
            except NotReached:
                return dict(home)

    def _range(self, motor: Motor) -> tuple[float, float]:
        home, half = self._mechanism.home[motor.joint], pi if motor.angular else 0.5
        lower, upper = motor.limit.lower, motor.limit.upper
        return (lower if isfinite(lower) else home - half), (upper if isfinite(upper) else home + half)

    def poses(self) -> Iterator[Q]:
        """Random poses without contact; the home pose if none is found."""
        random, count = np.random.Generator(np.random.PCG64(SEED)), 0
        for _ in range(TRIES if self.servos else 0):
            targets = {}
            for motor in self.servos:
                lower, upper = self._range(motor)
                targets[motor.joint] = lower + (_MARGIN + (1 - 2 * _MARGIN) * random.random()) * (upper - lower)
            q = self._reach(targets)
            if self._depth(q) <= self._allowed:
                yield q
                count += 1
            if count == POSES:
                return
        if not count:
            yield self._mechanism.home

    def step(self, motor: Motor) -> Iterator[Move]:
        """The step of a motor: to the side with more room, smaller ones if something is in the way; none if all are."""
        lower, upper = self._range(motor)
        home = self._mechanism.home[motor.joint]
        size = STEP_SHARE * (upper - lower)
        size = min(size, STEP_ANGLE) if motor.angular else size
        side = 1.0 if upper - home >= home - lower else -1.0
        for share in (1.0, -1.0, 0.5, -0.5, 0.25, -0.25):
            end = home + side * share * size
            if not lower <= end <= upper:
                continue
            way = [self._reach({motor.joint: home + part * (end - home)}) for part in _ON_THE_WAY]
            if abs(way[-1][motor.joint] - end) < 1e-6 and max(map(self._depth, way)) <= self._allowed:
                yield Move(motor.name, (end,))
                return

    def sweep(self, motor: Motor) -> tuple[Move, tuple[str, str]]:
        """The range of a motor around home, up to the first contact or the end of the loops, and why it ends there."""
        home = self._mechanism.home[motor.joint]
        (low, before), (high, after) = (self._free_end(motor, end) for end in self._range(motor))
        return Move(motor.name, (low, high, home)), (before, after)

    def _free_end(self, motor: Motor, end: float) -> tuple[float, str]:
        """The position to visit, and why it is not the end; empty if it is."""
        home = self._mechanism.home[motor.joint]
        if self._mechanism.robot.closures:
            q = self._reach({motor.joint: end})
            clear = self._clear(motor, q)
            if clear is not None:
                return clear, "a contact"
            return q[motor.joint], "" if abs(q[motor.joint] - end) < _SAME else self._stop(motor, end)
        free = home
        for share in np.linspace(0.0, 1.0, _STRIDES + 1)[1:].tolist():
            there = home + share * (end - home)
            if self._depth(posed(self._mechanism.robot, {motor.joint: there})) > self._allowed:
                return free, "a contact"
            free = there
        return free, ""

    def _clear(self, motor: Motor, end: Q) -> float | None:
        """The position before the first contact on the way to an end, in a robot with loops; None without a contact."""
        free = home = self._mechanism.home[motor.joint]
        for share in _ON_THE_WAY:
            there = home + share * (end[motor.joint] - home)
            q = end if share == 1.0 else self._reach({motor.joint: there})
            if self._depth(q) > self._allowed:
                return free
            free = q[motor.joint]
        return None

    def _stop(self, motor: Motor, end: float) -> str:
        """What ends the motion of a motor's joint towards an end: joints of its loops that are at their limits."""
        robot = self._mechanism.robot
        try:
            posed(robot, {motor.joint: end})
        except NotReached as error:
            try:
                q = posed(robot, error.reached)
            except NotReached:
                return "the loops"
            names = [joint.name for joint in robot.joints if joint.name != motor.joint and _at_limit(joint, q)]
            return f"the limit of {', '.join(names)}" if names else "the loops"
        return "the loops"


def _at_limit(joint: Joint, q: Q) -> bool:
    lower, upper = joint.limit.lower, joint.limit.upper
    near = _NEAR_LIMIT * (upper - lower)
    return joint.name in q and isfinite(near) and not lower + near < q[joint.name] < upper - near
