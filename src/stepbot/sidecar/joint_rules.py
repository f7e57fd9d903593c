"""Check the keys of joints by joint type, the order of limits, mimics, closures, and frames that a ``zero`` turns."""

from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from math import degrees, inf, isfinite, pi

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.joint_types import kinds_with
from stepbot.robot.model import JointKind

from .connections import rings
from .document import Document, JointSection
from .draft_comments import DraftedStop, drafted_stops
from .joint_settings import ONE_FREEDOM, Setting, joint_limits, joint_settings, position_dimension, settings_of
from .located import Sidecar
from .quantities import JointValue
from .tree import Keys
from .units import ANGLE, Dimension

WITH_AXIS = kinds_with(has_axis=True)
"""Joint types with an axis."""
_KINDS_WITH: dict[str, tuple[JointKind, ...]] = {
    "axis": WITH_AXIS,
    "axis2": (JointKind.UNIVERSAL,),
    "pitch": (JointKind.SCREW,),
    "zero": ONE_FREEDOM,
    "mimic": ONE_FREEDOM,
}
_TOLERANCE = 1e-9
"""Tolerance [rad or m] for an assembled position that was rounded to a limit."""


def check_joints(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report, joint by joint, keys that its type lacks or forbids, and limits that contradict each other."""
    stops = cache(partial(drafted_stops, sidecar.text))  # only a placeholder needs the comments
    for name, joint in sidecar.document.joints.items():
        settings = joint_settings(sidecar.document, name)
        _check_keys(sidecar, name, joint, settings, diagnostics)
        if "lower" in settings_of(joint.type):
            _check_limits(sidecar, name, joint, settings, stops, diagnostics)
        if joint.type is JointKind.UNIVERSAL and joint.axis2 is not None:
            dot = exact_sum(a * b for a, b in zip(joint.axis, joint.axis2, strict=True))
            if abs(dot) > 1.0 - 1e-6:
                message, help = f"joint '{name}': axis and axis2 are parallel", "example: `axis: z` and `axis2: x`"
                diagnostics.add("SB462", message, sidecar.span("joints", name, "axis2"), help=[help])
        if joint.pitch == 0.0:
            diagnostics.add("SB125", f"joint '{name}': pitch: must not be 0", sidecar.span("joints", name, "pitch"))


def _check_keys(
    sidecar: Sidecar, name: str, joint: JointSection, settings: dict[str, Setting], diagnostics: Diagnostics
) -> None:
    for key, kinds in _KINDS_WITH.items():
        if key in joint.model_fields_set and joint.type not in kinds:
            help = [f"valid types: {', '.join(kinds)}"]
            message = f"joint '{name}': '{key}' is not valid for type {joint.type}"
            diagnostics.add("SB137", message, sidecar.key_span("joints", name, key), help=help)
    if joint.limits == "todo" and "lower" not in settings_of(joint.type):
        message = f"joint '{name}': position limits are not valid for type {joint.type}"
        diagnostics.add("SB137", message, sidecar.span("joints", name, "limits"), help=["remove `limits: todo`"])
    for field, setting in settings.items():
        if field not in settings_of(joint.type):
            keys = ".".join(map(str, setting.keys[2:]))
            message = f"joint '{name}': '{keys}' is not valid for type {joint.type}"
            help = ["use `type: revolute` for a joint with limits"] if joint.type is JointKind.CONTINUOUS else []
            diagnostics.add("SB137", message, sidecar.key_span(*setting.keys), help=help)
    required = joint.type.needs
    if required and getattr(joint, required) is None:
        example = {"pitch": "pitch: 2 mm/rev", "axis2": "axis2: x"}[required]
        message = f"joint '{name}': missing key '{required}', required for type {joint.type}"
        diagnostics.add("SB121", message, sidecar.key_span("joints", name), help=[f"example: `{example}`"])


def _check_limits(
    sidecar: Sidecar,
    name: str,
    joint: JointSection,
    settings: dict[str, Setting],
    stops: Callable[[], Mapping[str, tuple[DraftedStop, ...]]],
    diagnostics: Diagnostics,
) -> None:
    lower, upper = settings.get("lower"), settings.get("upper")
    who = f"joint '{name}'"
    missing = [field for field in ("lower", "upper") if field not in settings]
    if joint.limits == "todo" and missing:
        message = f"{who}: placeholder `limits: todo`: no {' or '.join(missing)} limit"
        help = _remedies(joint.type, stops().get(name, ()))
        diagnostics.add("SB463", message, sidecar.span("joints", name, "limits"), help=help)
    elif joint.type.bounded and missing:
        help = [f"limits: {{lower: {_example(joint.type)[0]}, upper: {_example(joint.type)[1]}}}"]
        if joint.type is JointKind.REVOLUTE:
            help.append("use `type: continuous` for unlimited rotation")
        message = f"{who}: missing limits of a {joint.type} joint: {', '.join(missing)}"
        diagnostics.add("SB455", message, sidecar.key_span("joints", name, "limits"), help=help)
    position = position_dimension(joint.type)
    if lower is None or upper is None or not {lower.dimension, upper.dimension} <= {None, position}:
        return
    if joint.type is JointKind.REVOLUTE and (lower.value, upper.value) == (-inf, inf):
        help = ["use `type: continuous`, without lower and upper"]
        diagnostics.add("SB455", f"{who}: revolute joint with infinite limits", sidecar.span(*lower.keys), help=help)
    elif lower.value >= upper.value:
        _report_swapped(sidecar, who, lower, upper, diagnostics)
    else:
        _check_assembled_position(sidecar, name, joint, lower, upper, diagnostics)


def _report_swapped(sidecar: Sidecar, who: str, lower: Setting, upper: Setting, diagnostics: Diagnostics) -> None:
    low, high = sidecar.written(*lower.keys), sidecar.written(*upper.keys)
    if lower.value == upper.value:
        message = f"{who}: lower and upper limits are both {low}"
        help = "use `type: fixed` for a joint that does not move"
    else:
        message = f"{who}: lower limit {low} is above upper limit {high}"
        help = f"swap the limits: {{lower: {high}, upper: {low}}}"
    note = f"upper limit at {sidecar.span(*upper.keys)}"
    diagnostics.add("SB456", message, sidecar.span(*lower.keys), help=[help], notes=[note])


def _check_assembled_position(
    sidecar: Sidecar, name: str, joint: JointSection, lower: Setting, upper: Setting, diagnostics: Diagnostics
) -> None:
    q = joint.zero.value
    position = position_dimension(joint.type)
    if position is None or joint.zero.dimension not in (None, position):
        return
    if lower.value - _TOLERANCE <= q <= upper.value + _TOLERANCE:
        return
    bound, limit, side = ("lower", lower, "below") if q < lower.value else ("upper", upper, "above")
    given = "zero" in joint.model_fields_set
    zero: Keys = ("joints", name, "zero")
    assembled = _with_unit(sidecar, zero, joint.zero, position) if given else positions([0.0], position)
    reached = _with_unit(sidecar, limit.keys, limit, position)
    message = f"joint '{name}': assembled position {assembled} is {side} the {bound} limit {reached}"
    help = ["set `zero` to the position of the joint as modelled in CAD (default 0); limits are measured from q = 0"]
    keys = zero if given else limit.keys
    diagnostics.add("SB457", message, sidecar.span(*keys), help=[] if given else help)


def _with_unit(sidecar: Sidecar, keys: Keys, given: JointValue | Setting, position: Dimension) -> str:
    """A position as written; one without a unit in SI units, and in degrees or millimetres."""
    written = sidecar.written(*keys)
    if given.dimension is not None:
        return written
    value = given.value
    return f"{written} {position.unit}" + (f" ({positions([value], position)})" if value else "")


def positions(values: Iterable[float], dimension: Dimension) -> str:
    """Positions [SI] for a message, in degrees or millimetres: ``-90 to 90 deg``."""
    scale, unit = (180.0 / pi, "deg") if dimension is ANGLE else (1e3, "mm")
    return f"{' to '.join(f'{scale * value:.6g}' for value in values)} {unit}"


def _example(kind: JointKind) -> tuple[str, str]:
    return ("-90 deg", "90 deg") if kind is JointKind.REVOLUTE else ("0", "40 mm")


def _remedies(kind: JointKind, stops: Iterable[DraftedStop]) -> list[str]:
    """Limits to write: the stops that `init` found in either direction, else an example."""
    slides = kind is JointKind.PRISMATIC
    positions = [stop.position for stop in stops]
    bounds = {
        "lower": max((q for q in positions if q < 0.0), default=None),
        "upper": min((q for q in positions if q > 0.0), default=None),
    }
    values = [
        example if (q := bounds[key]) is None else f"{q * 1e3:.6g} mm" if slides else f"{degrees(q):.6g} deg"
        for key, example in zip(bounds, _example(kind), strict=True)
    ]
    remedies = [f"limits: {{lower: {values[0]}, upper: {values[1]}}}"]
    known = [key for key, q in bounds.items() if q is not None]
    if known:
        words = f"{' and '.join(known)} {'are stops' if len(known) > 1 else 'is a stop'}"
        remedies.append(f"{words} that `init` found by collision; a limit may be closer")
    return remedies


_ALONG = 1e-6
"""Tolerance [rad or m] of mimic positions, for rounded numbers."""


def check_mimics(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB458 circular mimics, SB459 joints that cannot be mimicked, SB460 conflicting positions."""
    document = sidecar.document
    leaders = {name: joint.mimic.joint for name, joint in document.joints.items() if joint.mimic is not None}
    closed = {name for ring in rings(leaders) for name in ring}
    ranges = _ranges(document, leaders)
    for name, joint in document.joints.items():
        if joint.mimic is None or joint.mimic.joint not in document.joints:
            continue
        place = sidecar.span("joints", name, "mimic", "joint")
        leader = document.joints[joint.mimic.joint]
        if name in closed:
            around = "itself" if joint.mimic.joint == name else f"'{joint.mimic.joint}', which mimics it in turn"
            help = ["remove `mimic` from one joint of the group"]
            diagnostics.add("SB458", f"joint '{name}': circular mimic: mimics {around}", place, help=help)
        elif leader.type not in ONE_FREEDOM:
            message = f"joint '{name}': joint '{joint.mimic.joint}' of type {leader.type} cannot be mimicked"
            diagnostics.add("SB459", message, place, help=[f"types that can be mimicked: {', '.join(ONE_FREEDOM)}"])
        elif joint.type in ONE_FREEDOM:
            _check_positions(sidecar, name, ranges[joint.mimic.joint], diagnostics)


def _ranges(document: Document, leaders: Mapping[str, str]) -> dict[str, tuple[float, float]]:
    """Positions [rad or m] of each joint that is mimicked: within its limits, and as far as its own mimic moves it."""
    ranges: dict[str, tuple[float, float]] = {}
    for at in leaders.values():
        chain: dict[str, None] = {}
        while at in document.joints and at not in ranges and at not in chain:
            chain[at], at = None, leaders.get(at, "")
        for name in reversed(chain):
            limits, mimic = joint_limits(document, name), document.joints[name].mimic
            low, high = limits.lower, limits.upper
            if mimic is not None and mimic.multiplier and mimic.joint in ranges:
                ends = [mimic.multiplier * q + mimic.offset.value for q in ranges[mimic.joint]]
                low, high = max(low, min(ends)), min(high, max(ends))
            ranges[name] = low, high
    return ranges


def _check_positions(sidecar: Sidecar, name: str, leading: tuple[float, float], diagnostics: Diagnostics) -> None:
    """Compare the mimic position of a joint with its limits and its assembled position."""
    document = sidecar.document
    joint = document.joints[name]
    mimic, position = joint.mimic, position_dimension(joint.type)
    assert mimic is not None
    assert position is not None
    if not {joint.zero.dimension, mimic.offset.dimension} <= {None, position}:
        return
    own = joint_limits(document, name)
    ends = [mimic.multiplier * q + mimic.offset.value for q in leading]
    place = sidecar.key_span("joints", name, "mimic")
    if all(map(isfinite, ends)) and leading[0] < leading[1] and own.lower < own.upper:
        low, high = min(ends), max(ends)
        if low < own.lower - _ALONG or high > own.upper + _ALONG:
            message = (
                f"joint '{name}': mimic of joint '{mimic.joint}' ranges from {positions((low, high), position)}, "
                f"beyond its limits {positions((own.lower, own.upper), position)}"
            )
            help = [f"narrow the limits of joint '{mimic.joint}', widen these, or correct `multiplier` and `offset`"]
            diagnostics.add("SB460", message, place, help=help)
    assembled = joint.zero.value
    follows = mimic.multiplier * document.joints[mimic.joint].zero.value + mimic.offset.value
    if abs(assembled - follows) > _ALONG:
        message = (
            f"joint '{name}': assembled position is {positions([assembled], position)}, but the mimic of joint "
            f"'{mimic.joint}' gives {positions([follows], position)}"
        )
        offset = positions([mimic.offset.value + assembled - follows], position)
        help = [f"set `zero` of both joints to their positions as modelled in CAD, or `offset: {offset}` in `mimic`"]
        diagnostics.add("SB460", message, place, help=help)


def check_turned_frames(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
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
            diagnostics.add("SB523", message, sidecar.span("links", joint.child, key), help=help)


def check_closures(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB450 closures of a link with itself, and SB137 invalid types and keys."""
    for name, closure in sidecar.document.closures.items():
        who = f"closure '{name}'"
        if closure.link_a == closure.link_b:
            message = f"{who}: link_a and link_b are both '{closure.link_a}'"
            help = ["change one of them to another link"]
            diagnostics.add("SB450", message, sidecar.span("closures", name, "link_b"), help=help)
        if not closure.type.closes:
            message = f"{who}: type {closure.type} is not valid for a closure"
            help = [f"valid types: {', '.join(kinds_with(closes=True))}"]
            diagnostics.add("SB137", message, sidecar.span("closures", name, "type"), help=help)
        elif "axis" in closure.model_fields_set and closure.type not in WITH_AXIS:
            message = f"{who}: 'axis' is not valid for type {closure.type}"
            diagnostics.add("SB137", message, sidecar.key_span("closures", name, "axis"))
