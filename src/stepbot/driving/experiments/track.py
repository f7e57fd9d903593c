"""Track: each position motor follows a slow sine, one after the other."""

from math import cos, hypot, pi, sin

from stepbot.engines.simulation import Motor, Simulation
from stepbot.geometry.fixed_point import exact_sum

from ..results import Measure, Plot, Result, Series, largest, thinned
from ..stage import Gaps, Stage, by_gains, run
from ..survey import Move

FREQUENCY = 0.5
"""Frequency [Hz] of the sine; its amplitude is half the step of :mod:`.step`."""
_SETTLE = 0.5
"""Time [s] at home before the sine, and of its beginning that is not measured."""


def experiment(stage: Stage) -> Result:
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
    amplitude, w = 0.5 * (end - home), 2.0 * pi * FREQUENCY
    simulation.command(targets)
    for _ in run(simulation, _SETTLE):
        gaps.measure(simulation)
    times, errors = [], []
    time = 0.0
    while time < _SETTLE + 1.0 / FREQUENCY - 0.5 * simulation.timestep:
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
