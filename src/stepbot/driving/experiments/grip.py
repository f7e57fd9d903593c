"""Grip: fingers, or a jaw and its hand, close on a cube without weight, which then gets its weight.

In place of the cube, limits of a robot can name other objects: cubes of other sizes, cylinders, spheres.
"""

from math import cos, isfinite, pi, sqrt

import numpy as np
from msgspec.structs import replace

from stepbot.engines.simulation import DOWN, GRAVITY, Setup, Simulation
from stepbot.geometry.spatial import Array, Pose

from ..grasping import Grasp
from ..results import Grip, Loss, Plot, Result, Series, largest, thinned
from ..stage import MM, Gaps, Stage, cruising_speed, run

_CLOSE = 1.5
"""Time [s] to press and come to rest, after the target has reached the closed position."""
_SETTLE = 0.5
"""Time [s] for a cube between jaw and hand, without weight, to come to rest on both."""
_STEEP = 0.7
"""Cosine of the angle between gravity and the direction in which fingers close from which the cube would lie on one."""
_LOST = 2.0
"""Way of the cube, relative to its edge, from which it is out of the grip."""
_FREELY = 1.2
"""Time in which a cube is lost, relative to that of a free fall, up to which nothing has held it."""
SECONDS = 5.0
"""Time [s] for which the cube is held."""


def grip(stage: Stage) -> Result:
    """Grip with every gripper, one after the other."""
    gaps, curves = Gaps(stage), {}
    grips: list[Grip] = []
    depths = {}
    for grasp in stage.survey.grasps:
        with stage.scene(setup=Setup(held=True, cube=grasp.cube)) as simulation:
            motor = stage.motor(grasp.fingers.motors[0])
            _close(stage, simulation, grasp, gaps)
            effort = abs(simulation.effort(motor.joint)) / motor.limit.effort
            held = Grip(
                motor.joint,
                grasp.fingers.one | grasp.fingers.other,
                grasp.cube,
                grasp.gaps,
                slip=0.0,
                effort=effort if isfinite(motor.limit.effort) else None,
            )
            held, curve = _held(simulation, grasp, gaps, held)
            grips.append(held)
            where = f"{motor.joint}, {grasp.cube}"
            curves[where], depths[where] = curve, MM * simulation.penetration()
    slips = {f"{one.joint}, {one.cube}": one.slip for one in grips}
    measures = (*largest("slip", slips), *largest("penetration", depths), *gaps.measures())
    return Result("grip", measures, Plot("time [s]", "slip [mm]", curves), tuple(grips))


def _held(simulation: Simulation, grasp: Grasp, gaps: Gaps, grip: Grip) -> tuple[Grip, Series]:
    """Let the cube have its weight until it is lost, or the time is over."""
    lost = _LOST * grasp.cube.edge
    start = _in_fingers(simulation, grasp)
    away = simulation.pose(grasp.fingers.hand).inverse() @ simulation.cube()
    pushed = float(np.linalg.norm(away.p - grasp.X_HC.p))
    if pushed > lost:
        return replace(grip, slip=MM * pushed, loss=Loss.PUSHED), ((0.0,), (MM * pushed,))
    simulation.let_go(_down(simulation.cube()))
    times, slips = [], []
    for time in run(simulation, SECONDS):
        gaps.measure(simulation)
        times.append(time)
        slips.append(MM * float(np.linalg.norm(_in_fingers(simulation, grasp) - start)))
        if slips[-1] > MM * lost:
            freely = time < _FREELY * sqrt(2.0 * lost / GRAVITY)
            grip = replace(grip, loss=Loss.FREE if freely else Loss.SLIPPED, seconds=time)
            break
    return replace(grip, slip=max(slips)), thinned(times, slips)


def _close(stage: Stage, simulation: Simulation, grasp: Grasp, gaps: Gaps) -> None:
    """Close the fingers on the cube, at the speed at which a robot closes them.

    A target that is at the closed position at once would let a light jaw with a strong motor leap through the cube.
    """
    simulation.reset(grasp.open)
    hand = grasp.fingers.hand
    simulation.place_cube(simulation.pose(hand) @ grasp.X_HC)
    if grasp.fingers.fixed:  # a jaw that comes from one side would knock a free cube away
        simulation.fix_cube(hand)
    targets = stage.targets(grasp.open)
    motors = [stage.motor(name) for name in grasp.fingers.motors]
    ways = {motor.name: grasp.closed - grasp.open[motor.joint] for motor in motors}
    seconds = max(0.5 * pi * abs(ways[motor.name]) / cruising_speed(motor) for motor in motors)
    for time in run(simulation, seconds + _CLOSE):
        rest = 0.5 * (1.0 + cos(pi * min(1.0, time / seconds)))
        simulation.command({**targets, **{name: grasp.closed - rest * way for name, way in ways.items()}})
        gaps.measure(simulation)
    if grasp.fingers.fixed:
        simulation.free_cube()
        for _ in run(simulation, _SETTLE):
            gaps.measure(simulation)


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
