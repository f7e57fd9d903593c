"""Stand: a legged robot stands on the floor, is pushed to one side, and stays standing.

The push gives the robot half the speed at which a rigid block of its height and width would tip over.
"""

from math import hypot, sqrt

import numpy as np

from stepbot.engines.simulation import GRAVITY, Simulation

from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, run, stand, tilt
from .drop import stage_weight

_SETTLE = 1.5
"""Time [s] to stand before the push."""
_PUSH = 0.1
"""Time [s] of the push."""
_AFTER = 2.0
"""Time [s] after the push."""
_SHARE = 0.5
_LAST = 0.25


def experiment(stage: Stage) -> Result:
    """Stand, and be pushed to the left."""
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, tilts, heights, drift = [], [], [], []
    with stage.scene(floor=True) as simulation:
        stand(simulation, stage)
        simulation.command(stage.home)
        first = simulation.pose(root)
        speed = _SHARE * _tipping_speed(stage, simulation)
        force = np.array([0.0, stage_weight(stage) / GRAVITY * speed / _PUSH, 0.0])
        for time in run(simulation, _SETTLE + _PUSH + _AFTER):
            simulation.push(force if _SETTLE <= time < _SETTLE + _PUSH else np.zeros(3))
            gaps.measure(simulation)
            X_WR = simulation.pose(root)
            times.append(time)
            tilts.append(tilt(X_WR))
            heights.append(MM * X_WR.position[2])
            if time > _SETTLE + _PUSH + _AFTER - _LAST:
                drift.append(MM * X_WR.p)
        depth = MM * simulation.penetration()
        last = simulation.pose(root)
    before = [i for i, time in enumerate(times) if time < _SETTLE]
    measures = (
        Measure("tilt at rest", tilts[before[-1]]),
        Measure("sinking", MM * first.position[2] - heights[before[-1]]),
        Measure("tilt", max(tilts)),
        Measure("tilt after push", tilts[-1]),
        Measure("height loss", 100.0 * (1.0 - last.position[2] / first.position[2])),
        Measure("drift", float(np.max(np.ptp(np.array(drift), axis=0)))),
        Measure("penetration", depth),
        Measure("push", speed),
        *gaps.measures(),
    )
    curves = {"tilt [deg]": thinned(times, tilts)}
    return Result("stand", measures, Plot("time [s]", "tilt [deg]", curves))


def _tipping_speed(stage: Stage, simulation: Simulation) -> float:
    """Speed [m/s] at which a point mass at the root's height would just tip over the outermost foot to the side."""
    tips = {joint.child for joint in stage.mechanism.robot.joints} - {j.parent for j in stage.mechanism.robot.joints}
    X_WR = simulation.pose(stage.mechanism.robot.root.name)
    side = max(abs(float(simulation.pose(tip).position[1]) - X_WR.position[1]) for tip in tips)
    height = X_WR.position[2]
    return sqrt(2.0 * GRAVITY * (hypot(side, height) - height))
