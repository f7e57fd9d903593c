"""Grip: fingers, or a jaw and its hand, close on a cube without weight, which then gets its weight."""

from collections.abc import Mapping

import numpy as np

from stepbot.engines.simulation import DOWN, Setup, Simulation
from stepbot.geometry.spatial import Array, Pose

from ..grasping import Grasp
from ..results import Plot, Result, largest, thinned
from ..stage import MM, Gaps, Stage, run

_CLOSE = 1.5
"""Time [s] to close and come to rest."""
_SETTLE = 0.5
"""Time [s] for a cube between jaw and hand, without weight, to come to rest on both."""
_STEEP = 0.7
"""Cosine of the angle between gravity and the direction in which fingers close from which the cube would lie on one."""
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
    hand = grasp.fingers.hand
    simulation.place_cube(simulation.pose(hand) @ grasp.X_HC)
    if grasp.fingers.fixed:  # a jaw that comes from one side would knock a free cube away
        simulation.fix_cube(hand)
    targets: Mapping[str, float] = {**stage.targets(grasp.open), **dict.fromkeys(grasp.fingers.motors, grasp.closed)}
    simulation.command(targets)
    for _ in run(simulation, _CLOSE):
        gaps.measure(simulation)
    if grasp.fingers.fixed:
        simulation.free_cube()
        for _ in run(simulation, _SETTLE):
            gaps.measure(simulation)
    start = _in_fingers(simulation, grasp)
    simulation.let_go(_down(simulation.cube()))
    return start


def _down(X_WC: Pose) -> Array:
    """Direction (3,) of the cube's weight: downwards, or along its y axis where gravity would press it on a finger.

    A cube that lies on a finger is held without any force.
    """
    closing, across = X_WC.R[:, 0], X_WC.R[:, 1]
    return np.array(DOWN if abs(closing[2]) < _STEEP else across)


def _in_fingers(simulation: Simulation, grasp: Grasp) -> Array:
    """Position (3,) of the cube from the middle of the two fingers, in the frame of one; of a jaw, in the hand."""
    if grasp.fingers.fixed:
        return (simulation.pose(grasp.fingers.hand).inverse() @ simulation.cube()).p
    one, other = (simulation.pose(min(side)) for side in (grasp.fingers.one, grasp.fingers.other))
    middle = 0.5 * (one.p + other.p)
    return np.array(one.R.T @ (simulation.cube().p - middle))
