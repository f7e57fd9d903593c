"""Tests of the motors of a robot whose base is held: hold, step, track, sweep and torque.

`torque` applies random efforts, each up to the effort limit of its joint; a motor gives no more effort in the direction
in which its joint is faster than its velocity limit.
"""

from math import copysign, cos, hypot, isfinite, pi, sin

import numpy as np

from stepbot.engines.simulation import Motor, Simulation
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import ActuatorKind

from ..results import Measure, Plot, Result, Series, largest, thinned
from ..stage import Gaps, Speeds, Stage, by_gains, by_kind, cruising_speed, run
from ..survey import SEED, Move

_HELD = 1.5
"""Time [s] for which each pose is held."""
_RESPONSE = 1.5
"""Time [s] from a step of the target, ..."""
_REST = 1.0
"""... and the least time [s] after its way at the velocity limit: a screw takes seconds for its step."""
_LAST = 0.25
"""Time [s] at the end in which the robot is to be at rest, and that the response to a step is compared with."""
_SETTLE = 0.5
"""Time [s] at home before a step or a sine, and of the beginning of a sine that is not measured."""
_SPEED_SHARE = 0.5
"""Step of a velocity motor, relative to its limit."""
_SPEED = 1.0
"""Step [rad/s], [m/s] of a velocity motor without a limit."""
_FREQUENCY = 0.5
"""Frequency [Hz] of the sine; its amplitude is half the step of :func:`step`, ..."""
_SINE_SHARE = 0.9
"""... or less where the target would be faster than this share of the velocity limit."""
_SHORTEST = 0.25
"""Shortest time [s] of one way of a sweep."""
_DWELL = 0.5
"""Time [s] at each end of a sweep."""
_EDGE = 0.02
"""Share of the range that is left at each end: a joint resting on its stop would not show an error."""
_DRIVEN = 2.0
"""Time [s] of random efforts."""
_CHANGE = 0.05
"""Time [s] between two random efforts."""


def hold(stage: Stage) -> Result:
    """Hold every pose of the survey."""
    servos = stage.motors(ActuatorKind.POSITION)
    errors = dict.fromkeys(servos, 0.0)
    drifts = dict.fromkeys(servos, 0.0)
    gaps, curves = Gaps(stage), {}
    with stage.scene(held=True) as simulation:
        for number, q in enumerate(stage.survey.poses, 1):
            simulation.reset(q)
            simulation.command(stage.targets(q))
            times, worst, last = [], [], []
            for time in run(simulation, _HELD):
                gaps.measure(simulation)
                now = simulation.positions()
                times.append(time)
                worst.append(max((abs(now[motor.joint] - q[motor.joint]) for motor in servos), default=0.0))
                if time > _HELD - _LAST:
                    last.append(now)
            for motor in servos:
                seen = [now[motor.joint] for now in last]
                errors[motor] = max(errors[motor], abs(seen[-1] - q[motor.joint]))
                drifts[motor] = max(drifts[motor], max(seen) - min(seen))
            curves[f"pose {number}"] = thinned(times, worst)
    turning = by_gains({motor: error for motor, error in errors.items() if motor.angular}, "angle error")
    travel = by_kind({motor: error for motor, error in errors.items() if not motor.angular}, "", "travel error")
    measures = (*turning, *travel, *by_kind(drifts, "angle drift", "travel drift"))
    measures = (*measures, Measure("poses", float(len(stage.survey.poses))), *gaps.measures())
    return Result("hold", measures, Plot("time [s]", "largest error [rad, m]", curves))


def step(stage: Stage) -> Result:
    """Step every position motor, and every velocity motor that does not drive a wheel."""
    gaps, curves = Gaps(stage), {}
    overshoots: dict[Motor, float] = {}
    errors: dict[Motor, float] = {}
    drive = _Steps(stage, gaps)
    with stage.scene(held=True) as simulation:
        for move in stage.survey.steps:
            motor = stage.motor(move.motor)
            overshoot, error, curve = drive.step(simulation, motor, move)
            overshoots[motor], errors[motor], curves[motor.joint] = overshoot, error, curve
        speed_errors = {}
        for motor in _spinning(stage):
            overshoot, error, curve = drive.spin(simulation, motor)
            overshoots[motor], speed_errors[motor.joint], curves[motor.joint] = overshoot, error, curve
    measures: tuple[Measure, ...] = (
        *by_gains(overshoots, "overshoot"),
        *by_kind(errors, "angle error", "travel error"),
    )
    measures = (*measures, *largest("speed error", speed_errors), *drive.speeds.measures(), *gaps.measures())
    return Result("step", measures, Plot("time [s]", "response, 1 = commanded", curves))


