"""Torque: random efforts, each up to the effort limit of its joint.

A motor gives no more effort in the direction in which its joint is faster than its velocity limit.
"""

from math import isfinite

import numpy as np

from stepbot.engines.simulation import Motor

from ..results import Measure, Plot, Result, largest, thinned
from ..stage import Gaps, Stage, by_kind, run
from ..survey import SEED

_SECONDS = 2.0
_CHANGE = 0.05
"""Time [s] between two random efforts."""


def experiment(stage: Stage) -> Result:
    """Drive all joints that have a motor and an effort limit."""
    motors = [motor for motor in stage.mechanism.motors if isfinite(motor.limit.effort)]
    random = np.random.Generator(np.random.PCG64(SEED))
    gaps, times, speeds = Gaps(stage, stride=1), [], []
    beyond: dict[Motor, float] = dict.fromkeys(motors, 0.0)
    fastest: dict[str, float] = {}
    with stage.scene(held=True) as simulation:
        simulation.reset(stage.mechanism.home)
        efforts: dict[str, float] = {}
        changed = -_CHANGE
        for time in run(simulation, _SECONDS):
            gaps.measure(simulation)
            q, v = simulation.positions(), simulation.speeds()
            if time - changed >= _CHANGE - 1e-9:
                draw = random.uniform(-1.0, 1.0, len(motors)).tolist()
                efforts = {motor.joint: share * motor.limit.effort for motor, share in zip(motors, draw, strict=True)}
                changed = time
            simulation.apply({motor.joint: _given(motor, efforts[motor.joint], v[motor.joint]) for motor in motors})
            for motor in motors:
                over = max(q[motor.joint] - motor.limit.upper, motor.limit.lower - q[motor.joint], 0.0)
                beyond[motor] = max(beyond[motor], over)
                if isfinite(motor.limit.velocity):
                    share = 100.0 * abs(v[motor.joint]) / motor.limit.velocity
                    fastest[motor.joint] = max(fastest.get(motor.joint, 0.0), share)
            times.append(time)
            speeds.append(max((abs(v[motor.joint]) for motor in motors), default=0.0))
    measures: tuple[Measure, ...] = by_kind(beyond, "angle beyond limit", "travel beyond limit")
    measures = (*measures, *largest("speed of limit", fastest), *gaps.measures())
    curves = {"largest speed [rad/s, m/s]": thinned(times, speeds)}
    if stage.mechanism.robot.closures:
        curves["loop opening [mm]"] = thinned(times, gaps.trace)
    return Result("torque", measures, Plot("time [s]", "speed, loop opening", curves))


def _given(motor: Motor, effort: float, speed: float) -> float:
    return 0.0 if abs(speed) > motor.limit.velocity and effort * speed > 0.0 else effort
