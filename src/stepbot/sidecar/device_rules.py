"""Check the keys of actuators and sensors, and the joints and links to which they refer."""

from math import pi

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import ActuatorKind, JointKind
from stepbot.robot.sensors import MOST_RAYS, PLACED, SEEING, SensorKind

from .devices import ActuatorSection, GainsSection, SensorSection
from .joint_settings import ONE_FREEDOM, joint_settings, settings_of
from .located import Sidecar
from .motion import LimitsSection
from .unit_rules import check_unit
from .units import RATIO

_GEAR = replace(RATIO, example="50")
_GAINS = {ActuatorKind.POSITION: ("kp", "kv"), ActuatorKind.VELOCITY: ("kv",), ActuatorKind.MOTOR: ()}
_NEEDED_GAIN = {ActuatorKind.POSITION: "kp", ActuatorKind.VELOCITY: "kv"}
_BOUNDS = {
    ActuatorKind.POSITION: ("lower", "upper", "effort"),
    ActuatorKind.VELOCITY: ("velocity", "effort"),
    ActuatorKind.MOTOR: ("effort",),
}
"""Valid limits by actuator kind: of its input, and of its effort."""

_ROUNDED = 1e-3
"""Relative difference of limits that are the same: 1.571 and 90 deg."""
_KINDS_WITH: dict[str, tuple[SensorKind, ...]] = {
    "origin": PLACED,
    "fov": SEEING,
    "range": SEEING,
    "resolution": (SensorKind.CAMERA,),
    "samples": (SensorKind.LIDAR,),
}


