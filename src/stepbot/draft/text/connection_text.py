"""Drafted joints and closures as lines of the sidecar, with their evidence above and alternatives below."""

from collections.abc import Mapping
from math import isinf

from msgspec.structs import asdict

from stepbot.diagnostics import one_line
from stepbot.draft.draft import Alternative, DraftClosure, DraftConnection, DraftJoint, FoundStop
from stepbot.draft.text.draft_names import DraftNames
from stepbot.draft.text.values import (
    alternative_origin,
    angle,
    axis,
    comment,
    flow,
    lengths,
    millimetres,
    number,
    origin_text,
    position,
)
from stepbot.geometry.inertia import MassProperties
from stepbot.robot.model import JointKind
from stepbot.sidecar.starter import scalar
from stepbot.step.structure.paths import quoted

Entries = list[tuple[str, str]]

_WITHOUT_LIMITS = (JointKind.FIXED, JointKind.PLANAR, JointKind.CYLINDRICAL, JointKind.FLOATING)


def joint_lines(joint: DraftJoint, name: str, names: DraftNames, joints: Mapping[str, str]) -> list[str]:
    """A joint under ``joints:``; below the score for drafting it is fixed, with the guess as a comment beneath.

    Args:
        joints: What joints are called, by their names in the draft.
    """
    name, ends = scalar(name), _ends("parent", joint.parent, "child", joint.child, names)
    guess = [*_typed(joint, ends), *_limits(joint), *_given(joint, joints)]
    if joint.confidence.is_chosen:
        written, beneath = guess, []
    else:
        written = [("type", "fixed"), *ends, _origin(joint)]
        beneath = [_commented(name, guess, joint)] if guess != written else []
    lines = [*_evidence(joint, names), f"  {name}:", *(f"    {key}: {value}" for key, value in written), *beneath]
    return [*lines, *(_alternative(name, ends, other, joint) for other in joint.alternatives)]


def closure_lines(closure: DraftClosure, name: str, names: DraftNames) -> list[str]:
    """A closure under ``closures:``; a comment if it is below that score, or of a type that closures do not support."""
    name = scalar(name)
    ends = _ends("link_a", closure.link_a, "link_b", closure.link_b, names)
    entries = _typed(closure, ends)
    if closure.confidence.is_chosen and closure.type.closes:
        lines = [f"  {name}:", *(f"    {key}: {value}" for key, value in entries)]
    else:
        lines = [_commented(name, entries, closure)]
    return [
        *_evidence(closure, names),
        *lines,
        *(_alternative(name, ends, alternative, closure) for alternative in closure.alternatives),
    ]


def fused_lines(alternative: Alternative, name: str, names: DraftNames) -> list[str]:
    """A joint that frees a part of a link, as a line to uncomment, with why the part was drafted as fixed."""
    entries = [("type", alternative.type.value), *_ends("parent", alternative.link, "child", name, names)]
    if alternative.point is not None:
        entries.append(("origin", alternative_origin(alternative.point, alternative.direction)))
    if alternative.type.bounded:
        entries.append(("limits", "todo"))
    facts = "; ".join(alternative.confidence.evidence)
    other = alternative.a if alternative.moving == alternative.b else alternative.b
    score = f"score {alternative.confidence.score:.2f}: {one_line(facts)}"
    return [
        *comment(f"fused: '{alternative.moving}' and '{other}' are one link: {alternative.held}", 2),
        f"  # {scalar(f'{name}_joint')}: {flow(entries)}  # {score}",
    ]


def _ends(key_a: str, a: str, key_b: str, b: str, names: DraftNames) -> Entries:
    return [(key_a, scalar(names.links.get(a, a))), (key_b, scalar(names.links.get(b, b)))]


def _origin(connection: DraftConnection) -> tuple[str, str]:
    return "origin", origin_text(connection.origin)


def _typed(connection: DraftConnection, ends: Entries) -> Entries:
    """Type, links, origin and axes."""
    kind, pitch = connection.type, connection.pitch if isinstance(connection, DraftJoint) else None
    if kind is JointKind.SCREW and pitch is None:  # its coordinates: it has both a revolute and a prismatic one
        kind = JointKind.CYLINDRICAL
    entries = [("type", kind.value), *ends, _origin(connection)]
    if kind.has_axis and connection.axis != "z":
        entries.append(("axis", axis(connection.axis)))
    if isinstance(connection, DraftJoint) and kind is JointKind.UNIVERSAL:
        entries.append(("axis2", axis(connection.axis2 or "x")))
    if isinstance(connection, DraftJoint) and connection.zero:
        entries.append(
            ("zero", millimetres(connection.zero) if kind is JointKind.PRISMATIC else angle(connection.zero))
        )
    if pitch is not None:
        entries.append(("pitch", f"{millimetres(pitch)}/rev"))
    return entries


