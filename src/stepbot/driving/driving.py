"""Drives a robot that stepbot wrote, in all engines at the same time, each in a process of its own."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from typing import Any, cast

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import engine_of
from stepbot.engines.captured_output import printed
from stepbot.engines.file_references import openable
from stepbot.engines.simulation import Mechanism, Setup, Simulation
from stepbot.report.robot import robot_of_report
from stepbot.runtime.worker import RemoteError, Worker, WorkerDied

from .experiments.base import drop, stand
from .experiments.grip import grip
from .experiments.motors import hold, step, sweep, torque, track
from .experiments.wheels import roll, strafe, turn
from .judgement import Status, Verdict, judge, unmeasured
from .limits import Demands
from .mechanism import Wheels, finger_candidates, jaw_candidates, limbs_of, mechanism_of, wheels_of
from .plan import ENGINES, SURVEYOR, TESTS, reasons, ungripped
from .remedies import Facts, facts_of
from .results import Result
from .stage import Diverged, Stage
from .survey import Survey, SweptRange


class Assignment(Struct, frozen=True, eq=False):
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
        EngineCannotRead: It is known not to support it.
    """
    results: list[Result | str] = []
    with printed():
        for test in assignment.tests:
            stage = Stage(
                _opener(assignment), assignment.mechanism, assignment.survey, assignment.wheels, assignment.limbs
            )
            try:
                result = EXPERIMENTS[test](stage)
            except Diverged:
                results.append(test)
                continue
            results.append(replace(result, steps=stage.steps, seconds=stage.seconds))
    return tuple(results)


def _opener(assignment: Assignment) -> Callable[[Setup], Simulation]:
    file, mechanism = assignment.file, assignment.mechanism
    module = import_module(f"{engine_of(assignment.engine).package}.simulation")
    return lambda setup: cast(Simulation, module.SIMULATION(file, mechanism, setup))


EXPERIMENTS: Mapping[str, Callable[[Stage], Result]] = {
    one.__name__: one for one in (hold, step, track, sweep, torque, drop, grip, roll, turn, strafe, stand)
}
"""The function of each test."""
_DRIVE = "stepbot.driving.driving:drive"
_SURVEY = "stepbot.driving.survey:survey"


class Driven(Struct, frozen=True):
    """The drive tests of one robot."""

    robot: str
    verdicts: tuple[Verdict, ...] = ()
    inapplicable: Mapping[str, str] = field(default_factory=dict)
    """Tests that do not apply, each with its reason; ``grip of MOTOR`` where one gripper of several is not tested, and
    ``limit of QUANTITY in TEST`` where the robot's own limit was compared with nothing.
    """
    not_run: Mapping[str, str] = field(default_factory=dict)
    """Engines that have a file to drive and did not run, each with its reason."""
    ranges: tuple[SweptRange, ...] = ()
    """What the sweep of each bounded joint covers, if it was run."""


def drive_files(
    document: Mapping[str, Any],
    files: Mapping[str, Path],
    demands: Demands,
    diagnostics: Diagnostics,
    *,
    tests: Iterable[str] = (),
    timeout: float,
    memory_limit: int | None = None,
) -> Driven:
    """Drive a robot in engines.

    Args:
        document: The parsed ``report.json`` of the robot.
        files: For each engine the file that it drives.
        demands: Limits, and tests that must apply.
        diagnostics: Receives SB830, SB832 and SB835.
        tests: The tests to run; empty for all that apply.
        timeout: Time limit [s] of each engine.
        memory_limit: Address space [bytes] of each engine; None for no limit.

    Raises:
        KeyError, TypeError, ValueError: The document is not a report with a robot.
    """
    robot = robot_of_report(document)
    mechanism = mechanism_of(robot, tuple(document["robot"]["pybullet"]))
    drive = _Drive(mechanism, files, demands, diagnostics, timeout, memory_limit, facts_of(document, robot))
    survey = drive.survey()
    if survey is None:
        return Driven(robot.name)
    wheels, limbs = wheels_of(mechanism), limbs_of(mechanism)
    why = reasons(mechanism, survey, wheels, limbs, mjcf=SURVEYOR in files)
    wanted = tuple(tests)
    for test in dict.fromkeys((*wanted, *demands.tests)):
        if why[test]:
            diagnostics.add("SB835", f"{test}: {why[test]}", Span(drive.shown))
    chosen = tuple(test for test in TESTS if not why[test] and (not wanted or test in wanted))
    verdicts = drive.verdicts(
        {
            engine: Assignment(engine, str(openable(file)), mechanism, survey, wheels, limbs, chosen)
            for engine, file in files.items()
        }
    )
    inapplicable = {test: reason for test, reason in why.items() if reason} | dict(ungripped(survey))
    inapplicable |= unmeasured(demands, verdicts)
    return Driven(robot.name, verdicts, inapplicable, drive.not_run, survey.ranges if "sweep" in chosen else ())


