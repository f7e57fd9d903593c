"""Tests of the whole robot: drop and stand. Those of wheeled bases are in :mod:`.wheels`.

- `drop`: a floating robot falls on the floor with its motors at home; a fixed one falls limp, its motors off. Nothing
  adds energy to a limp robot: what its energy grows by comes from the simulation.
- `stand`: the push gives the robot half the speed at which a rigid block of its height and width would tip over.
"""

from math import hypot, sqrt

import numpy as np

from stepbot.engines.simulation import GRAVITY, Setup, Simulation
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import Base

from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, place, run, tilt

_HEIGHT = 0.05
"""Height [m] of the fall."""
_FALL_SECONDS = 2.0
_LIMP_SECONDS = 1.0
_LAST = 0.25
"""Time [s] at the end in which a robot that fell or was pushed is to be at rest."""
_BEFORE_PUSH = 1.5
"""Time [s] to stand before the push."""
_PUSH = 0.1
"""Time [s] of the push."""
_AFTER = 2.0
"""Time [s] after the push."""
_TIPPING_SHARE = 0.5


def drop(stage: Stage) -> Result:
    """Drop a floating robot, let a fixed one fall limp."""
    return _fall(stage) if stage.mechanism.robot.base is Base.FLOATING else _limp(stage)


def _fall(stage: Stage) -> Result:
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, heights, energies, depth = [], [], [], 0.0
    with stage.scene(floor=True) as simulation:
        place(simulation, stage, _HEIGHT)
        simulation.command(stage.home)
        before = exact_sum(simulation.energy())
        for time in run(simulation, _FALL_SECONDS):
            gaps.measure(simulation)
            times.append(time)
            heights.append(MM * simulation.pose(root).position[2])
            energies.append(exact_sum(simulation.energy()) - before)
            if time > _FALL_SECONDS - _LAST:
                depth = max(depth, MM * simulation.penetration())
    rest = [height for time, height in zip(times, heights, strict=True) if time > _FALL_SECONDS - _LAST]
    fallen = _weight(stage) * _HEIGHT
    measures = (
        Measure("energy gain", 100.0 * max(0.0, *energies) / fallen),
        Measure("penetration", depth),
        Measure("height drift", max(rest) - min(rest)),
        *gaps.measures(),
    )
    curves = {"height of the root [mm]": thinned(times, heights)}
    return Result("drop", measures, Plot("time [s]", "height [mm]", curves))


def _limp(stage: Stage) -> Result:
    gaps, times, energies = Gaps(stage), [], []
    # Energy [J] that lifts the robot by a millimetre: the scale of one that does not fall.
    scale = 1e-3 * max(1e-3, _weight(stage))
    with stage.scene(setup=Setup(fine=True)) as simulation:
        simulation.reset(stage.mechanism.home)
        before = exact_sum(simulation.energy())
        for time in run(simulation, _LIMP_SECONDS):
            gaps.measure(simulation)
            times.append(time)
            potential, kinetic = simulation.energy()
            energies.append(potential + kinetic - before)
            scale = max(scale, kinetic)
    gain = 100.0 * max(0.0, *energies) / scale
    curves = {"energy [J]": thinned(times, energies)}
    return Result("drop", (Measure("energy gain", gain), *gaps.measures()), Plot("time [s]", "energy [J]", curves))


def _weight(stage: Stage) -> float:
    """Weight [N] of the robot."""
    return GRAVITY * exact_sum(link.mass_properties.mass for link in stage.mechanism.robot.links)


def stand(stage: Stage) -> Result:
    """Stand, and be pushed to the left."""
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, tilts, heights, drift = [], [], [], []
    with stage.scene(floor=True) as simulation:
        place(simulation, stage)
        simulation.command(stage.home)
        first = simulation.pose(root)
        speed = _TIPPING_SHARE * _tipping_speed(stage, simulation)
        force = np.array([0.0, _weight(stage) / GRAVITY * speed / _PUSH, 0.0])
        for time in run(simulation, _BEFORE_PUSH + _PUSH + _AFTER):
            simulation.push(force if _BEFORE_PUSH <= time < _BEFORE_PUSH + _PUSH else np.zeros(3))
            gaps.measure(simulation)
            X_WR = simulation.pose(root)
            times.append(time)
            tilts.append(tilt(X_WR))
            heights.append(MM * X_WR.position[2])
            if time > _BEFORE_PUSH + _PUSH + _AFTER - _LAST:
                drift.append(MM * X_WR.p)
        depth = MM * simulation.penetration()
        last = simulation.pose(root)
    before = [i for i, time in enumerate(times) if time < _BEFORE_PUSH]
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