def check_actuators(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report, actuator by actuator, SB121, SB125, SB137, SB138, SB145, SB456 and SB459."""
    document = sidecar.document
    driven: dict[tuple[str, ActuatorKind], str] = {}
    for name, actuator in document.actuators.items():
        who = f"actuator '{name}'"
        _check_gains(sidecar, name, actuator, diagnostics)
        _check_bounds(sidecar, name, actuator, diagnostics)
        joint = document.joints.get(actuator.joint)
        if actuator.voltage is not None and actuator.motor is None:
            place = sidecar.key_span("actuators", name, "voltage")
            diagnostics.add(
                "SB137", f"{who}: 'voltage' without 'motor'", place, help=["name the motor, or remove `voltage`"]
            )
        if joint is None:
            continue
        place = sidecar.span("actuators", name, "joint")
        first = driven.setdefault((actuator.joint, actuator.kind), name)
        if joint.type not in ONE_FREEDOM:
            message = f"{who}: joint '{actuator.joint}' of type {joint.type} cannot be actuated"
            diagnostics.add("SB459", message, place, help=[f"types that can be actuated: {', '.join(ONE_FREEDOM)}"])
        elif joint.mimic is not None and joint.mimic.joint in document.joints:  # else SB130 is reported
            message = f"{who}: joint '{actuator.joint}' mimics joint '{joint.mimic.joint}' and cannot be actuated"
            diagnostics.add("SB459", message, place, help=[f"use joint '{joint.mimic.joint}' instead"])
        elif first != name:
            message = f"{who}: duplicate {actuator.kind} actuator on joint '{actuator.joint}' (first is '{first}')"
            diagnostics.add("SB459", message, place, help=["remove one of the actuators, or change its kind"])
        else:
            _check_units(sidecar, name, actuator, joint.type, diagnostics)
            _check_wider(sidecar, name, actuator, diagnostics)


def _check_wider(sidecar: Sidecar, name: str, actuator: ActuatorSection, diagnostics: Diagnostics) -> None:
    """Report limits that have no effect, since those of the joint are narrower (SB145)."""
    own = joint_settings(sidecar.document, actuator.joint)
    for field in _BOUNDS[actuator.kind]:
        bound, of_joint = getattr(actuator.limits, field), own.get(field)
        if bound is None or of_joint is None:
            continue
        beyond = (bound.value - of_joint.value) * (-1.0 if field == "lower" else 1.0)
        if beyond > _ROUNDED * abs(of_joint.value):
            keys = ("actuators", name, "limits", field)
            given, applies = sidecar.written(*keys), sidecar.written(*of_joint.keys)
            message = f"actuator '{name}': {field} {given} is beyond that of joint '{actuator.joint}', {applies}"
            remedy = f"raise the limit of the joint, which applies, or remove `{field}` here"
            diagnostics.add("SB145", message, sidecar.span(*keys), help=[remedy])


def _check_units(
    sidecar: Sidecar, name: str, actuator: ActuatorSection, kind: JointKind, diagnostics: Diagnostics
) -> None:
    who, known = f"actuator '{name}'", settings_of(kind)
    for key, value, field in (("kp", actuator.kp, "stiffness"), ("kv", actuator.kv, "damping")):
        check_unit(sidecar, who, kind, value.dimension, known[field], ("actuators", name, key), diagnostics)
    if kind is not JointKind.PRISMATIC:
        check_unit(sidecar, who, kind, actuator.gear.dimension, _GEAR, ("actuators", name, "gear"), diagnostics)
    for field in LimitsSection.model_fields:
        bound = getattr(actuator.limits, field)
        if bound is not None and field in known:
            keys = ("actuators", name, "limits", field)
            check_unit(sidecar, who, kind, bound.dimension, known[field], keys, diagnostics)


def _check_gains(sidecar: Sidecar, name: str, actuator: ActuatorSection, diagnostics: Diagnostics) -> None:
    who, kind = f"actuator '{name}'", actuator.kind
    for gain in ("kp", "kv"):
        if gain in actuator.model_fields_set and gain not in _GAINS[kind]:
            help = [f"{kind.value} for {gain}" for kind, gains in _GAINS.items() if gain in gains]
            message = f"{who}: '{gain}' is not valid for kind {kind}"
            diagnostics.add(
                "SB137", message, sidecar.key_span("actuators", name, gain), help=[f"valid kinds: {', '.join(help)}"]
            )
    needed = _NEEDED_GAIN.get(kind)
    if actuator.gains is not None:
        _check_computed_gains(sidecar, name, actuator, diagnostics)
    elif needed is not None and needed not in actuator.model_fields_set and actuator.motor is None:
        message = f"{who}: missing key '{needed}', required for kind {kind}"
        help = [f"example: `{needed}: 100`", "or `gains: auto`, to compute the gains"]
        diagnostics.add("SB121", message, sidecar.key_span("actuators", name), help=help)
    if needed in actuator.model_fields_set and getattr(actuator, needed) == 0.0:
        message = f"{who}: {needed}: must be greater than 0 for kind {kind}"
        help = [f"remove the actuator, or use kind {ActuatorKind.MOTOR} for an effort without feedback"]
        diagnostics.add("SB125", message, sidecar.span("actuators", name, needed), help=help)
    if actuator.gear == 0.0:
        diagnostics.add("SB125", f"{who}: gear: ratio must not be 0", sidecar.span("actuators", name, "gear"))


def _check_computed_gains(sidecar: Sidecar, name: str, actuator: ActuatorSection, diagnostics: Diagnostics) -> None:
    """Report computed gains of a kind without gains, beside given ones, and a damping ratio without effect."""
    who, kind, place = f"actuator '{name}'", actuator.kind, sidecar.key_span("actuators", name, "gains")
    if kind is ActuatorKind.MOTOR:
        help = ["valid kinds: position, velocity"]
        diagnostics.add("SB137", f"{who}: 'gains' is not valid for kind {kind}", place, help=help)
    given = [gain for gain in ("kp", "kv") if gain in actuator.model_fields_set]
    if given:
        message = f"{who}: both 'gains' and '{given[0]}'"
        diagnostics.add("SB137", message, place, help=["keep `gains` to compute both gains, or remove it"])
    ratio = isinstance(actuator.gains, GainsSection) and "damping_ratio" in actuator.gains.model_fields_set
    if kind is ActuatorKind.VELOCITY and ratio:
        span = sidecar.key_span("actuators", name, "gains", "damping_ratio")
        message = f"{who}: 'gains.damping_ratio' is not valid for kind {kind}"
        diagnostics.add("SB137", message, span, help=["valid kinds: position"])


def _check_bounds(sidecar: Sidecar, name: str, actuator: ActuatorSection, diagnostics: Diagnostics) -> None:
    who, kind, limits = f"actuator '{name}'", actuator.kind, actuator.limits
    for field in LimitsSection.model_fields:
        if field in limits.model_fields_set and field not in _BOUNDS[kind]:
            message = f"{who}: 'limits.{field}' is not valid for kind {kind}"
            help = [f"valid limits: {', '.join(_BOUNDS[kind])}"]
            diagnostics.add("SB137", message, sidecar.key_span("actuators", name, "limits", field), help=help)
    if limits.lower is not None and limits.upper is not None and limits.lower.value >= limits.upper.value:
        message = f"{who}: lower {limits.lower.value:g} is not below upper {limits.upper.value:g}"
        diagnostics.add("SB456", message, sidecar.span("actuators", name, "limits", "lower"))


def check_sensors(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report, sensor by sensor, SB125, SB136 and SB137."""
    document = sidecar.document
    moved = {joint.child for joint in document.joints.values()}
    for name, sensor in document.sensors.items():
        who, place = f"sensor '{name}'", sidecar.key_span("sensors", name)
        for key, kinds in _KINDS_WITH.items():
            if key in sensor.model_fields_set and sensor.type not in kinds:
                help = [f"valid types: {', '.join(kinds)}"]
                message = f"{who}: '{key}' is not valid for type {sensor.type}"
                diagnostics.add("SB137", message, sidecar.key_span("sensors", name, key), help=help)
        if sensor.type is SensorKind.FORCE_TORQUE and sensor.link in document.links and sensor.link not in moved:
            message = f"{who}: link '{sensor.link}' has no parent joint, so there is no force to measure"
            help = ["use a joint, or a link with a parent joint"]
            diagnostics.add("SB136", message, place, help=help)
        joint = document.joints.get(sensor.joint or "")
        if sensor.type is SensorKind.JOINT and joint is not None and joint.type is JointKind.FIXED:
            diagnostics.add("SB136", f"{who}: joint '{sensor.joint}' is fixed and has no position to measure", place)
        _check_view(sidecar, name, sensor, diagnostics)


def _check_view(sidecar: Sidecar, name: str, sensor: SensorSection, diagnostics: Diagnostics) -> None:
    """Report invalid fields of view, sample counts and ranges."""
    who = f"sensor '{name}'"
    if sensor.type is SensorKind.CAMERA and sensor.fov is not None and not 0.0 < sensor.fov < pi:
        message = f"{who}: fov: must be between 0 and 180 deg for a camera"
        diagnostics.add("SB125", message, sidecar.span("sensors", name, "fov"))
    elif sensor.type is SensorKind.LIDAR and (sensor.fov == 0.0) != (sensor.samples == 1):
        message = f"{who}: a field of view of 0 requires 1 sample, and 1 sample requires a field of view of 0"
        diagnostics.add(
            "SB125", message, sidecar.key_span("sensors", name), help=["a single ray along x is `fov: 0, samples: 1`"]
        )
    if sensor.type is SensorKind.LIDAR and (sensor.samples or 0) > MOST_RAYS:
        message = f"{who}: samples: {sensor.samples} exceeds the maximum of {MOST_RAYS}"
        diagnostics.add("SB125", message, sidecar.span("sensors", name, "samples"))
    if sensor.range is not None and sensor.range[0] >= sensor.range[1]:
        message = f"{who}: range: minimum is not below maximum"
        diagnostics.add("SB125", message, sidecar.span("sensors", name, "range"))
