"""Sweep: each motor visits both ends of its range and returns home."""

from math import cos, isfinite, pi

from stepbot.engines.simulation import Motor

from ..results import Measure, Plot, Result, thinned
from ..stage import Gaps, Stage, by_kind, run

_SHARE = 0.5
"""Largest commanded speed, relative to the joint's limit."""
_SPEED = 2.0
"""Largest commanded speed [rad/s] of a joint without a limit, and of all others."""
_TRAVEL_SPEED = 0.25
"""The same [m/s] for sliding joints."""
_SHORTEST = 0.25
"""Shortest time [s] of one way."""
_DWELL = 0.5
"""Time [s] at each end."""
_EDGE = 0.02
"""Share of the range that is left at each end: a joint resting on its stop would not show an error."""


def experiment(stage: Stage) -> Result:
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
                seconds = max(_SHORTEST, 0.5 * pi * abs(end - start) / _speed(motor))
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


def _speed(motor: Motor) -> float:
    fastest = _SPEED if motor.angular else _TRAVEL_SPEED
    return min(fastest, _SHARE * motor.limit.velocity) if isfinite(motor.limit.velocity) else fastest
