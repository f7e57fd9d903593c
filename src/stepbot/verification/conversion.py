"""Compares written files with the robot that they were written from."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import engine_of
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.engines.reference import Reference
from stepbot.engines.workers import Engines, Fate, ObservationCache, Outcome, check_required, check_started
from stepbot.report.robot import Check, Report, Status
from stepbot.robot.closures import DoesNotClose, degrees_of_freedom, driven_joints
from stepbot.robot.model import Robot
from stepbot.runtime.fork_server import ForkServer
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import RemoteError, WorkerDied

from .compare import compare
from .expectation import mechanism, requests
from .judging import Subject, checks_without_observation, judged, report_of, report_unread
from .modules import ModuleAlone, as_alone
from .self_collision.search import Overlap
from .self_collision.shapes import available
from .self_collision.worker import Collider

ENGINE_WARNING = "SB812"
WIDE_OPEN = 1e-6
"""Gap [m] of a loop over its range, for the CAD's accuracy, above which it is reported."""


class Written(Struct, frozen=True):
    """A file that was written."""

    path: Path
    robot: Robot
    """The robot as the format expresses it, from :func:`stepbot.formats.lowering.lower`."""
    modules: tuple[tuple[ModuleAlone, Robot], ...] = ()
    """The modules that the robot is composed of, and the robot of each, alone, as the format expresses it."""


class Provers:
    """The processes that will check the files: started early, to import in parallel with the conversion."""

    def __init__(
        self, formats: Iterable[str], *, memory_limit: int | None = None, server: ForkServer | None = None
    ) -> None:
        """Start them.

        Args:
            memory_limit: Address space [bytes] of each; None for no limit.
            server: Starts them, and ends with them; None to start each separately.
        """
        files = {name: name for name in formats}
        self._server = server
        start = server.fork if server is not None else None
        self.engines = Engines(files, memory_limit, start)
        self.collider = Collider(memory_limit, start) if files and available() is None else None

    def close(self) -> None:
        """End all processes that still run."""
        if self._server is not None:
            self._server.close()
        self.engines.close()
        if self.collider is not None:
            self.collider.close()

    def __enter__(self) -> "Provers":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def verify(
    robot: Robot,
    written: Mapping[str, Written],
    provers: Provers,
    diagnostics: Diagnostics,
    *,
    require: Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    observations: ObservationCache | None = None,
) -> Report:
    """Verify that the written files match the robot; a failure is a diagnostic, and a failed check of the report.

    Args:
        written: The main file of each format.
        provers: Processes, started for these formats.
        require: Engines whose absence is an error.
        timeout: Time limit [s] of each engine.
    """
    required = tuple(require)
    check_required(required, diagnostics)
    try:
        asked = requests(
            robot, {name: one.robot for name, one in written.items()}, {name: one.path for name, one in written.items()}
        )
    except DoesNotClose as error:
        return _open_loop(robot, error, diagnostics)
    provers.engines.start({name: name for name in written})
    provers.engines.submit(asked, observations)
    if provers.collider is not None:
        provers.collider.submit(robot, observations.cache if observations is not None else None)
    # The reference is computed while the engines are running.
    reference = Reference()
    expected = {name: reference.observe(_expected(robot, one.robot), asked[name]) for name, one in written.items()}
    freedom = degrees_of_freedom(robot)
    _check_loops(robot, freedom, expected.values(), diagnostics)
    outcomes: list[Outcome] = []
    checks: list[Check] = []
    differences = Diagnostics()
    for outcome in provers.engines.results(timeout):  # compared while the other engines are still running
        subject = Subject(written[outcome.key].path.name, outcome.format, outcome.engine)
        checks += _checks(subject, expected[outcome.key], outcome, differences)
        checks += _checks_of_modules(subject, written[outcome.key], asked[outcome.key], reference, outcome, differences)
        outcomes.append(outcome)
    check_started(required, outcomes, diagnostics)
    for key, one in written.items():
        _check_read(one.path.name, [outcome for outcome in outcomes if outcome.key == key], diagnostics)
    diagnostics.extend(difference.after("convert") for difference in differences)
    overlaps, collision_check = _self_collision(robot, provers, timeout, diagnostics)
    return report_of(
        (*checks, collision_check),
        outcomes,
        {key: one.path.name for key, one in written.items()},
        robot=robot,
        degrees_of_freedom=freedom,
        driven=driven_joints(robot) if robot.closures else (),
        collisions=overlaps,
        initial_penetrations=tuple(
            sorted({pair for one in outcomes if one.observation for pair in one.observation.initial_penetrations})
        ),
    )


