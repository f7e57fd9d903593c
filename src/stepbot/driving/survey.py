"""Poses for the tests, chosen where MuJoCo finds no contact; runs in a worker process.

Poses are random within the limits (PCG64, fixed seed) and close the loops. One survey serves all engines, so that they
do the same motions.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf, isfinite, pi

import numpy as np

from stepbot.engines.mujoco.simulation import MujocoSimulation
from stepbot.engines.simulation import Mechanism, Motor, Setup
from stepbot.robot.model import ActuatorKind
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
"""Parts of a step at which nothing may be in the way."""
_STRIDES = 48
"""Number of positions tried along a joint's range."""

Q = Mapping[str, float]


@dataclass(frozen=True)
class Move:
    """A motion of one motor, the others at home."""

    motor: str
    ends: tuple[float, ...]
    """Positions [rad] or [m] to visit in turn, from home."""


@dataclass(frozen=True)
class Survey:
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


def survey(file: str, mechanism: Mechanism, fingers: tuple[Fingers, ...], mass: float) -> Survey:
    """Choose the poses.

    Args:
        file: The MJCF; empty for a robot without one, whose contacts are not known and that grips nothing.
        mechanism: The robot.
        fingers: Links that may be fingers or jaws.
        mass: Mass [kg] of the cube to grip.
    """
    place = _Place(file, mechanism)
    sweeps = tuple(place.sweep(motor) for motor in place.servos)
    shares = [share for motor, sweep in zip(place.servos, sweeps, strict=True) for share in _share(motor, sweep)]
    tried = {
        pair: (find_jaw_grasp if pair.fixed else find_grasp)(file, mechanism, pair, mass)
        for pair in (fingers if file else ())
    }
    return Survey(
        poses=tuple(place.poses()),
        steps=tuple(move for motor in place.servos for move in place.step(motor)),
        sweeps=sweeps,
        covered=float(np.mean(shares)) if shares else 1.0,
        grasps=tuple(found for found in tried.values() if not isinstance(found, str)),
        misses={pair.motors[0]: found for pair, found in tried.items() if isinstance(found, str)},
    )


def _share(motor: Motor, sweep: Move) -> Iterator[float]:
    span = motor.limit.upper - motor.limit.lower
    if isfinite(span) and span > 0.0:
        yield (sweep.ends[1] - sweep.ends[0]) / span


class _Place:
    """The robot in the air, to look for contacts."""

    def __init__(self, file: str, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._simulation = MujocoSimulation(file, mechanism, Setup(held=True)) if file else None
        self.servos = [motor for motor in mechanism.motors if motor.kind is ActuatorKind.POSITION]
        self._allowed = inf
        self._allowed = self._depth(mechanism.home) + _CLEAR

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

    def sweep(self, motor: Motor) -> Move:
        """The range of a motor around home, up to the first contact or the end of the loops."""
        home = self._mechanism.home[motor.joint]
        low, high = (self._free_end(motor, end) for end in self._range(motor))
        return Move(motor.name, (low, high, home))

    def _free_end(self, motor: Motor, end: float) -> float:
        home = self._mechanism.home[motor.joint]
        if self._mechanism.robot.closures:
            q = self._reach({motor.joint: end})
            return q[motor.joint] if self._depth(q) <= self._allowed else home
        free = home
        for share in np.linspace(0.0, 1.0, _STRIDES + 1)[1:].tolist():
            there = home + share * (end - home)
            if self._depth(posed(self._mechanism.robot, {motor.joint: there})) > self._allowed:
                break
            free = there
        return free