def _spinning(stage: Stage) -> list[Motor]:
    wheels = {wheel.motor for wheel in stage.wheels.wheels} if stage.wheels else set()
    return [motor for motor in stage.motors(ActuatorKind.VELOCITY) if motor.name not in wheels]


class _Steps:
    def __init__(self, stage: Stage, gaps: Gaps) -> None:
        self._stage, self._gaps, self.speeds = stage, gaps, Speeds(stage.mechanism.robot)

    def step(self, simulation: Simulation, motor: Motor, move: Move) -> tuple[float, float, Series]:
        """Overshoot [%], final error [rad] or [m], and the response."""
        simulation.reset(self._stage.mechanism.home)
        targets = self._stage.home
        simulation.command(targets)
        for _ in run(simulation, _SETTLE):
            self._gaps.measure(simulation)
        (end,) = move.ends
        start = simulation.positions()[motor.joint]
        size = end - self._stage.mechanism.home[motor.joint]
        seconds = max(_RESPONSE, abs(size) / motor.limit.velocity + _REST)
        simulation.command({**targets, motor.name: end})
        times, q = [], []
        for time in run(simulation, seconds):
            self._gaps.measure(simulation)
            self.speeds.measure(simulation, motor)
            times.append(time)
            q.append(simulation.positions()[motor.joint])
        last = [value for time, value in zip(times, q, strict=True) if time > seconds - _LAST]
        final = exact_sum(last) / len(last)
        beyond = max((value - final) / size for value in q)
        return 100.0 * max(0.0, beyond), abs(final - end), thinned(times, [(value - start) / size for value in q])

    def spin(self, simulation: Simulation, motor: Motor) -> tuple[float, float, Series]:
        """Overshoot [%], final error [%], and the response in speed."""
        simulation.reset(self._stage.mechanism.home)
        fastest = motor.limit.velocity
        goal = _SPEED_SHARE * fastest if fastest < 1e6 else _SPEED
        simulation.command({**self._stage.home, motor.name: goal})
        times, speeds = [], []
        for time in run(simulation, _RESPONSE):
            self._gaps.measure(simulation)
            times.append(time)
            speeds.append(self.speeds.measure(simulation, motor))
        last = [speed for time, speed in zip(times, speeds, strict=True) if time > 0.5 * _RESPONSE]
        final = exact_sum(last) / len(last)
        beyond = max(speed - final for speed in speeds) / abs(goal)
        error = abs(final - goal) / abs(goal)
        return 100.0 * max(0.0, beyond), 100.0 * error, thinned(times, [speed / goal for speed in speeds])


def track(stage: Stage) -> Result:
    """Follow a sine between home and the end of the step, which is free of contact."""
    gaps, curves = Gaps(stage), {}
    lags: dict[Motor, float] = {}
    with stage.scene(held=True) as simulation:
        for move in stage.survey.steps:
            motor = stage.motor(move.motor)
            lags[motor], curves[motor.joint] = _follow(simulation, stage, motor, move, gaps)
    free = by_gains({motor: lag for motor, lag in lags.items() if not motor.braked}, "lag")
    # More damping, which brakes large steps within the effort limit, follows a moving target less closely.
    limited = largest("lag with limited effort", {motor.joint: lag for motor, lag in lags.items() if motor.braked})
    measures: tuple[Measure, ...] = (*free, *limited, *gaps.measures())
    return Result("track", measures, Plot("time [s]", "error, 1 = amplitude", curves))