class _Drive:
    """The workers of one robot."""

    def __init__(
        self,
        mechanism: Mechanism,
        files: Mapping[str, Path],
        demands: Demands,
        diagnostics: Diagnostics,
        timeout: float,
        memory_limit: int | None,
        facts: Facts,
    ) -> None:
        self._mechanism, self._files, self._demands, self._diagnostics = mechanism, files, demands, diagnostics
        self._timeout, self._memory_limit, self._facts = timeout, memory_limit, facts
        self.shown = next(iter(files.values())).name
        self.not_run: dict[str, str] = {}

    def survey(self) -> Survey | None:
        """The poses and grasps; None if MuJoCo cannot load the file."""
        file = str(openable(self._files[SURVEYOR])) if SURVEYOR in self._files else ""
        pairs = finger_candidates(self._mechanism)
        fingers = (*pairs, *jaw_candidates(self._mechanism, pairs))
        with Worker(_SURVEY, memory_limit=self._memory_limit) as worker:
            worker.submit(file, self._mechanism, fingers, self._demands.mass, self._demands.objects)
            survey: Survey | None = self._result(SURVEYOR, worker)
        if survey is not None:
            self._facts = replace(self._facts, overlaps=survey.overlaps)
        return survey

    def verdicts(self, assignments: Mapping[str, Assignment]) -> tuple[Verdict, ...]:
        """Run the tests in all engines at the same time."""
        with ExitStack() as running:
            workers = {
                name: running.enter_context(Worker(_DRIVE, memory_limit=self._memory_limit)).submit(assignment)
                for name, assignment in assignments.items()
            }
            return tuple(
                verdict
                for name, worker in workers.items()
                for verdict in self._judged(name, worker, assignments[name].tests)
            )

    def _judged(self, engine: str, worker: Worker, tests: Sequence[str]) -> list[Verdict]:
        results = self._result(engine, worker)
        if engine in self.not_run:
            return []
        if results is None:
            return [Verdict(engine, test, Status.FAILED, "the engine did not finish") for test in tests]
        return list(judge(engine, self._files[engine].name, results, self._demands, self._diagnostics, self._facts))

    def _result(self, engine: str, worker: Worker) -> Any:
        """The result of a worker; None after SB832, or where another engine drives what this one cannot read."""
        span = Span(self._files[engine].name if engine in self._files else self.shown)
        try:
            return worker.result(self._timeout)
        except RemoteError as error:
            if error.kind not in ("EngineRefused", "EngineCannotRead"):
                raise
            if error.kind == "EngineCannotRead" and len(self._files) > 1:
                self.not_run[engine] = error.text
            else:
                self._diagnostics.add("SB832", f"{engine}: {error.text}", span)
        except WorkerDied as death:
            self._diagnostics.add("SB832", f"{engine}: {death.reason}", span, notes=death.last_lines)
        return None


def missing_engines(names: Iterable[str]) -> dict[str, str]:
    """The engines that cannot run here, each with the reason."""
    reasons = {name: engine_of(name).available() for name in names}
    return {name: reason for name, reason in reasons.items() if reason is not None}


def report_missing_engines(missing: Mapping[str, str], diagnostics: Diagnostics) -> None:
    """Report engines that are needed and cannot run here (SB005).

    Args:
        missing: The engines, each with the reason.
        diagnostics: Receives SB005.
    """
    installed = [name for name in ENGINES if name not in missing_engines(ENGINES)]
    for name, reason in missing.items():
        others = (f"or drive in the installed engine: --engine {installed[0]}",) if installed else ()
        help = (engine_of(name).install or f"pip install {name}", *others)
        diagnostics.add("SB005", f"drive in {name}: {reason}", Span("stepbot"), help=help)
