"""The pairs of links between which a sidecar excludes contacts."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics
from stepbot.robot.kinematics import neighbours
from stepbot.robot.model import Robot
from stepbot.sidecar.located import Sidecar


def without_contacts_of(robot: Robot, sidecar: Sidecar, found: Diagnostics) -> Robot:
    """The robot with the sidecar's excluded pairs; those of adjacent links are reported (SB146)."""
    if not sidecar.document.excluded_contacts:
        return robot
    adjacent, pairs = neighbours(robot), dict[tuple[str, str], int]()
    for index, pair in enumerate(sidecar.document.excluded_contacts):
        pairs.setdefault((min(pair), max(pair)), index)
    for (a, b), index in pairs.items():
        if frozenset((a, b)) in adjacent:
            message = f"links '{a}' and '{b}' are adjacent; their contacts are excluded in any case"
            span = sidecar.span("excluded_contacts", index)
            found.add("SB146", f"excluded_contacts[{index}]: {message}", span, help=["remove the pair"])
    kept = (pair for pair in pairs if pair[0] != pair[1] and frozenset(pair) not in adjacent)
    return replace(robot, excluded_contacts=tuple(sorted(kept)))
