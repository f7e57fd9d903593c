"""Sweep: each motor visits both ends of its range and returns home."""

from math import cos, pi

from stepbot.engines.simulation import Motor

from ..results import Measure, Plot, Result, thinned
from ..stage import Gaps, Stage, by_kind, cruising_speed, run

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
