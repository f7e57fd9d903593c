"""Roll: a wheeled base drives straight ahead and back."""

from math import atan2, degrees, hypot

import numpy as np

from stepbot.engines.simulation import Simulation

from ..mechanism import Wheels
from ..results import Measure, Plot, Result, thinned
from ..stage import MM, Gaps, Stage, run, stand

_SETTLE = 0.5
_SECONDS = 2.0
"""Time [s] of each way."""
_STOP = 0.5
"""Time [s] at rest after each way."""
_SPEED = 0.3
"""Speed [m/s] of the base; less if the wheels cannot turn so fast."""
_SHARE = 0.5


def experiment(stage: Stage) -> Result:
    """Drive ahead and back at constant speed."""
    assert stage.wheels is not None
    wheels, root, gaps = stage.wheels, stage.mechanism.robot.root.name, Gaps(stage)
    times, path, tilts, clock = [], [], [], 0.0
    with stage.scene(floor=True) as simulation:
        stand(simulation, stage)
        radius = _radius(simulation, wheels)
        fastest = min(stage.motor(wheel.motor).limit.velocity for wheel in wheels.wheels)
        speed = min(_SPEED, _SHARE * fastest * radius)
        places = {}
        for name, sign, seconds in (
            ("start", 0.0, _SETTLE),
            ("ahead", 1.0, _SECONDS),
            ("there", 0.0, _STOP),
            ("back", -1.0, _SECONDS),
            ("end", 0.0, _STOP),
        ):
            spin = {wheel.motor: sign * wheel.forwards * speed / radius for wheel in wheels.wheels}
            simulation.command({**stage.home, **spin})
            for time in run(simulation, seconds):
                X_WR = simulation.pose(root)
                gaps.measure(simulation)
                times.append(clock + time)
                path.append(MM * float(X_WR.p @ np.array(wheels.direction)))
                tilts.append(degrees(atan2(hypot(X_WR.R[2, 0], X_WR.R[2, 1]), X_WR.R[2, 2])))
            clock = times[-1]
            places[name] = simulation.pose(root)
    start, there, end = (places[name] for name in ("start", "there", "end"))
    ahead = np.array(wheels.direction)
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
    curves = {"way ahead [mm]": thinned(times, path)}
    return Result("roll", measures, Plot("time [s]", "way [mm]", curves))


def _radius(simulation: Simulation, wheels: Wheels) -> float:
    """Radius [m] of the wheels: height of their axles above the floor that the robot stands on."""
    return float(np.mean([simulation.pose(wheel.link).position[2] for wheel in wheels.wheels]))
