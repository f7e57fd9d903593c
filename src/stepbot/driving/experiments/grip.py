"""Grip: the fingers close on a cube without weight, which then gets its weight."""

from collections.abc import Mapping

import numpy as np

from stepbot.engines.simulation import Setup, Simulation
from stepbot.geometry.spatial import Array

from ..grasping import Grasp
from ..results import Plot, Result, largest, thinned
from ..stage import MM, Gaps, Stage, run

_CLOSE = 1.5
"""Time [s] to close and come to rest."""
SECONDS = 5.0
"""Time [s] for which the cube is held."""


def experiment(stage: Stage) -> Result:
    """Grip with every gripper, one after the other."""
    gaps, curves = Gaps(stage), {}
    slips, depths = {}, {}
    for grasp in stage.survey.grasps:
        with stage.scene(setup=Setup(held=True, cube=grasp.cube)) as simulation:
            name = stage.motor(grasp.fingers.motors[0]).joint
            times, slip = [], []
            start = _gripped(stage, simulation, grasp, gaps)
            for time in run(simulation, SECONDS):
                gaps.measure(simulation)
                times.append(time)
                slip.append(MM * float(np.linalg.norm(_in_fingers(simulation, grasp) - start)))
            slips[name], depths[name] = max(slip), MM * simulation.penetration()
            curves[name] = thinned(times, slip)
    measures = (*largest("slip", slips), *largest("penetration", depths), *gaps.measures())
    return Result("grip", measures, Plot("time [s]", "slip [mm]", curves))


def _gripped(stage: Stage, simulation: Simulation, grasp: Grasp, gaps: Gaps) -> Array:
    """Close the fingers; returns where the cube is in them as it gets its weight."""
    simulation.reset(grasp.open)
    simulation.place_cube(simulation.pose(grasp.fingers.hand) @ grasp.X_HC)
    targets: Mapping[str, float] = {**stage.targets(grasp.open), **dict.fromkeys(grasp.fingers.motors, grasp.closed)}
    simulation.command(targets)
    for _ in run(simulation, _CLOSE):
        gaps.measure(simulation)
    start = _in_fingers(simulation, grasp)
    simulation.let_go()
    return start


def _in_fingers(simulation: Simulation, grasp: Grasp) -> Array:
    """Position (3,) of the cube from the middle of the two fingers, in the frame of one."""
    one, other = (simulation.pose(min(side)) for side in (grasp.fingers.one, grasp.fingers.other))
    middle = 0.5 * (one.p + other.p)
    return np.array(one.R.T @ (simulation.cube().p - middle))
