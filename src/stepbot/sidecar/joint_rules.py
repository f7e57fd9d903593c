"""What a joint's type asks of its keys: which there may be, which there must be, in which units, in which order."""

from math import inf

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.sums import exact_sum
from stepbot.robot.model import JointKind

from .document import JointSection
from .joint_settings import ONE_FREEDOM, Setting, joint_settings, position_dimension, settings_of
from .located import Sidecar
from .subjects import subject
from .tree import Keys
from .units import Dimension

WITH_AXIS = (
    JointKind.REVOLUTE,
    JointKind.CONTINUOUS,
    JointKind.PRISMATIC,
    JointKind.PLANAR,
    JointKind.SCREW,
    JointKind.UNIVERSAL,
    JointKind.CYLINDRICAL,
)
"""Kinds of joints that have an axis."""
_KINDS_WITH: dict[str, tuple[JointKind, ...]] = {
    "axis": WITH_AXIS,
    "axis2": (JointKind.UNIVERSAL,),
    "pitch": (JointKind.SCREW,),
    "zero": ONE_FREEDOM,
    "mimic": ONE_FREEDOM,
}
_REQUIRED = {JointKind.SCREW: "pitch", JointKind.UNIVERSAL: "axis2"}
_NEED_LIMITS = (JointKind.REVOLUTE, JointKind.PRISMATIC)
_TOLERANCE = 1e-9
"""How far [rad or m] a drawn position may be beyond a limit that it was rounded to."""


