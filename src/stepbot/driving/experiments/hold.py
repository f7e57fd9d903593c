"""Hold: placed at random poses, the motors keep the robot there."""

from stepbot.robot.model import ActuatorKind

from ..results import Measure, Plot, Result, thinned
from ..stage import Gaps, Stage, by_gains, by_kind, run

_SECONDS = 1.5
_LAST = 0.25
"""Time [s] at the end in which the robot is to be at rest."""


def experiment(stage: Stage) -> Result:
    """Hold every pose of the survey."""
    servos = stage.motors(ActuatorKind.POSITION)
    errors = dict.fromkeys(servos, 0.0)
    drifts = dict.fromkeys(servos, 0.0)
    gaps, curves = Gaps(stage), {}
    with stage.scene(held=True) as simulation:
        for number, q in enumerate(stage.survey.poses, 1):
            simulation.reset(q)
            simulation.command(stage.targets(q))
            times, worst, last = [], [], []
            for time in run(simulation, _SECONDS):
                gaps.measure(simulation)
                now = simulation.positions()
                times.append(time)
                worst.append(max((abs(now[motor.joint] - q[motor.joint]) for motor in servos), default=0.0))
                if time > _SECONDS - _LAST:
                    last.append(now)
            for motor in servos:
                seen = [now[motor.joint] for now in last]
                errors[motor] = max(errors[motor], abs(seen[-1] - q[motor.joint]))
                drifts[motor] = max(drifts[motor], max(seen) - min(seen))
            curves[f"pose {number}"] = thinned(times, worst)
    turning = by_gains({motor: error for motor, error in errors.items() if motor.angular}, "angle error")
    travel = by_kind({motor: error for motor, error in errors.items() if not motor.angular}, "", "travel error")
    measures = (*turning, *travel, *by_kind(drifts, "angle drift", "travel drift"))
    measures = (*measures, Measure("poses", float(len(stage.survey.poses))), *gaps.measures())
    return Result("hold", measures, Plot("time [s]", "largest error [rad, m]", curves))
