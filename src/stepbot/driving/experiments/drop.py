"""Drop: a floating robot falls on the floor with its motors at home; a fixed one falls limp, its motors off.

Nothing adds energy to a limp robot: what its energy grows by comes from the simulation.
"""

from stepbot.engines.simulation import GRAVITY, Setup
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import Base

from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, run, stand

_HEIGHT = 0.05
"""Height [m] of the fall."""
_SECONDS = 2.0
_LIMP_SECONDS = 1.0
_LAST = 0.25
"""Time [s] at the end in which the robot is to be at rest."""


def experiment(stage: Stage) -> Result:
    """Drop a floating robot, let a fixed one fall limp."""
    return _fall(stage) if stage.mechanism.robot.base is Base.FLOATING else _limp(stage)


def _fall(stage: Stage) -> Result:
    root, gaps = stage.mechanism.robot.root.name, Gaps(stage)
    times, heights, energies, depth = [], [], [], 0.0
    with stage.scene(floor=True) as simulation:
        stand(simulation, stage, _HEIGHT)
        simulation.command(stage.home)
        before = exact_sum(simulation.energy())
        for time in run(simulation, _SECONDS):
            gaps.measure(simulation)
            times.append(time)
            heights.append(MM * simulation.pose(root).position[2])
            energies.append(exact_sum(simulation.energy()) - before)
            if time > _SECONDS - _LAST:
                depth = max(depth, MM * simulation.penetration())
    rest = [height for time, height in zip(times, heights, strict=True) if time > _SECONDS - _LAST]
    fallen = stage_weight(stage) * _HEIGHT
    measures = (
        Measure("energy gain", 100.0 * max(0.0, *energies) / fallen),
        Measure("penetration", depth),
        Measure("height drift", max(rest) - min(rest)),
        *gaps.measures(),
    )
    curves = {"height of the root [mm]": thinned(times, heights)}
    return Result("drop", measures, Plot("time [s]", "height [mm]", curves))


def _limp(stage: Stage) -> Result:
    gaps, times, energies, scale = Gaps(stage), [], [], _potential_scale(stage)
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


def stage_weight(stage: Stage) -> float:
    """Weight [N] of the robot."""
    return GRAVITY * exact_sum(link.mass_properties.mass for link in stage.mechanism.robot.links)


def _potential_scale(stage: Stage) -> float:
    """Energy [J] that lifting the moving links by a millimetre takes: the scale of a robot that does not fall."""
    return 1e-3 * max(1e-3, stage_weight(stage))
