"""Tests of a wheeled base: it rolls ahead and back, strafes to the left and back, and turns once on the spot."""

from collections.abc import Callable, Iterator, Mapping
from math import atan2, copysign, degrees, hypot, inf, isfinite, pi

import numpy as np

from stepbot.engines.simulation import Simulation
from stepbot.geometry.spatial import Array

from ..results import Measure, Plot, Result, Spin, thinned
from ..stage import MM, Gaps, Stage, place, run, tilt

_SETTLE = 0.5
_STOP = 0.5
"""Time [s] at rest before and after each way."""
_WAY = 2.0
"""Length [m] of each way; less if the wheels are slow."""
_SIDEWAYS = 0.6
"""The same of strafing."""
_SECONDS = 10.0
"""Longest time [s] of a way."""
_SPEED = 0.3
"""Speed [m/s] of the base at its wheels; less if they cannot turn so fast."""
_SHARE = 0.5
"""Largest speed of a wheel, relative to its velocity limit: what corrects it needs a margin."""
_LOOK = 25
"""Number of steps from one look at the contacts to the next."""
_TILTS = 64
"""Number of tilts of a roller's axis, from level to where the next roller carries."""
_RAMP = 0.5
"""Time [s] in which the base starts and stops: at once, a short base rears up on its wheels."""


def roll(stage: Stage) -> Result:
    """Drive ahead and back at constant speed."""
    assert stage.wheels is not None
    return _drive(stage, "roll", stage.wheels.direction, _WAY)


def strafe(stage: Stage) -> Result:
    """Drive to the left and back at constant speed."""
    assert stage.wheels is not None
    left = np.cross((0.0, 0.0, 1.0), stage.wheels.direction)
    return _drive(stage, "strafe", (float(left[0]), float(left[1]), float(left[2])), _SIDEWAYS)


def _places(stage: Stage, simulation: Simulation) -> list[Array]:
    """Where the driven wheels are (3,) [m]: on their axles, above the middle of what touches the floor, if they do.

    The frame of a wheel is where its axle was found, often the face of its motor and not the middle of its tread.
    """
    assert stage.wheels is not None
    places, standing = [], simulation.standing()
    for wheel in stage.wheels.wheels:
        X, joint = simulation.pose(wheel.link), stage.mechanism.robot.joint_by_name[stage.motor(wheel.motor).joint]
        axle = X.turn(joint.axis)
        places.append(X.p + (float(axle @ (standing[wheel.link] - X.p)) if wheel.link in standing else 0.0) * axle)
    return places


def _spins(
    stage: Stage, simulation: Simulation, velocity: Callable[[Array], Array]
) -> tuple[Mapping[str, float], float]:
    """Speed of each wheel's motor, as fast as the test allows, and by how much slower or faster than asked for.

    A roller on the floor does not slip along its axis e: v . e = w R (f . e) for the wheel's velocity v, speed w and
    radius R, and the direction f in which the wheel drives the base; without rollers, e is f. One of n rollers carries
    while the wheel turns by 2 pi / n, which tilts e: the mean speed of the base over that angle is what is asked for.

    Args:
        velocity: Velocity (3,) [m/s] of the base at a place (3,) [m], where a wheel is in the world.
    """
    assert stage.wheels is not None
    robot, wheels, speeds = stage.mechanism.robot, stage.wheels, {}
    fastest, slowest = 0.0, inf
    ahead = np.array(wheels.direction)
    for index, (wheel, where) in enumerate(zip(wheels.wheels, _places(stage, simulation), strict=True)):
        wanted = velocity(where)
        way = float(ahead @ wanted)
        if wheels.rollers:
            joints = [robot.joint_by_name[name] for name in wheels.rollers[index]]
            lowest = min(joints, key=lambda joint: simulation.pose(joint.child).position[2])
            axis = simulation.pose(lowest.child).turn(lowest.axis)
            across = axis - float(axis @ ahead) * ahead - np.array((0.0, 0.0, axis[2]))
            lean = copysign(hypot(float(axis @ ahead), float(axis[2])), float(axis @ ahead))
            tilts = (np.arange(_TILTS) + 0.5) * (pi / len(joints) / _TILTS)
            ways = way + float(across @ wanted) / (lean * np.cos(tilts))
            way = 1.0 / float(np.mean(1.0 / ways)) if np.all(ways * ways[0] > 0.0) else float(ways[0])
        speeds[wheel.motor] = wheel.forwards * way / float(where[2])
        fastest = max(fastest, abs(way))
        if way:
            slowest = min(slowest, _SHARE * stage.motor(wheel.motor).limit.velocity * float(where[2]) / abs(way))
    scale = min(_SPEED / fastest, slowest)
    return {motor: scale * spin for motor, spin in speeds.items()}, scale


class _Turned:
    """How far the wheels turn, against what is asked for."""

    def __init__(self, stage: Stage, simulation: Simulation, spins: Mapping[str, float], seconds: float) -> None:
        self._simulation = simulation
        self._motors = {stage.motor(name): spin * seconds for name, spin in spins.items() if spin}
        self._start = simulation.positions()
        self._efforts = dict.fromkeys(self._motors, 0.0)
        assert stage.wheels is not None
        rolling = {wheel.link for wheel in stage.wheels.wheels}
        joints = stage.mechanism.robot.joint_by_name
        self._dragged = stage.wheels.dragged
        self._rolling = rolling | {joints[name].child for names in stage.wheels.rollers for name in names}
        self._standing: set[str] = set()
        self._steps = 0

    def measure(self) -> None:
        """Look at the efforts after a step, and now and then at what touches the floor."""
        self._steps += 1
        if self._steps % _LOOK == 0:
            self._standing |= self._simulation.standing().keys() - self._rolling
        for motor in self._efforts:
            self._efforts[motor] = max(self._efforts[motor], abs(self._simulation.effort(motor.joint)))

    def least(self, *, is_turn: bool = False) -> Spin | None:
        """The wheel that is farthest behind."""
        now = self._simulation.positions()
        shares = {one: (now[one.joint] - self._start[one.joint]) / asked for one, asked in self._motors.items()}
        if not shares:
            return None
        motor = min(shares, key=lambda one: shares[one])
        effort = self._efforts[motor] / motor.limit.effort if isfinite(motor.limit.effort) else None
        dragged = tuple(sorted(self._standing & self._dragged)) if is_turn else ()
        return Spin(motor.joint, shares[motor], motor.kv, effort, tuple(sorted(self._standing)), dragged)