def check_joints(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report, joint by joint, SB121, SB125, SB137, SB138, SB455 to SB457, SB462 and SB463."""
    for name, joint in sidecar.document.joints.items():
        settings = joint_settings(sidecar.document, name)
        _check_keys(sidecar, name, joint, settings, found)
        _check_units(sidecar, name, joint, settings, found)
        if "lower" in settings_of(joint.type):
            _check_limits(sidecar, name, joint, settings, found)
        if joint.type is JointKind.UNIVERSAL and joint.axis2 is not None:
            _check_second_axis(sidecar, name, joint, found)
        if joint.pitch == 0.0:
            found.add(
                "SB125",
                f"joint '{name}': pitch: a screw advances, so it is not 0",
                sidecar.span("joints", name, "pitch"),
            )


def _check_keys(
    sidecar: Sidecar, name: str, joint: JointSection, settings: dict[str, Setting], found: Diagnostics
) -> None:
    for key, kinds in _KINDS_WITH.items():
        if key in joint.model_fields_set and joint.type not in kinds:
            help = [f"joints that have it: {', '.join(kinds)}"]
            message = f"joint '{name}': a {joint.type} joint has no '{key}'"
            found.add("SB137", message, sidecar.key_span("joints", name, key), help=help)
    if joint.limits == "todo" and "lower" not in settings_of(joint.type):
        message = f"joint '{name}': a {joint.type} joint has no position limits, so they cannot be `todo`"
        found.add("SB137", message, sidecar.span("joints", name, "limits"), help=["remove `limits: todo`"])
    for field, setting in settings.items():
        if field not in settings_of(joint.type):
            keys = ".".join(map(str, setting.keys[2:]))
            message = f"joint '{name}': a {joint.type} joint has no '{keys}'"
            help = ["a joint that turns between limits is revolute"] if joint.type is JointKind.CONTINUOUS else []
            found.add("SB137", message, sidecar.key_span(*setting.keys), help=help)
    required = _REQUIRED.get(joint.type)
    if required is not None and getattr(joint, required) is None:
        example = {"pitch": "pitch: 2 mm/rev", "axis2": "axis2: x"}[required]
        message = f"joint '{name}': key '{required}' is missing: a {joint.type} joint needs it"
        found.add("SB121", message, sidecar.key_span("joints", name), help=[f"for example `{example}`"])


def _check_units(
    sidecar: Sidecar, name: str, joint: JointSection, settings: dict[str, Setting], found: Diagnostics
) -> None:
    known = settings_of(joint.type)
    for field, setting in settings.items():
        if field in known:
            check_unit(sidecar, f"joint '{name}'", joint.type, setting.dimension, known[field], setting.keys, found)
    position = position_dimension(joint.type)
    if position is not None:
        keys: Keys = ("joints", name, "zero")
        check_unit(sidecar, f"joint '{name}'", joint.type, joint.zero.dimension, position, keys, found)
        if joint.mimic is not None:
            keys = ("joints", name, "mimic", "offset")
            check_unit(sidecar, f"joint '{name}'", joint.type, joint.mimic.offset.dimension, position, keys, found)


def check_unit(
    sidecar: Sidecar,
    who: str,
    kind: JointKind,
    written: Dimension | None,
    needed: Dimension,
    keys: Keys,
    found: Diagnostics,
) -> None:
    """Report SB138 where a unit was written that is not of the dimension that a joint of this kind needs."""
    if written is None or written == needed:
        return
    moves = "slides" if kind is JointKind.PRISMATIC else "turns"
    key = keys[-1] if keys[0] != "joint_defaults" else f"{keys[-1]} of {subject(keys[:2])}"
    message = (
        f"{who}: {key}: '{sidecar.written(*keys)}' is no {needed.name} [{needed.unit}], and a {kind} joint {moves}"
    )
    help = [f"for example {needed.example}"]
    if keys[0] == "joint_defaults":
        help.append(f"or set `{keys[-1]}` on {who} itself")
    found.add("SB138", message, sidecar.span(*keys), help=help)


def _check_limits(
    sidecar: Sidecar, name: str, joint: JointSection, settings: dict[str, Setting], found: Diagnostics
) -> None:
    lower, upper = settings.get("lower"), settings.get("upper")
    who = f"joint '{name}'"
    missing = [field for field in ("lower", "upper") if field not in settings]
    if joint.limits == "todo":
        if missing:
            message = f"{who}: limits are `todo`: the joint has no {' and no '.join(missing)} limit"
            help = [f"limits: {{lower: {_example(joint.type)[0]}, upper: {_example(joint.type)[1]}}}"]
            found.add("SB463", message, sidecar.span("joints", name, "limits"), help=help)
    elif joint.type in _NEED_LIMITS and missing:
        help = [f"limits: {{lower: {_example(joint.type)[0]}, upper: {_example(joint.type)[1]}}}"]
        if joint.type is JointKind.REVOLUTE:
            help.append("a joint that turns without end is `type: continuous`")
        message = f"{who}: a {joint.type} joint needs limits: no {' and no '.join(missing)}"
        found.add("SB455", message, sidecar.key_span("joints", name, "limits"), help=help)
    position = position_dimension(joint.type)
    if lower is None or upper is None or not {lower.dimension, upper.dimension} <= {None, position}:
        return
    if joint.type is JointKind.REVOLUTE and (lower.value, upper.value) == (-inf, inf):
        help = ["write `type: continuous`, without lower and upper"]
        found.add("SB455", f"{who}: turns without end, so it is not revolute", sidecar.span(*lower.keys), help=help)
    elif lower.value >= upper.value:
        _report_swapped(sidecar, who, lower, upper, found)
    else:
        _check_drawn_position(sidecar, name, joint, lower, upper, found)


def _report_swapped(sidecar: Sidecar, who: str, lower: Setting, upper: Setting, found: Diagnostics) -> None:
    low, high = sidecar.written(*lower.keys), sidecar.written(*upper.keys)
    if lower.value == upper.value:
        message, help = f"{who}: lower and upper are both {low}", ["a joint that does not move is `type: fixed`"]
    else:
        message, help = f"{who}: lower {low} is above upper {high}", [f"swap them: {{lower: {high}, upper: {low}}}"]
    found.add("SB456", message, sidecar.span(*lower.keys), help=help, notes=[f"upper at {sidecar.span(*upper.keys)}"])


def _check_drawn_position(
    sidecar: Sidecar, name: str, joint: JointSection, lower: Setting, upper: Setting, found: Diagnostics
) -> None:
    q = joint.zero.value
    position = position_dimension(joint.type)
    if position is None or joint.zero.dimension not in (None, position):
        return
    if lower.value - _TOLERANCE <= q <= upper.value + _TOLERANCE:
        return
    bound, limit, side = ("lower", lower, "below") if q < lower.value else ("upper", upper, "above")
    given = "zero" in joint.model_fields_set
    drawn = sidecar.written("joints", name, "zero") if given else f"0 {position.unit}"
    message = f"joint '{name}': the drawn position {drawn} is {side} {bound} {sidecar.written(*limit.keys)}"
    help = ["`zero` says which position the CAD drew; without it that is 0, and limits count from there"]
    keys: Keys = ("joints", name, "zero") if given else limit.keys
    found.add("SB457", message, sidecar.span(*keys), help=[] if given else help)


def _check_second_axis(sidecar: Sidecar, name: str, joint: JointSection, found: Diagnostics) -> None:
    assert joint.axis2 is not None
    dot = exact_sum(a * b for a, b in zip(joint.axis, joint.axis2, strict=True))
    if abs(dot) > 1.0 - 1e-6:
        message = f"joint '{name}': axis and axis2 are parallel"
        found.add(
            "SB462", message, sidecar.span("joints", name, "axis2"), help=["for example `axis: z` and `axis2: x`"]
        )


def _example(kind: JointKind) -> tuple[str, str]:
    return ("-90 deg", "90 deg") if kind is JointKind.REVOLUTE else ("0", "40 mm")
