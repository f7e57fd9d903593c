"""Positions of joints on the command line: ``elbow=30deg``, ``slide=12mm``."""

from collections.abc import Iterable, Mapping
from math import degrees, radians
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import did_you_mean

if TYPE_CHECKING:
    from stepbot.robot.model import Joint, Robot

_HINT = "--joint"
_SLACK = 1e-9

joint_option = click.option(
    "--joint",
    "joints",
    multiple=True,
    metavar="NAME=VALUE",
    help="Position of a joint, such as elbow=30deg or slide=12mm; may be repeated. Plain numbers are radians or "
    "metres. Loops are closed.  [default: as drawn]",
)


def read_positions(robot: "Robot", texts: Iterable[str]) -> dict[str, float]:
    """Positions [rad] or [m] by coordinate.

    Raises:
        click.BadParameter: No ``NAME=VALUE``, an unknown joint or one that follows another, an invalid quantity, or a
            position outside the joint's limits.
    """
    from stepbot.robot.posing import coordinates

    joints = coordinates(robot)
    found: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.rpartition("=")
        if not equals or not name:
            raise click.BadParameter(f"'{text}' is not NAME=VALUE, such as elbow=30deg", param_hint=_HINT)
        joint = _joint(robot, joints, name.strip())
        if joint.name in found:
            raise click.BadParameter(f"joint '{joint.name}' is given twice", param_hint=_HINT)
        found[joint.name] = _position(joint, value.strip())
    return found


def position_words(joint: "Joint", q: float) -> str:
    """A position in degrees or millimetres."""
    return f"{round(q * 1e3, 6):.6g} mm" if _slides(joint) else f"{round(degrees(q), 6):.6g} deg"


def _joint(robot: "Robot", joints: Mapping[str, "Joint"], name: str) -> "Joint":
    from stepbot.robot.posing import leader_of

    if name not in joints:
        fixed = any(joint.name == name for joint in robot.joints)
        closes = any(closure.name == name for closure in robot.closures)
        parts = [known for known in joints if known.startswith(f"{name}_")] if fixed else []
        near = " or ".join(parts) or "".join(did_you_mean(name, joints)) or f"choose from {', '.join(joints)}"
        why = "has no position of its own" if closes or parts else "is fixed" if fixed else "does not exist"
        remedy = near if joints else "the robot has no moving joint"
        raise click.BadParameter(f"joint '{name}' {why}; {remedy}", param_hint=_HINT)
    leader = leader_of(robot, name)
    if leader != name:
        raise click.BadParameter(f"joint '{name}' follows '{leader}'; set '{leader}' instead", param_hint=_HINT)
    return joints[name]


def _position(joint: "Joint", text: str) -> float:
    from stepbot.sidecar.units import ANGLE, LENGTH, UnitError, read_quantity

    try:
        quantity = read_quantity(text, LENGTH if _slides(joint) else ANGLE)
    except UnitError as error:
        hints = "".join(f"; {hint}" for hint in error.hints)
        raise click.BadParameter(f"joint '{joint.name}': {error}{hints}", param_hint=_HINT) from None
    q, lower, upper = quantity.value, joint.limit.lower, joint.limit.upper
    if not lower - _SLACK <= q <= upper + _SLACK:
        limits = f"{position_words(joint, lower)} to {position_words(joint, upper)}"
        message = f"joint '{joint.name}': {position_words(joint, q)} is outside its limits, {limits}"
        other, scale = ("mm", 1e-3) if _slides(joint) else ("deg", radians(1.0))
        if quantity.dimension is None and lower <= q * scale <= upper:
            message += f"; if the unit is {other}, write {joint.name}={text}{other}"
        raise click.BadParameter(message, param_hint=_HINT)
    return q


def _slides(joint: "Joint") -> bool:
    from stepbot.robot.model import JointKind

    return joint.kind is JointKind.PRISMATIC