def _ramped(stage: Stage, simulation: Simulation, spins: Mapping[str, float], seconds: float) -> Iterator[float]:
    """Drive as far as at constant speeds of the wheels for a time [s], but start and stop in :data:`_RAMP` each.

    Yields the time [s] after each step.
    """
    for time in run(simulation, seconds + _RAMP):
        share = max(0.0, min(1.0, time / _RAMP, (seconds + _RAMP - time) / _RAMP))
        simulation.command({**stage.home, **{motor: share * spin for motor, spin in spins.items()}})
        yield time


def _drive(stage: Stage, test: str, direction: tuple[float, float, float], way: float) -> Result:
    """Drive in a direction and back at constant speed.

    Args:
        direction: Unit vector in the root link.
        way: Length [m] of each way.
    """
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, path, tilts, clock, spin = [], [], [], 0.0, None
    with stage.scene(floor=True) as simulation:
        place(simulation, stage)
        ahead_spins, speed = _spins(stage, simulation, lambda place: np.array(direction))
        going = min(_SECONDS, way / speed)
        still = dict.fromkeys(ahead_spins, 0.0)
        back_spins = {motor: -spin for motor, spin in ahead_spins.items()}
        places = {}
        for name, targets, seconds in (
            ("start", still, _SETTLE),
            ("ahead", ahead_spins, going),
            ("there", still, _STOP),
            ("back", back_spins, going),
            ("end", still, _STOP),
        ):
            wheels = _Turned(stage, simulation, targets, seconds)
            for time in _ramped(stage, simulation, targets, seconds):
                X_WR = simulation.pose(root)
                wheels.measure()
                gaps.measure(simulation)
                times.append(clock + time)
                path.append(MM * float(X_WR.p @ np.array(direction)))
                tilts.append(tilt(X_WR))
            clock = times[-1]
            places[name] = simulation.pose(root)
            spin = wheels.least() if name == "ahead" else spin
    start, there, end = (places[name] for name in ("start", "there", "end"))
    ahead = np.array(direction)
    side = np.cross((0.0, 0.0, 1.0), ahead)
    gone, back = start.R.T @ (there.p - start.p), start.R.T @ (end.p - start.p)
    expected = speed * going
    turned = start.R.T @ there.R
    measures = (
        Measure("distance error", 100.0 * abs(float(gone @ ahead) / expected - 1.0)),
        Measure("sideways", MM * abs(float(gone @ side))),
        Measure("heading", abs(degrees(atan2(turned[1, 0], turned[0, 0])))),
        Measure("return error", MM * float(np.linalg.norm(back[:2]))),
        Measure("tilt", max(tilts)),
        *gaps.measures(),
    )
    curves = {"way [mm]": thinned(times, path)}
    return Result(test, measures, Plot("time [s]", "way [mm]", curves), spin=spin)


def turn(stage: Stage) -> Result:
    """Turn by 360 degrees at constant speed of the wheels."""
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, angles, tilts = [0.0], [0.0], [0.0]
    with stage.scene(floor=True) as simulation:
        place(simulation, stage)
        simulation.command(stage.home)
        for _ in run(simulation, _SETTLE):
            gaps.measure(simulation)
        start, middle = simulation.pose(root), _middle(stage, simulation)
        turning, rate = _spins(stage, simulation, lambda place: np.cross((0.0, 0.0, 1.0), place - middle))
        wheels = _Turned(stage, simulation, turning, 2.0 * pi / rate)
        for targets, seconds in ((turning, 2.0 * pi / rate), (dict.fromkeys(turning, 0.0), _STOP)):
            for _ in _ramped(stage, simulation, targets, seconds):
                wheels.measure()
                gaps.measure(simulation)
                X_WR = simulation.pose(root)
                x, y, _ = start.R.T @ X_WR.R[:, 0]
                angles.append(angles[-1] + (float(np.arctan2(y, x)) - angles[-1] + pi) % (2.0 * pi) - pi)
                times.append(times[-1] + simulation.timestep)
                tilts.append(tilt(X_WR))
        moved, spin = _middle(stage, simulation) - middle, wheels.least(is_turn=True)
    measures = (
        Measure("turn error", 100.0 * abs(angles[-1] / (2.0 * pi) - 1.0)),
        Measure("displacement", MM * float(np.linalg.norm(moved[:2]))),
        Measure("tilt", max(tilts)),
        *gaps.measures(),
    )
    curve = thinned(times, [degrees(angle) for angle in angles])
    return Result("turn", measures, Plot("time [s]", "heading [deg]", {"heading [deg]": curve}), spin=spin)


def _middle(stage: Stage, simulation: Simulation) -> Array:
    """Point (3,) [m] in the middle of the driven wheels."""
    return np.asarray(np.array(_places(stage, simulation)).mean(axis=0))
