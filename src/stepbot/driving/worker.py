"""Runs the drive tests of one robot in one engine; in a worker process."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module

from stepbot.engines.captured_output import printed
from stepbot.engines.simulation import Mechanism, Setup, Simulation

from .mechanism import Wheels
from .results import Result
from .stage import Diverged, Stage
from .survey import Survey


@dataclass(frozen=True, eq=False)
class Assignment:
    """The tests of one robot in one engine."""

    engine: str
    file: str
    mechanism: Mechanism
    survey: Survey
    wheels: Wheels | None
    limbs: tuple[str, ...]
    tests: tuple[str, ...]


def drive(assignment: Assignment) -> tuple[Result | str, ...]:
    """The result of each test, or the name of a test in which the simulation diverged.

    Raises:
        EngineRefused: The engine does not load the file.
    """
    results: list[Result | str] = []
    with printed():
        for test in assignment.tests:
            stage = Stage(
                _opener(assignment), assignment.mechanism, assignment.survey, assignment.wheels, assignment.limbs
            )
            experiment: Callable[[Stage], Result] = import_module(f".experiments.{test}", __package__).experiment
            try:
                result = experiment(stage)
            except Diverged:
                results.append(test)
                continue
            results.append(replace(result, steps=stage.steps, seconds=stage.seconds))
    return tuple(results)


def _opener(assignment: Assignment) -> Callable[[Setup], Simulation]:
    file, mechanism = assignment.file, assignment.mechanism
    if assignment.engine == "mujoco":
        from stepbot.engines.mujoco.simulation import MujocoSimulation

        return lambda setup: MujocoSimulation(file, mechanism, setup)
    from stepbot.engines.pybullet.simulation import PybulletSimulation

    return lambda setup: PybulletSimulation(file, mechanism, setup)
