"""Which links of a sidecar's or a description's robot can overlap, for its own sake."""

from collections.abc import Callable
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Ignore, Span, StepbotError
from stepbot.robot.model import Robot
from stepbot.robot.self_collision import PairClass
from stepbot.sidecar.settings import SelfCollisionSection

from .building import built_of
from .composing import compose
from .conversion import Options
from .describing import described_robot
from .self_collisions import by_depth, with_self_collision
from .sidecars import SIDECAR_SUFFIXES, load, named_step


def search(
    target: Path, samples: int | None, options: Options, diagnostics: Diagnostics, progress: Callable[[str], None]
) -> Robot | None:
    """The robot of a sidecar, or of a URDF, SDFormat or MJCF, with the links that can overlap; None after an error.

    Args:
        target: The sidecar, or the description.
        samples: Number of poses; None for the sidecar's, or the default.
    """
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    try:
        read = robot_of(target, options, diagnostics)
        if read is None:
            return None
        robot, wanted = read
        progress("self-collision")
        wanted = wanted or SelfCollisionSection()
        if samples is not None:
            wanted = wanted.model_copy(update={"samples": samples})
        robot = with_self_collision(robot, wanted, options, diagnostics)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return None
    stated = set(map(frozenset, robot.excluded_contacts))
    for pair in robot.self_collision.of_class(PairClass.SOMETIMES) if robot.self_collision else ():
        if pair.first == 0 and pair.links not in stated:
            message = f"links '{pair.link_a}' and '{pair.link_b}' overlap{by_depth(pair)} in the drawn pose"
            diagnostics.add("SB810", message, Span(robot.source or robot.name))
    return None if robot.self_collision is None else robot


def robot_of(
    target: Path, options: Options, diagnostics: Diagnostics
) -> tuple[Robot, SelfCollisionSection | None] | None:
    """The robot of a sidecar or a description, and what a sidecar requests; None after an error of a description.

    Raises:
        StepbotError: There are errors.
    """
    if target.suffix.lower() in SIDECAR_SUFFIXES:
        sidecar = load(target, options, diagnostics)
        if sidecar.document.modules:
            return compose(sidecar, options, diagnostics).robot, sidecar.document.self_collision
        built, _ = built_of(sidecar, named_step(sidecar, diagnostics), options, diagnostics)
        return built.robot, sidecar.document.self_collision
    described = described_robot(target, options, diagnostics, drawn=False)
    return None if described is None else (described, None)
