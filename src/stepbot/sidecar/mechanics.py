"""Check mimic joints, closures, and values in frames that a joint's ``zero`` turns."""

from math import isfinite

from stepbot.diagnostics import Diagnostics
from stepbot.robot.joint_types import kinds_with

from .connections import rings
from .joint_rules import WITH_AXIS, positions
from .joint_settings import ONE_FREEDOM, joint_limits, position_dimension
from .located import Sidecar

_TOLERANCE = 1e-6
"""Tolerance [rad or m] of mimic positions, for rounded numbers."""


def check_mimics(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB458 circular mimics, SB459 joints that cannot be mimicked, SB460 conflicting positions."""
    document = sidecar.document
    leaders = {name: joint.mimic.joint for name, joint in document.joints.items() if joint.mimic is not None}
    closed = {name for ring in rings(leaders) for name in ring}
    for name, joint in document.joints.items():
        if joint.mimic is None or joint.mimic.joint not in document.joints:
            continue
        place = sidecar.span("joints", name, "mimic", "joint")
        leader = document.joints[joint.mimic.joint]
        if name in closed:
            around = "itself" if joint.mimic.joint == name else f"'{joint.mimic.joint}', which mimics it in turn"
            help = ["remove `mimic` from one joint of the group"]
            found.add("SB458", f"joint '{name}': circular mimic: mimics {around}", place, help=help)
        elif leader.type not in ONE_FREEDOM:
            message = f"joint '{name}': joint '{joint.mimic.joint}' of type {leader.type} cannot be mimicked"
            found.add("SB459", message, place, help=[f"types that can be mimicked: {', '.join(ONE_FREEDOM)}"])
        elif joint.type in ONE_FREEDOM:
            _check_positions(sidecar, name, found)


def _check_positions(sidecar: Sidecar, name: str, found: Diagnostics) -> None:
    """Compare the mimic position of a joint with its limits and its assembled position."""
    document = sidecar.document
    joint = document.joints[name]
    mimic, position = joint.mimic, position_dimension(joint.type)
    assert mimic is not None
    assert position is not None
    if not {joint.zero.dimension, mimic.offset.dimension} <= {None, position}:
        return
    own, leading = joint_limits(document, name), joint_limits(document, mimic.joint)
    ends = [mimic.multiplier * q + mimic.offset.value for q in (leading.lower, leading.upper)]
    place = sidecar.key_span("joints", name, "mimic")
    if all(map(isfinite, ends)) and leading.lower < leading.upper and own.lower < own.upper:
        low, high = min(ends), max(ends)
        if low < own.lower - _TOLERANCE or high > own.upper + _TOLERANCE:
            message = (
                f"joint '{name}': mimic of joint '{mimic.joint}' ranges from {positions((low, high), position)}, "
                f"beyond its limits {positions((own.lower, own.upper), position)}"
            )
            help = [f"narrow the limits of joint '{mimic.joint}', widen these, or correct `multiplier` and `offset`"]
            found.add("SB460", message, place, help=help)
    assembled = joint.zero.value
    follows = mimic.multiplier * document.joints[mimic.joint].zero.value + mimic.offset.value
    if abs(assembled - follows) > _TOLERANCE:
        message = (
            f"joint '{name}': assembled position is {positions([assembled], position)}, but the mimic of joint "
            f"'{mimic.joint}' gives {positions([follows], position)}"
        )
        offset = positions([mimic.offset.value + assembled - follows], position)
        help = [f"set `zero` of both joints to their positions as modelled in CAD, or `offset: {offset}` in `mimic`"]
        found.add("SB460", message, place, help=help)


def check_turned_frames(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB523 values in the frame of a link that is not as drawn, since its joint has a ``zero``."""
    for name, joint in sidecar.document.joints.items():
        link, position = sidecar.document.links.get(joint.child), position_dimension(joint.type)
        if link is None or not joint.zero.value or position is None:
            continue
        given = link.inertial
        keys = ["inertial"] if given is not None and (given.com is not None or given.inertia is not None) else []
        keys += ["collision"] if isinstance(link.collision, tuple) else []
        for key in keys:
            by = positions([joint.zero.value], position)
            turned = f"which `zero` of joint '{name}' moves by {by} in the drawn pose"
            message = f"link '{joint.child}': `{key}` is in the link's frame, {turned}"
            help = ["check that its values are those at q = 0 of the joint, not those in the drawn pose"]
            found.add("SB523", message, sidecar.span("links", joint.child, key), help=help)


def check_closures(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB450 closures of a link with itself, and SB137 invalid types and keys."""
    for name, closure in sidecar.document.closures.items():
        who = f"closure '{name}'"
        if closure.link_a == closure.link_b:
            message = f"{who}: link_a and link_b are both '{closure.link_a}'"
            help = ["change one of them to another link"]
            found.add("SB450", message, sidecar.span("closures", name, "link_b"), help=help)
        if not closure.type.closes:
            message = f"{who}: type {closure.type} is not valid for a closure"
            help = [f"valid types: {', '.join(kinds_with(closes=True))}"]
            found.add("SB137", message, sidecar.span("closures", name, "type"), help=help)
        elif "axis" in closure.model_fields_set and closure.type not in WITH_AXIS:
            message = f"{who}: 'axis' is not valid for type {closure.type}"
            found.add("SB137", message, sidecar.key_span("closures", name, "axis"))
