"""What joints do to each other and with each other: mimics and closures."""

from math import isfinite

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import JointKind

from .connections import rings
from .joint_rules import WITH_AXIS
from .joint_settings import ONE_FREEDOM, joint_limits, position_dimension
from .located import Sidecar

_CLOSING = (JointKind.REVOLUTE, JointKind.PRISMATIC, JointKind.BALL, JointKind.FIXED)
_TOLERANCE = 1e-6
"""How far [rad or m] positions may be apart that a mimic makes equal: rounded numbers, not contradictions."""


def check_mimics(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB458 chains that close, SB459 what cannot be followed, SB460 and SB461 positions that contradict."""
    document = sidecar.document
    leaders = {name: joint.mimic.joint for name, joint in document.joints.items() if joint.mimic is not None}
    closed = {name for ring in rings(leaders) for name in ring}
    for name, joint in document.joints.items():
        if joint.mimic is None or joint.mimic.joint not in document.joints:
            continue
        place = sidecar.span("joints", name, "mimic", "joint")
        leader = document.joints[joint.mimic.joint]
        if name in closed:
            around = "itself" if joint.mimic.joint == name else f"'{joint.mimic.joint}', which follows it in turn"
            help = ["one joint of the group leads and has no `mimic`"]
            found.add("SB458", f"joint '{name}': follows {around}", place, help=help)
        elif leader.type not in ONE_FREEDOM:
            message = f"joint '{name}': cannot follow '{joint.mimic.joint}': a {leader.type} joint has no one position"
            found.add("SB459", message, place, help=[f"joints that lead: {', '.join(ONE_FREEDOM)}"])
        elif joint.type in ONE_FREEDOM:
            _check_positions(sidecar, name, found)


def _check_positions(sidecar: Sidecar, name: str, found: Diagnostics) -> None:
    """Compare where the leader puts a joint with where it can be, and where it was drawn."""
    document = sidecar.document
    joint = document.joints[name]
    mimic, position = joint.mimic, position_dimension(joint.type)
    assert mimic is not None
    assert position is not None
    if not {joint.zero.dimension, mimic.offset.dimension} <= {None, position}:
        return
    unit = position.unit
    own, leading = joint_limits(document, name), joint_limits(document, mimic.joint)
    ends = [mimic.multiplier * q + mimic.offset.value for q in (leading.lower, leading.upper)]
    if all(map(isfinite, ends)) and leading.lower < leading.upper and own.lower < own.upper:
        low, high = min(ends), max(ends)
        if low < own.lower - _TOLERANCE or high > own.upper + _TOLERANCE:
            message = (
                f"joint '{name}': joint '{mimic.joint}' moves it from {low:.6g} to {high:.6g} {unit}, "
                f"beyond its limits {own.lower:.6g} to {own.upper:.6g} {unit}"
            )
            found.add("SB460", message, sidecar.key_span("joints", name, "mimic"))
    drawn, follows = joint.zero.value, mimic.multiplier * document.joints[mimic.joint].zero.value
    if abs(drawn - follows - mimic.offset.value) > _TOLERANCE:
        message = (
            f"joint '{name}': drawn at {drawn:.6g} {unit}, but joint '{mimic.joint}' as drawn "
            f"puts it at {follows + mimic.offset.value:.6g} {unit}"
        )
        found.add("SB461", message, sidecar.key_span("joints", name, "mimic"))


def check_closures(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB450 closures between a link and itself, and SB137 kinds and keys that closures do not have."""
    for name, closure in sidecar.document.closures.items():
        who = f"closure '{name}'"
        if closure.link_a == closure.link_b:
            message = f"{who}: link_a and link_b are both '{closure.link_a}'"
            help = ["a closure connects two links: name another"]
            found.add("SB450", message, sidecar.span("closures", name, "link_b"), help=help)
        if closure.type not in _CLOSING:
            message = f"{who}: a closure cannot be {closure.type}"
            help = [f"kinds: {', '.join(_CLOSING)}"]
            found.add("SB137", message, sidecar.span("closures", name, "type"), help=help)
        elif "axis" in closure.model_fields_set and closure.type not in WITH_AXIS:
            message = f"{who}: a {closure.type} closure has no 'axis'"
            found.add("SB137", message, sidecar.key_span("closures", name, "axis"))