def _limits(joint: DraftJoint) -> Entries:
    if joint.limits is None:
        return [("limits", "todo")] if joint.type.bounded else []
    write = millimetres if joint.type is JointKind.PRISMATIC else angle
    limits = joint.limits
    entries = (
        [("lower", limits.lower), ("upper", limits.upper)]
        if joint.type.bounded or joint.type is JointKind.SCREW
        else []
    )
    written = [(key, str(value) if isinf(value) else write(value)) for key, value in entries]
    rates = [("effort", limits.effort), ("velocity", limits.velocity)] if joint.type not in _WITHOUT_LIMITS else []
    written += [(key, number(value)) for key, value in rates if not isinf(value)]
    return [("limits", flow(written))] if written else []


def _given(joint: DraftJoint, names: Mapping[str, str]) -> Entries:
    """Passive forces and the joint that it follows, where they are known."""
    entries: Entries = []
    if joint.dynamics is not None and joint.type not in _WITHOUT_LIMITS:
        known = [(key, value) for key, value in asdict(joint.dynamics).items() if value]
        entries += [("dynamics", flow((key, number(value)) for key, value in known))] if known else []
    if joint.mimic is not None and joint.mimic.joint in names:
        follows = [("joint", scalar(names[joint.mimic.joint])), ("multiplier", number(joint.mimic.multiplier))]
        entries.append(("mimic", flow([*follows, ("offset", number(joint.mimic.offset))])))
    return entries


def inertial_lines(properties: MassProperties) -> list[str]:
    """Mass, centre of mass and inertia of a link."""
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = properties.inertia
    moments = {"ixx": ixx, "iyy": iyy, "izz": izz, "ixy": ixy, "ixz": ixz, "iyz": iyz}
    entries = [("mass", f"{number(properties.mass)} kg"), ("com", lengths(properties.com))]
    entries.append(("inertia", flow((key, number(value)) for key, value in moments.items())))
    return [f"    inertial: {flow(entries)}"]


def _evidence(connection: DraftConnection, names: DraftNames) -> list[str]:
    """The evidence for it, and what to review."""
    facts = "; ".join(connection.confidence.evidence)
    lines = comment(f"score {connection.confidence.score:.2f}{': ' if facts else ''}{facts}", 2)
    if isinstance(connection, DraftJoint) and connection.limits is not None and connection.limits_from:
        lines += comment(f"limits: {connection.limits_from}", 2)
    if isinstance(connection, DraftJoint):
        lines += [line for stop in connection.stops for line in comment(_stop_text(connection, stop), 2)]
    if isinstance(connection, DraftJoint) and connection.stops_skipped:
        lines += comment(
            f"stops: pairs of parts not compared, because of their many faces: {connection.stops_skipped}", 2
        )
    reasons = [connection.review] if connection.review else []
    if connection.doubt:
        reasons.append(f"weak evidence for its axis: {connection.doubt}")
    if isinstance(connection, DraftJoint) and connection.type is JointKind.SCREW and connection.pitch is None:
        reasons.append("unknown pitch: cylindrical until replaced by `type: screw` with a `pitch`")
    if not reasons and connection.is_reviewed:
        reasons.append("the evidence is weak; compare with the drawing")
    if isinstance(connection, DraftJoint) and not connection.confidence.score:
        ends = " ".join(quoted(names.links.get(end, end)) for end in (connection.parent, connection.child))
        lines += comment(f"axes that both links may share: `stepbot inspect --between {ends} SIDECAR`", 2)
    return [*lines, *(line for reason in reasons for line in comment(f"REVIEW: {reason}", 2))]


def _stop_text(joint: DraftJoint, stop: FoundStop) -> str:
    at = position(stop.position, slides=joint.type is JointKind.PRISMATIC)
    return f"stop found by collision at {at}: '{stop.parts[0]}' and '{stop.parts[1]}'; a limit may be closer"


def _alternative(name: str, ends: Entries, other: Alternative, joint: DraftConnection) -> str:
    """An alternative to a connection, as a line to replace it."""
    same_line = other.point is None or (
        (other.point, other.direction) == (joint.point, joint.direction) and other.type is not JointKind.BALL
    )
    entries: Entries = [("type", other.type.value), *ends]
    if same_line or other.point is None:
        entries.append(_origin(joint))
    else:
        entries.append(("origin", alternative_origin(other.point, other.direction)))
    if same_line and other.type.has_axis and joint.axis != "z":
        entries.append(("axis", axis(joint.axis)))
    if isinstance(joint, DraftJoint) and other.type.bounded:
        entries.append(("limits", "todo"))
    facts = one_line("; ".join(other.confidence.evidence))
    return (
        f"  # {name}: {flow(entries)}  # alternative, score {other.confidence.score:.2f}{': ' if facts else ''}{facts}"
    )


def _commented(name: str, guess: Entries, connection: DraftConnection) -> str:
    return f"  # {name}: {flow(guess)}  # a guess, score {connection.confidence.score:.2f}"
