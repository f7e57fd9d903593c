"""What joints do to each other and with each other: mimics, closures, actuators."""

from math import isfinite

from ..diagnostics import Diagnostics
from ..model import ActuatorKind, JointKind
from .connections import rings
from .document import ActuatorSection
from .joint_rules import WITH_AXIS, check_unit
from .joint_settings import ONE_FREEDOM, joint_limits, position_dimension, settings_of
from .located import Sidecar

_CLOSING = (JointKind.REVOLUTE, JointKind.PRISMATIC, JointKind.BALL, JointKind.FIXED)
_GAINS = {ActuatorKind.POSITION: ("kp", "kv"), ActuatorKind.VELOCITY: ("kv",), ActuatorKind.MOTOR: ()}
_NEEDED_GAIN = {ActuatorKind.POSITION: "kp", ActuatorKind.VELOCITY: "kv"}
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


def check_drives(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report, actuator by actuator, SB121, SB125, SB137, SB138 and SB459."""
    document = sidecar.document
    for name, actuator in document.actuators.items():
        who = f"actuator '{name}'"
        _check_gains(sidecar, name, actuator, found)
        joint = document.joints.get(actuator.joint)
        if joint is None:
            continue
        place = sidecar.span("actuators", name, "joint")
        if joint.type not in ONE_FREEDOM:
            message = f"{who}: cannot drive '{actuator.joint}': a {joint.type} joint has no one position"
            found.add("SB459", message, place, help=[f"joints that can be driven: {', '.join(ONE_FREEDOM)}"])
        elif joint.mimic is not None:
            message = f"{who}: cannot drive '{actuator.joint}', which follows joint '{joint.mimic.joint}'"
            found.add("SB459", message, place, help=[f"drive '{joint.mimic.joint}'"])
        else:
            known = settings_of(joint.type)
            kp, kv = ("actuators", name, "kp"), ("actuators", name, "kv")
            check_unit(sidecar, who, joint.type, actuator.kp.dimension, known["stiffness"], kp, found)
            check_unit(sidecar, who, joint.type, actuator.kv.dimension, known["damping"], kv, found)


def _check_gains(sidecar: Sidecar, name: str, actuator: ActuatorSection, found: Diagnostics) -> None:
    who, kind = f"actuator '{name}'", actuator.kind
    for gain in ("kp", "kv"):
        if gain in actuator.model_fields_set and gain not in _GAINS[kind]:
            help = [f"{kind.value} for {gain}" for kind, gains in _GAINS.items() if gain in gains]
            message = f"{who}: an actuator of kind {kind} has no '{gain}'"
            found.add("SB137", message, sidecar.key_span("actuators", name, gain), help=[f"kinds: {', '.join(help)}"])
    needed = _NEEDED_GAIN.get(kind)
    if needed is not None and needed not in actuator.model_fields_set:
        message = f"{who}: key '{needed}' is missing: without it a {kind} actuator exerts nothing"
        found.add("SB121", message, sidecar.key_span("actuators", name), help=[f"for example `{needed}: 100`"])
    if actuator.gear == 0.0:
        found.add("SB125", f"{who}: gear: a drive with ratio 0 exerts nothing", sidecar.span("actuators", name, "gear"))