def _check_read(file: str, outcomes: list[Outcome], diagnostics: Diagnostics) -> None:
    """Warn of a file that no installed engine reads, unless most installations lack all of its engines."""
    usual = any(not engine_of(outcome.engine).optional for outcome in outcomes)
    if usual and all(outcome.fate is Fate.ABSENT for outcome in outcomes):
        report_unread(file, outcomes, diagnostics)


def _open_loop(robot: Robot, error: DoesNotClose, diagnostics: Diagnostics) -> Report:
    """The report of a robot whose loops do not close as drawn: there is no mechanism for engines to check."""
    message = f"{error} in the drawn pose"
    diagnostics.add("SB808", message, Span(robot.source or robot.name))
    return Report((Check("", "", "stepbot", Quantity.CLOSURES.value, Status.FAILED, why=message),), robot=robot)


def _check_loops(robot: Robot, freedom: int, expected: Iterable[Observation], diagnostics: Diagnostics) -> None:
    """Warn of loops that cannot move, and of loops that do not stay closed when they do."""
    span = Span(robot.source or robot.name)
    if robot.closures and freedom == 0:
        diagnostics.add("SB819", "the closures leave no degree of freedom in the drawn pose", span)
    widest: dict[str, float] = {}
    for closure in (closure for observation in expected for closure in observation.closures or ()):
        widest[closure.name] = max(widest.get(closure.name, 0.0), closure.residual or 0.0)
    for name, gap in widest.items():
        if gap > WIDE_OPEN:
            message = f"closure '{name}' opens by up to {gap:.2g} m over its range"
            diagnostics.add("SB818", message, span)


def _expected(robot: Robot, lowered: Robot) -> Robot:
    """The expected content of the file: the lowered robot, and the loops that engines close."""
    return replace(mechanism(robot, lowered), actuators=lowered.actuators)


def _checks(subject: Subject, expected: Observation, outcome: Outcome, diagnostics: Diagnostics) -> list[Check]:
    if outcome.observation is None:
        quantities = [compared.quantity for compared in compare(expected, expected)]
        return checks_without_observation(subject, outcome, quantities, diagnostics)
    return [judged(subject, one, diagnostics, ENGINE_WARNING) for one in compare(expected, outcome.observation)]


def _checks_of_modules(
    subject: Subject,
    written: Written,
    request: Request,
    reference: Reference,
    outcome: Outcome,
    diagnostics: Diagnostics,
) -> Iterator[Check]:
    """What an engine reports of each module, against the module alone."""
    if outcome.observation is None:
        return
    for one, lowered in written.modules:
        of_module = replace(subject, against=one.against)
        for compared in as_alone(one, lowered, written.robot, outcome.observation, request, reference):
            yield judged(of_module, compared, diagnostics)


def _self_collision(
    robot: Robot, provers: Provers, timeout: float, diagnostics: Diagnostics
) -> tuple[tuple[Overlap, ...], Check]:
    """Overlapping links of the robot itself; they are listed with a warning, and do not fail the files."""
    span, engine, quantity = Span(robot.source or robot.name), "python-fcl", Quantity.SELF_COLLISION.value
    if provers.collider is None:
        return (), Check("", "", engine, quantity, Status.NOT_RUN, why=available() or "")
    try:
        overlaps = provers.collider.result(timeout)
    except (WorkerDied, RemoteError) as error:
        lines = getattr(error, "last_lines", ())
        diagnostics.add("SB817", f"self-collision: {str(error).splitlines()[0]}", span, notes=lines)
        return (), Check("", "", engine, quantity, Status.NOT_RUN, why=str(error).splitlines()[0])
    reported = frozenset(map(frozenset, robot.excluded_contacts))
    if robot.self_collision is not None:
        reported |= robot.self_collision.excluded  # with SB620
    for a, b, depth in (overlap for overlap in overlaps if frozenset(overlap[:2]) not in reported):
        deep = "" if depth is None else f" by {depth * 1e3:.3g} mm"
        diagnostics.add("SB810", f"links '{a}' and '{b}' overlap{deep} in the drawn pose", span)
    pairs = "; ".join(f"'{a}' and '{b}' overlap" for a, b, _ in overlaps)
    return overlaps, Check("", "", engine, quantity, Status.PASSED, why=pairs)
