"""Step: each motor gets a new target, one after the other."""

from stepbot.engines.simulation import Motor, Simulation
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import ActuatorKind

from ..results import Measure, Plot, Result, Series, largest, thinned
from ..stage import Gaps, Speeds, Stage, by_gains, by_kind, run
from ..survey import Move

_SETTLE = 0.5
"""Time [s] at home before the step."""
_SECONDS = 1.5
_LAST = 0.25
"""Time [s] at the end that the response is compared with."""
_SPEED_SHARE = 0.5
"""Step of a velocity motor, relative to its limit."""
_SPEED = 1.0
"""Step [rad/s], [m/s] of a velocity motor without a limit."""


def experiment(stage: Stage) -> Result:
    """Step every position motor, and every velocity motor that does not drive a wheel."""
    gaps, curves = Gaps(stage), {}
    overshoots: dict[Motor, float] = {}
    errors: dict[Motor, float] = {}
    drive = _Drive(stage, gaps)
    with stage.scene(held=True) as simulation:
        for move in stage.survey.steps:
            motor = stage.motor(move.motor)
            overshoot, error, curve = drive.step(simulation, motor, move)
            overshoots[motor], errors[motor], curves[motor.joint] = overshoot, error, curve
        speed_errors = {}
        for motor in _spinning(stage):
            overshoot, error, curve = drive.spin(simulation, motor)
            overshoots[motor], speed_errors[motor.joint], curves[motor.joint] = overshoot, error, curve
    measures: tuple[Measure, ...] = (
        *by_gains(overshoots, "overshoot"),
        *by_kind(errors, "angle error", "travel error"),
    )
    measures = (*measures, *largest("speed error", speed_errors), *drive.speeds.measures(), *gaps.measures())
    return Result("step", measures, Plot("time [s]", "response, 1 = commanded", curves))


def _spinning(stage: Stage) -> list[Motor]:
    wheels = {wheel.motor for wheel in stage.wheels.wheels} if stage.wheels else set()
    return [motor for motor in stage.motors(ActuatorKind.VELOCITY) if motor.name not in wheels]


class _Drive:
    def __init__(self, stage: Stage, gaps: Gaps) -> None:
        self._stage, self._gaps, self.speeds = stage, gaps, Speeds(stage.mechanism.robot)

    def step(self, simulation: Simulation, motor: Motor, move: Move) -> tuple[float, float, Series]:
        """Overshoot [%], final error [rad] or [m], and the response."""
        simulation.reset(self._stage.mechanism.home)
        targets = self._stage.home
        simulation.command(targets)
        for _ in run(simulation, _SETTLE):
            self._gaps.measure(simulation)
        (end,) = move.ends
        start = simulation.positions()[motor.joint]
        simulation.command({**targets, motor.name: end})
        times, q = [], []
        for time in run(simulation, _SECONDS):
            self._gaps.measure(simulation)
            self.speeds.measure(simulation, motor)
            times.append(time)
            q.append(simulation.positions()[motor.joint])
        size = end - self._stage.mechanism.home[motor.joint]
        last = [value for time, value in zip(times, q, strict=True) if time > _SECONDS - _LAST]
        final = exact_sum(last) / len(last)
        beyond = max((value - final) / size for value in q)
        return 100.0 * max(0.0, beyond), abs(final - end), thinned(times, [(value - start) / size for value in q])

    def spin(self, simulation: Simulation, motor: Motor) -> tuple[float, float, Series]:
        """Overshoot [%], final error [%], and the response in speed."""
        simulation.reset(self._stage.mechanism.home)
        fastest = motor.limit.velocity
        goal = _SPEED_SHARE * fastest if fastest < 1e6 else _SPEED
        simulation.command({**self._stage.home, motor.name: goal})
        times, speeds = [], []
        for time in run(simulation, _SECONDS):
            self._gaps.measure(simulation)
            times.append(time)
            speeds.append(self.speeds.measure(simulation, motor))
        last = [speed for time, speed in zip(times, speeds, strict=True) if time > 0.5 * _SECONDS]
        final = exact_sum(last) / len(last)
        beyond = max(speed - final for speed in speeds) / abs(goal)
        error = abs(final - goal) / abs(goal)
        return 100.0 * max(0.0, beyond), 100.0 * error, thinned(times, [speed / goal for speed in speeds])
