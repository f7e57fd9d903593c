"""Which links of a robot can overlap: searched in a worker process, for a conversion or for its own sake."""

from collections.abc import Callable, Set
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Ignore, Span, StepbotError
from stepbot.robot.model import Robot
from stepbot.robot.self_collision import PairClass, PairContact, SelfCollision
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.sidecar.self_collision import SelfCollisionSection
from stepbot.verification.self_collision.shapes import available
from stepbot.verification.self_collision.worker import find_self_collision

from .building import build
from .conversion import Options
from .describing import described_robot
from .loading import Loading
from .sidecars import SIDECAR_SUFFIXES, load, named_step, what_to_read


def search(
    target: Path, samples: int | None, options: Options, found: Diagnostics, progress: Callable[[str], None]
) -> Robot | None:
    """The robot of a sidecar, or of a URDF, SDFormat or MJCF, with the links that can overlap; None after an error.

    Args:
        target: The sidecar, or the description.
        samples: Number of poses; None for the sidecar's, or the default.
        options: Cache and limits.
        found: Receives the diagnostics.
        progress: Called at the start of each stage.
    """
    found.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    wanted: SelfCollisionSection | None = None
    try:
        if target.suffix.lower() in SIDECAR_SUFFIXES:
            robot, wanted = _built(target, options, found)
        else:
            described = described_robot(target, options, found, drawn=False)
            if described is None:
                return None
            robot = described
        progress("self-collision")
        wanted = wanted or SelfCollisionSection()
        if samples is not None:
            wanted = wanted.model_copy(update={"samples": samples})
        robot = with_self_collision(robot, wanted, options, found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return None
    stated = set(map(frozenset, robot.excluded_contacts))
    for pair in robot.self_collision.of_class(PairClass.SOMETIMES) if robot.self_collision else ():
        if pair.first == 0 and pair.links not in stated:
            message = f"links '{pair.link_a}' and '{pair.link_b}' overlap{_by(pair)} in the drawn pose"
            found.add("SB810", message, Span(robot.source or robot.name))
    return None if robot.self_collision is None else robot


def _built(path: Path, options: Options, found: Diagnostics) -> tuple[Robot, SelfCollisionSection | None]:
    """The robot of a sidecar, and what the sidecar requests.

    Raises:
        StepbotError: There are errors.
    """
    sidecar = load(path, options, found)
    with closing(Loading(named_step(sidecar, found), what_to_read(sidecar, options), options, found)) as loading:
        built = build(sidecar, loading.assembly(found), loading, options, found)
        found.raise_if_errors()
        assert built is not None  # a missing robot always has an error
        built.double_counting.report(options.timeout)
    return built.robot, sidecar.document.self_collision


def with_self_collision(robot: Robot, wanted: SelfCollisionSection, options: Options, found: Diagnostics) -> Robot:
    """The robot with the pairs of links that can overlap; pairs that always do are reported.

    Raises:
        StepbotError: The search failed, or the loops do not close.
    """
    span = Span(robot.source or robot.name)
    if reason := available():
        found.add("SB817", f"self-collision: {reason}", span)
        return robot
    try:
        searched = find_self_collision(
            robot, wanted.samples, options.cache, timeout=options.timeout, memory_limit=options.memory_limit
        )
    except WorkerDied as death:
        found.add("SB817", f"self-collision: {death.reason}", span, notes=death.last_lines)
        return robot
    except RemoteError as error:
        if error.kind != "DoesNotClose":
            raise
        found.add("SB808", f"{error.text} in the drawn pose", span)
        found.raise_if_errors()
        return robot
    exclude = tuple(PairClass(kind.value) for kind in dict.fromkeys(wanted.exclude))
    searched = replace(searched, exclude=exclude)
    _report(searched, wanted.samples, frozenset(map(frozenset, robot.excluded_contacts)), span, found)
    return replace(robot, self_collision=searched)


def _report(searched: SelfCollision, wanted: int, stated: Set[frozenset[str]], span: Span, found: Diagnostics) -> None:
    """Report missing samples, and pairs that always overlap, except those that somebody has excluded."""
    if searched.samples < wanted:
        found.add("SB621", f"self-collision searched in {searched.samples:,} of {wanted:,} poses", span)
    for pair in (one for one in searched.of_class(PairClass.ALWAYS) if one.links not in stated):
        poses = "the drawn pose" if searched.samples == 1 else f"all {searched.samples:,} poses"
        excluded = "; their contacts are excluded" if PairClass.ALWAYS in searched.exclude else ""
        drawn = f",{_by(pair)} as drawn" if pair.depth is not None else ""
        message = f"links '{pair.link_a}' and '{pair.link_b}' overlap in {poses}{drawn}{excluded}"
        found.add("SB620", message, span)


def _by(pair: PairContact) -> str:
    return "" if pair.depth is None else f" by {pair.depth * 1e3:.3g} mm"
