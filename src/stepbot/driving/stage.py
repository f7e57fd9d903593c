"""What the tests share: the robot in a fresh scene, targets at home, and the gaps of the loops."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import atan2, copysign, degrees, hypot, isfinite

import numpy as np
from msgspec import Struct

from stepbot.engines.simulation import Mechanism, Motor, Setup, Simulation
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import ActuatorKind, JointKind, LoopClosure, Robot

from .mechanism import Wheels
from .results import Measure, largest
from .survey import Survey

MM = 1e3
_LIFT = 1e-4
"""Height [m] at which a robot is placed above the floor."""
_SHARE = 0.5
"""Largest commanded speed, relative to the joint's limit."""
_SPEED = 2.0
"""Largest commanded speed [rad/s] of a joint without a limit, and of all others."""
_TRAVEL_SPEED = 0.25
"""The same [m/s] for sliding joints."""


class Diverged(Exception):
    """The simulation is not finite any more."""


class Stage(Struct, eq=False):
    """One robot in one engine."""

    open: Callable[[Setup], Simulation]
    """Loads the file into a scene."""
    mechanism: Mechanism
    survey: Survey
    wheels: Wheels | None
    limbs: tuple[str, ...]
    steps: int = 0
    seconds: float = 0.0

    @contextmanager
    def scene(self, *, floor: bool = False, held: bool = False, setup: Setup | None = None) -> Iterator[Simulation]:
        """A simulation in a scene of its own.

        Raises:
            Diverged: It is not finite at the end.
        """
        simulation = self.open(setup or Setup(floor=floor, held=held))
        try:
            yield simulation
            if not simulation.finite():
                raise Diverged
        finally:
            self.steps += simulation.steps
            self.seconds += simulation.seconds
            simulation.close()

    def motors(self, kind: ActuatorKind) -> tuple[Motor, ...]:
        """The motors of a kind."""
        return tuple(motor for motor in self.mechanism.motors if motor.kind is kind)

    @property
    def home(self) -> dict[str, float]:
        """Targets of all motors at home: positions, and no speed."""
        return self.targets(self.mechanism.home)

    def targets(self, q: Mapping[str, float]) -> dict[str, float]:
        """Targets of all motors at a configuration: positions, and no speed."""
        return {
            motor.name: q[motor.joint] if motor.kind is ActuatorKind.POSITION else 0.0
            for motor in self.mechanism.motors
            if motor.kind is not ActuatorKind.MOTOR
        }

    def motor(self, name: str) -> Motor:
        """The motor of a name."""
        return next(motor for motor in self.mechanism.motors if motor.name == name)


def run(simulation: Simulation, seconds: float) -> Iterator[float]:
    """Step for a time [s]; yields the time [s] after each step."""
    for step in range(1, round(seconds / simulation.timestep) + 1):
        simulation.step()
        yield step * simulation.timestep


def cruising_speed(motor: Motor) -> float:
    """Largest speed [rad/s] or [m/s] at which targets move: half the joint's limit, and no more than a robot needs."""
    fastest = _SPEED if motor.angular else _TRAVEL_SPEED
    return min(fastest, _SHARE * motor.limit.velocity) if isfinite(motor.limit.velocity) else fastest


def place(simulation: Simulation, stage: Stage, height: float = 0.0) -> None:
    """Place the robot at home with its lowest point at a height [m] above the floor."""
    simulation.reset(stage.mechanism.home, Pose.of(position=(0.0, 0.0, 1.0)))
    low = simulation.lowest()
    simulation.reset(stage.mechanism.home, Pose.of(position=(0.0, 0.0, 1.0 - low + height + _LIFT)))


def tilt(X_WR: Pose) -> float:
    """Angle [deg] between the root link's z axis and the vertical."""
    return degrees(atan2(hypot(X_WR.R[2, 0], X_WR.R[2, 1]), X_WR.R[2, 2]))


class Speeds:
    """The largest speed of each joint, relative to its limit [%]: driven by its motor, and pushed against it."""

    def __init__(self, robot: Robot) -> None:
        """Nothing is measured yet."""
        self._dynamics = {joint.name: joint.dynamics for joint in robot.joints}
        self._driven: dict[Motor, float] = {}
        self._pushed: dict[str, float] = {}

    def measure(self, simulation: Simulation, motor: Motor) -> float:
        """Measure the joint of a motor; returns its speed."""
        v = simulation.speeds()[motor.joint]
        if isfinite(motor.limit.velocity):
            share = 100.0 * abs(v) / motor.limit.velocity
            # Beyond its limit, a joint whose motor gives less than its damping and friction take is driven on by
            # gravity, other joints or its loop.
            own = self._dynamics[motor.joint]
            left = copysign(1.0, v) * simulation.effort(motor.joint) - own.damping * abs(v) - own.friction
            if share > 100.0 and left <= 0.0:
                self._pushed[motor.joint] = max(self._pushed.get(motor.joint, 0.0), share)
            else:
                self._driven[motor] = max(self._driven.get(motor, 0.0), share)
        return v

    def measures(self) -> tuple[Measure, ...]:
        """The largest of both; none without limits of speed."""
        return (*by_gains(self._driven, "speed of limit"), *largest("pushed speed of limit", self._pushed))


class Gaps:
    """The widest gap of each closure so far."""

    def __init__(self, stage: Stage, stride: int = 5) -> None:
        """Measure every ``stride``-th time: in slow motions a gap changes little from step to step."""
        self._stride, self._calls = stride, 0
        self._closures = stage.mechanism.robot.closures
        self._widest = dict.fromkeys((closure.name for closure in self._closures), 0.0)
        self.trace: list[float] = []

    def measure(self, simulation: Simulation) -> None:
        """Measure all gaps, if it is time."""
        self._calls += 1
        if self._calls % self._stride:
            return
        now = 0.0
        for closure in self._closures:
            gap = MM * _gap(closure, simulation)
            now = max(now, gap)
            self._widest[closure.name] = max(self._widest[closure.name], gap)
        self.trace.append(now)

    def measures(self) -> tuple[Measure, ...]:
        """The widest gap [mm]; none for a robot without loops."""
        return largest("loop opening", self._widest)


def _gap(closure: LoopClosure, simulation: Simulation) -> float:
    """Distance [m] of the two frames, across the axis of a prismatic closure."""
    X_WF, X_WG = simulation.pose(closure.link_a) @ closure.X_AF, simulation.pose(closure.link_b) @ closure.X_BF
    apart: Array = X_WG.p - X_WF.p
    if closure.kind is JointKind.PRISMATIC:
        apart = np.cross(X_WF.turn(closure.axis), apart)
    return float(np.linalg.norm(apart))


def by_gains(values: Mapping[Motor, float], quantity: str) -> tuple[Measure, ...]:
    """The largest value of motors with computed gains, which have stated limits, and of those with given ones."""
    computed = {motor.joint: value for motor, value in values.items() if motor.computed}
    given = {motor.joint: value for motor, value in values.items() if not motor.computed}
    return (*largest(quantity, computed), *largest(f"{quantity} with other gains", given))


def by_kind(errors: Mapping[Motor, float], angular: str, linear: str) -> tuple[Measure, ...]:
    """The largest value [rad] of turning and [mm] of sliding joints, as two quantities."""
    turning = {motor.joint: value for motor, value in errors.items() if motor.angular}
    sliding = {motor.joint: MM * value for motor, value in errors.items() if not motor.angular}
    return (*largest(angular, turning), *largest(linear, sliding))
