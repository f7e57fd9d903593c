"""Tests of the whole robot: drop, roll, strafe and stand.

- `drop`: a floating robot falls on the floor with its motors at home; a fixed one falls limp, its motors off. Nothing
  adds energy to a limp robot: what its energy grows by comes from the simulation.
- `strafe`: a roller on the floor does not slip along its axis e: v . e = w R (f . e) for the base's velocity v, the
  wheel's speed w and radius R, and the direction f in which the wheel drives the base.
- `stand`: the push gives the robot half the speed at which a rigid block of its height and width would tip over.
"""

from collections.abc import Callable, Mapping
from math import atan2, degrees, hypot, sqrt

import numpy as np

from stepbot.engines.simulation import GRAVITY, Setup, Simulation
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import Base

from ..mechanism import Wheels
from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, place, run, tilt

_HEIGHT = 0.05
"""Height [m] of the fall."""
_FALL_SECONDS = 2.0
_LIMP_SECONDS = 1.0
_LAST = 0.25
"""Time [s] at the end in which a robot that fell or was pushed is to be at rest."""
_BEFORE_ROLLING = 0.5
_WAY_SECONDS = 2.0
"""Time [s] of each way."""
_STOP = 0.5
"""Time [s] at rest after each way."""
_SPEED = 0.3
"""Speed [m/s] of the base; less if the wheels cannot turn so fast."""
_WHEEL_SHARE = 0.5
"""Speed of the wheels, relative to the limit of the slowest."""
_BEFORE_PUSH = 1.5
"""Time [s] to stand before the push."""
_PUSH = 0.1
"""Time [s] of the push."""
_AFTER = 2.0
"""Time [s] after the push."""
_TIPPING_SHARE = 0.5
Spins = Callable[[Simulation, Wheels], Mapping[str, float]]
"""Speed of each wheel's motor, per speed of the base over the radius of the wheels."""


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


def _weight(stage: Stage) -> float:
    """Weight [N] of the robot."""
    return GRAVITY * exact_sum(link.mass_properties.mass for link in stage.mechanism.robot.links)


def _potential_scale(stage: Stage) -> float:
    """Energy [J] that lifting the moving links by a millimetre takes: the scale of a robot that does not fall."""
    return 1e-3 * max(1e-3, _weight(stage))


def roll(stage: Stage) -> Result:
    """Drive ahead and back at constant speed."""
    assert stage.wheels is not None
    return _drive(stage, "roll", stage.wheels.direction, lambda simulation, wheels: _forwards(wheels))


def _forwards(wheels: Wheels) -> Mapping[str, float]:
    return {wheel.motor: wheel.forwards for wheel in wheels.wheels}


def _drive(stage: Stage, test: str, direction: tuple[float, float, float], spins: Spins) -> Result:
    """Drive in a direction and back at constant speed.

    Args:
        test: Name of the test.
        direction: Unit vector in the root link.
        spins: The wheels' speeds for that direction.
    """
    assert stage.wheels is not None
    wheels, root, gaps = stage.wheels, stage.mechanism.robot.root.name, Gaps(stage)
    times, path, tilts, clock = [], [], [], 0.0
    with stage.scene(floor=True) as simulation:
        place(simulation, stage)
        radius = float(np.mean([simulation.pose(wheel.link).position[2] for wheel in wheels.wheels]))
        fastest = min(stage.motor(wheel.motor).limit.velocity for wheel in wheels.wheels)
        speed = min(_SPEED, _WHEEL_SHARE * fastest * radius)
        per_speed = spins(simulation, wheels)
        places = {}
        for name, sign, seconds in (
            ("start", 0.0, _BEFORE_ROLLING),
            ("ahead", 1.0, _WAY_SECONDS),
            ("there", 0.0, _STOP),
            ("back", -1.0, _WAY_SECONDS),
            ("end", 0.0, _STOP),
        ):
            spin = {motor: sign * turn * speed / radius for motor, turn in per_speed.items()}
            simulation.command({**stage.home, **spin})
            for time in run(simulation, seconds):
                X_WR = simulation.pose(root)
                gaps.measure(simulation)
                times.append(clock + time)
                path.append(MM * float(X_WR.p @ np.array(direction)))
                tilts.append(tilt(X_WR))
            clock = times[-1]
            places[name] = simulation.pose(root)
    start, there, end = (places[name] for name in ("start", "there", "end"))
    ahead = np.array(direction)
    side = np.cross((0.0, 0.0, 1.0), ahead)
    gone, back = start.R.T @ (there.p - start.p), start.R.T @ (end.p - start.p)
    expected = speed * _WAY_SECONDS
    turned = start.R.T @ there.R
    measures = (
        Measure("distance error", 100.0 * abs(float(gone @ ahead) / expected - 1.0)),
        Measure("sideways", MM * abs(float(gone @ side))),
        Measure("heading", abs(degrees(atan2(turned[1, 0], turned[0, 0])))),
        Measure("return error", MM * float(np.linalg.norm(back[:2]))),
        Measure("tilt", max(tilts)),
        *gaps.measures(),
    )
    curves = {"way [mm]": thinned(times, path)}
    return Result(test, measures, Plot("time [s]", "way [mm]", curves))


def strafe(stage: Stage) -> Result:
    """Drive to the left and back at constant speed."""
    assert stage.wheels is not None
    left = np.cross((0.0, 0.0, 1.0), stage.wheels.direction)
    direction = (float(left[0]), float(left[1]), float(left[2]))
    robot = stage.mechanism.robot

    def spins(simulation: Simulation, wheels: Wheels) -> Mapping[str, float]:
        # Speed of each wheel's motor per speed of the base over the radius, from the roller nearest to the floor.
        found = {}
        for wheel, rollers in zip(wheels.wheels, wheels.rollers, strict=True):
            joints = [robot.joint_by_name[name] for name in rollers]
            lowest = min(joints, key=lambda joint: simulation.pose(joint.child).position[2])
            axis = simulation.pose(lowest.child).turn(lowest.axis)
            found[wheel.motor] = wheel.forwards * float(axis @ direction) / float(axis @ wheels.direction)
        return found

    return _drive(stage, "strafe", direction, spins)


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