def _follow(simulation: Simulation, stage: Stage, motor: Motor, move: Move, gaps: Gaps) -> tuple[float, Series]:
    """Amplitude [%] of the error at the frequency of the sine, relative to its own, and the error."""
    simulation.reset(stage.mechanism.home)
    targets, (end,) = stage.home, move.ends
    home = stage.mechanism.home[motor.joint]
    w = 2.0 * pi * _FREQUENCY
    amplitude = copysign(min(0.5 * abs(end - home), _SINE_SHARE * motor.limit.velocity / w), end - home)
    simulation.command(targets)
    for _ in run(simulation, _SETTLE):
        gaps.measure(simulation)
    times, errors = [], []
    time = 0.0
    while time < _SETTLE + 1.0 / _FREQUENCY - 0.5 * simulation.timestep:
        time += simulation.timestep
        # From rest at home: the error of a start with speed would take as long to decay as the motion itself.
        target = home + amplitude * (1.0 - cos(w * time))
        simulation.command({**targets, motor.name: target})
        simulation.step()
        gaps.measure(simulation)
        times.append(time)
        errors.append((simulation.positions()[motor.joint] - target) / amplitude)
    measured = [(t, e) for t, e in zip(times, errors, strict=True) if t > _SETTLE]
    share = 2.0 / len(measured)
    in_phase = share * exact_sum(e * cos(w * t) for t, e in measured)
    behind = share * exact_sum(e * sin(w * t) for t, e in measured)
    return 100.0 * hypot(in_phase, behind), thinned(times, errors)


def sweep(stage: Stage) -> Result:
    """Sweep every position motor."""
    gaps, curves = Gaps(stage), {}
    errors: dict[Motor, float] = {}
    with stage.scene(held=True) as simulation:
        for move in stage.survey.sweeps:
            motor = stage.motor(move.motor)
            simulation.reset(stage.mechanism.home)
            targets, start, clock = stage.home, stage.mechanism.home[motor.joint], 0.0
            low, high, home = move.ends
            edge = _EDGE * (high - low)
            times, q, errors[motor] = [], [], 0.0
            for end in (low + edge, high - edge, home):
                seconds = max(_SHORTEST, 0.5 * pi * abs(end - start) / cruising_speed(motor))
                for time in run(simulation, seconds + _DWELL):
                    share = min(1.0, time / seconds)
                    goal = start + 0.5 * (1.0 - cos(pi * share)) * (end - start)
                    simulation.command({**targets, motor.name: goal})
                    gaps.measure(simulation)
                    times.append(clock + time)
                    q.append(simulation.positions()[motor.joint])
                errors[motor] = max(errors[motor], abs(q[-1] - end))
                start, clock = end, times[-1]
            curves[motor.joint] = thinned(times, q)
    covered = Measure("covered range", 100.0 * stage.survey.covered)
    measures = (*by_kind(errors, "angle error", "travel error"), covered, *gaps.measures())
    return Result("sweep", measures, Plot("time [s]", "position [rad, m]", curves))


def torque(stage: Stage) -> Result:
    """Drive all joints that have a motor and an effort limit."""
    motors = [motor for motor in stage.mechanism.motors if isfinite(motor.limit.effort)]
    random = np.random.Generator(np.random.PCG64(SEED))
    gaps, times, speeds = Gaps(stage, stride=1), [], []
    beyond: dict[Motor, float] = dict.fromkeys(motors, 0.0)
    fastest = Speeds(stage.mechanism.robot)
    with stage.scene(held=True) as simulation:
        simulation.reset(stage.mechanism.home)
        efforts: dict[str, float] = {}
        changed = -_CHANGE
        for time in run(simulation, _DRIVEN):
            gaps.measure(simulation)
            q = simulation.positions()
            if time - changed >= _CHANGE - 1e-9:
                draw = random.uniform(-1.0, 1.0, len(motors)).tolist()
                efforts = {motor.joint: share * motor.limit.effort for motor, share in zip(motors, draw, strict=True)}
                changed = time
            simulation.apply(efforts)
            for motor in motors:
                over = max(q[motor.joint] - motor.limit.upper, motor.limit.lower - q[motor.joint], 0.0)
                beyond[motor] = max(beyond[motor], over)
            times.append(time)
            speeds.append(max((abs(fastest.measure(simulation, motor)) for motor in motors), default=0.0))
    measures: tuple[Measure, ...] = by_kind(beyond, "angle beyond limit", "travel beyond limit")
    measures = (*measures, *fastest.measures(), *gaps.measures())
    curves = {"largest speed [rad/s, m/s]": thinned(times, speeds)}
    if stage.mechanism.robot.closures:
        curves["loop opening [mm]"] = thinned(times, gaps.trace)
    return Result("torque", measures, Plot("time [s]", "speed, loop opening", curves))
