"""Roll: a wheeled base drives straight ahead and back. Strafe, in :mod:`.strafe`, is the same to the left."""

from collections.abc import Callable, Mapping
from math import atan2, degrees

import numpy as np

from stepbot.engines.simulation import Simulation

from ..mechanism import Wheels
from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, run, stand, tilt

_SETTLE = 0.5
_SECONDS = 2.0
"""Time [s] of each way."""
_STOP = 0.5
"""Time [s] at rest after each way."""
_SPEED = 0.3
"""Speed [m/s] of the base; less if the wheels cannot turn so fast."""
_SHARE = 0.5


Spins = Callable[[Simulation, Wheels], Mapping[str, float]]
"""Speed of each wheel's motor, per speed of the base over the radius of the wheels."""


def experiment(stage: Stage) -> Result:
    """Drive ahead and back at constant speed."""
    assert stage.wheels is not None
    return drive(stage, "roll", stage.wheels.direction, lambda simulation, wheels: _forwards(wheels))


def _forwards(wheels: Wheels) -> Mapping[str, float]:
    return {wheel.motor: wheel.forwards for wheel in wheels.wheels}


def drive(stage: Stage, test: str, direction: tuple[float, float, float], spins: Spins) -> Result:
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
        stand(simulation, stage)
        radius = float(np.mean([simulation.pose(wheel.link).position[2] for wheel in wheels.wheels]))
        fastest = min(stage.motor(wheel.motor).limit.velocity for wheel in wheels.wheels)
        speed = min(_SPEED, _SHARE * fastest * radius)
        per_speed = spins(simulation, wheels)
        places = {}
        for name, sign, seconds in (
            ("start", 0.0, _SETTLE),
            ("ahead", 1.0, _SECONDS),
            ("there", 0.0, _STOP),
            ("back", -1.0, _SECONDS),
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
    expected = speed * _SECONDS
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
