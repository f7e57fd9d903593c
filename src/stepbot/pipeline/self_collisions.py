"""Which links of a robot can overlap: searched in a worker process, for a conversion or for its own sake."""

from collections.abc import Set

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import Robot
from stepbot.robot.self_collision import PairClass, PairContact, SelfCollision
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.sidecar.settings import SelfCollisionSection
from stepbot.verification.self_collision.shapes import available
from stepbot.verification.self_collision.worker import find_self_collision

from .conversion import Options


def with_self_collision(
    robot: Robot, section: SelfCollisionSection, options: Options, diagnostics: Diagnostics, *, keep_some: bool = False
) -> Robot:
    """The robot with the pairs of links that can overlap; pairs that always do are reported.

    Args:
        keep_some: Exclude pairs that never overlap only if others do sometimes. MJX 3.17 cannot step without contacts.

    Raises:
        StepbotError: The search failed, or the loops do not close.
    """
    span = Span(robot.source or robot.name)
    if reason := available():
        diagnostics.add("SB817", f"self-collision: {reason}", span)
        return robot
    try:
        searched = find_self_collision(robot, section.samples, options.cache, options.workers)
    except WorkerDied as death:
        diagnostics.add("SB817", f"self-collision: {death.reason}", span, notes=death.last_lines)
        return robot
    except RemoteError as error:
        if error.kind != "DoesNotClose":
            raise
        diagnostics.add("SB808", f"{error.text} in the drawn pose", span)
        diagnostics.raise_if_errors()
        return robot
    exclude = tuple(PairClass(kind.value) for kind in dict.fromkeys(section.exclude))
    if keep_some and not searched.of_class(PairClass.SOMETIMES):
        exclude = tuple(kind for kind in exclude if kind is not PairClass.NEVER)
    searched = replace(searched, exclude=exclude)
    _report(searched, section.samples, frozenset(map(frozenset, robot.excluded_contacts)), span, diagnostics)
    return replace(robot, self_collision=searched)


def _report(
    searched: SelfCollision, wanted: int, stated: Set[frozenset[str]], span: Span, diagnostics: Diagnostics
) -> None:
    """Report missing samples, and pairs that always overlap, except those that somebody has excluded."""
    if searched.samples < wanted:
        diagnostics.add("SB621", f"self-collision searched in {searched.samples:,} of {wanted:,} poses", span)
    for pair in (one for one in searched.of_class(PairClass.ALWAYS) if one.links not in stated):
        poses = "the drawn pose" if searched.samples == 1 else f"all {searched.samples:,} poses"
        excluded = "; their contacts are excluded" if PairClass.ALWAYS in searched.exclude else ""
        drawn = f",{by_depth(pair)} as drawn" if pair.depth is not None else ""
        message = f"links '{pair.link_a}' and '{pair.link_b}' overlap in {poses}{drawn}{excluded}"
        diagnostics.add("SB620", message, span)


def by_depth(pair: PairContact) -> str:
    """How deep two links overlap, in words; empty if they have no depth."""
    return "" if pair.depth is None else f" by {pair.depth * 1e3:.3g} mm"
