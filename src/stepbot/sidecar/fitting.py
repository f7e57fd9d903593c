"""Gives each actuator what its motor gives it, where no key of the sidecar does."""

import glob
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msgspec.structs import replace
from pydantic import ValidationError

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.robot.model import ActuatorKind, JointKind
from stepbot.robot.motors import Motor
from stepbot.runtime.file import is_file, is_folder

from .devices import ActuatorSection
from .document import JointDefaults
from .joint_settings import ONE_FREEDOM
from .located import Sidecar
from .motion import DynamicsSection, LimitsSection
from .motor_sections import MotorSection, OwnMotors
from .motors import (
    AmbiguousMotor,
    NamedMotor,
    UnknownMotor,
    UnknownSupply,
    UnscalableMotor,
    at_other_supplies,
    default_kind,
    find_motor,
    fitted,
)
from .own_part import is_foreign
from .quantities import JointValue
from .schema_faults import report_schema_faults
from .syntax_faults import compose_around_faults
from .text import is_text, read_text
from .tree import Mapping as TreeMapping
from .tree import Tree, key_span, plain_data

_DESCRIPTIONS = (".urdf", ".xacro", ".sdf", ".xml", ".mjcf")
_LIMITS = ("effort", "velocity")
_DYNAMICS = ("damping", "friction", "armature")


def with_motors(sidecar: Sidecar, diagnostics: Diagnostics) -> Sidecar:
    """The sidecar with the figures of its motors; a motor's are the last defaults of its joint."""
    document = sidecar.document
    own = _own_motors(sidecar, diagnostics)
    sidecar = replace(sidecar, own_motors={**sidecar.own_motors, **(own or {})})
    motors: dict[str, Motor] = {}
    actuators, defaults = dict(document.actuators), dict(document.joint_defaults)
    for name, actuator in document.actuators.items():
        joint = document.joints.get(actuator.joint)
        kind = joint.type if joint is not None else JointKind.REVOLUTE
        if actuator.motor is None or kind not in ONE_FREEDOM:
            continue
        if joint is None and is_foreign(document, actuator.joint):
            message = f"actuator '{name}': joint '{actuator.joint}' is in a module"
            module, _, own_name = actuator.joint.partition("/")
            help = ["name the motor in the module's own file, which has the limits and dynamics of the joint"]
            section = document.modules.get(module)
            if section is not None and (section.file or "").lower().endswith(_DESCRIPTIONS):  # it has no motors
                values = f"{{actuators: {{{name}: {{joint: {own_name}, motor: {actuator.motor}}}}}}}"
                help = [f"`set: {values}` of module '{module}'"]
            diagnostics.add("SB148", message, sidecar.span("actuators", name, "motor"), help=help)
            continue
        one = _motor_of(sidecar, name, actuator, is_known=own is not None, diagnostics=diagnostics)
        motor = _fitted(sidecar, name, actuator, one, kind, diagnostics) if one is not None else None
        if one is None or motor is None:
            continue
        motors[name] = motor
        actuators[name] = _driven(actuator, motor, one, kind)
        if joint is not None:
            defaults.setdefault(_only(actuator.joint), _defaults(actuator, motor))
    _report_doubts(sidecar, motors, diagnostics)
    if not motors:
        return sidecar
    update = {"actuators": actuators, "joint_defaults": defaults}
    return replace(sidecar, document=document.model_copy(update=update), motors=motors)


def _only(joint: str) -> str:
    """A pattern that matches this joint alone, and is no pattern that a user writes."""
    return f"[{joint[0]}]{glob.escape(joint[1:])}" if joint[0] not in "[]!" else glob.escape(joint)


def _own_motors(sidecar: Sidecar, diagnostics: Diagnostics) -> Mapping[str, MotorSection] | None:
    """The user's own motors, each figure with a source; None if their file cannot be read, which is reported."""
    given = sidecar.document.motors
    if not isinstance(given, str):
        _check_sources(sidecar.root, given, diagnostics)
        return given
    path = sidecar.path.parent / given
    if not is_file(path):
        beside = [one.name for one in path.parent.iterdir()] if is_folder(path.parent) else []
        where = f"`motors` is relative to {sidecar.path.name}"
        if sidecar.is_changed:
            where += "; modules can also use those at the top of the composing file"
        help = (*did_you_mean(path.name, sorted(beside)), where)
        diagnostics.add("SB001", f"motors: file '{given}' not found", sidecar.span("motors"), help=help)
        return None
    return read_own_motors(path, diagnostics)


def read_own_motors(path: Path, diagnostics: Diagnostics) -> dict[str, MotorSection] | None:
    """The motors of a user's own file, each figure with a source; None if it cannot be read, which is reported."""
    text = read_text(path, diagnostics, "write `motors: {NAME: {kind: servo, ...}}`")
    if text is None or not is_text(text, path.as_posix(), diagnostics):
        return None
    composed = compose_around_faults(text, path.as_posix(), diagnostics)
    root = composed.tree
    if not isinstance(root, TreeMapping) or tuple(root.entries) != ("motors",):
        if root is not None and composed.whole:
            message = "motors: a file of motors has the single key `motors`"
            diagnostics.add("SB120", message, root.span, help=["write `motors: {NAME: {kind: servo, ...}}`"])
        return None
    try:
        own = OwnMotors.model_validate(plain_data(root)).motors
    except ValidationError as failure:
        report_schema_faults(failure, root, composed.whole, diagnostics)
        return None
    _check_sources(root, own, diagnostics)
    return own


def _check_sources(root: Tree, own: Mapping[str, MotorSection], diagnostics: Diagnostics) -> None:
    """Report figures without a source (SB121)."""
    for name, motor in own.items():
        without = [key for key, figure in motor.figures().items() if not figure.source]
        without += [f"at_other_voltages[{i}]" for i, at in enumerate(motor.at_other_voltages) if not at.source]
        if without and motor.source is None:
            message = f"motor '{name}': no source for {', '.join(without)}"
            help = ["write `source: ...` for the motor, or `{value: ..., source: ...}` for a figure"]
            diagnostics.add("SB121", message, key_span(root, ("motors", name, without[0].partition("[")[0])), help=help)


def _motor_of(
    sidecar: Sidecar, name: str, actuator: ActuatorSection, *, is_known: bool, diagnostics: Diagnostics
) -> NamedMotor | None:
    """The motor of an actuator; None if there is none, which is reported, if the user's own are known."""
    assert actuator.motor is not None
    place = sidecar.span("actuators", name, "motor")
    try:
        return find_motor(actuator.motor, sidecar.own_motors)
    except AmbiguousMotor as several:
        message = f"actuator '{name}': {several}; which one is it?"
        diagnostics.add("SB147", message, place, help=[f"members: {', '.join(several.members)}"])
    except UnknownMotor as unknown:
        if not is_known:
            return None
        near = f"did you mean {' or '.join(unknown.nearest)}?" if unknown.nearest else "`stepbot motors` lists all"
        help = [near, "describe another one under `motors`, with the source of each figure"]
        diagnostics.add("SB147", f"actuator '{name}': {unknown}", place, help=help)
    return None


def _fitted(
    sidecar: Sidecar, name: str, actuator: ActuatorSection, one: NamedMotor, kind: JointKind, diagnostics: Diagnostics
) -> Motor | None:
    message, help, key = "", "", "motor"
    if kind is JointKind.PRISMATIC and "gear" not in actuator.model_fields_set and one.motor.max_force is None:
        message = f"'{one.name}' turns, and joint '{actuator.joint}' slides"
        help = "give `gear`, as `36 deg/mm` or in rad/m: 2 pi / lead of a screw, 1 / radius of a pinion or pulley"
    elif actuator.gear != 0.0:
        try:
            return fitted(one, kind, actuator.voltage, actuator.gear.value, actuator.part or "")
        except UnscalableMotor as failure:
            message, help = str(failure), "choose another motor, or give `limits` and `dynamics` by hand"
            if isinstance(failure, UnknownSupply):
                others = ", ".join(at_other_supplies(one))
                key, help = "voltage", f"{help}; of its family: {others}" if others else help
    if message:
        place = sidecar.span("actuators", name, key)
        diagnostics.add("SB148", f"actuator '{name}': {message}", place, help=[help])
    return None


def _driven(actuator: ActuatorSection, motor: Motor, one: NamedMotor, joint: JointKind) -> ActuatorSection:
    """The actuator with its kind and gains: those of the firmware, or computed ones."""
    update: dict[str, Any] = {}
    kind, given = actuator.kind, actuator.model_fields_set
    if "kind" not in given:
        kind = update["kind"] = default_kind(one.motor, joint)
    if kind is not ActuatorKind.MOTOR and not given & {"kp", "kv", "gains"}:
        firmware = motor.figure("kp") if kind is ActuatorKind.POSITION else None
        if firmware is not None:
            update["kp"] = JointValue(firmware.value)
        else:
            update["gains"] = "auto"
    return actuator.model_copy(update=update) if update else actuator


def _defaults(actuator: ActuatorSection, motor: Motor) -> JointDefaults:
    """What a motor gives its joint; limits of the actuator take precedence."""

    def figures(fields: tuple[str, ...]) -> dict[str, Any]:
        given = {field: figure for field in fields if (figure := motor.figure(field)) is not None}
        return {field: JointValue(figure.value) for field, figure in given.items() if figure.value}

    own = {field: bound for field in _LIMITS if (bound := getattr(actuator.limits, field)) is not None}
    limits = LimitsSection.model_construct(None, **figures(_LIMITS) | own)
    dynamics = DynamicsSection.model_construct(None, **figures(_DYNAMICS))
    return JointDefaults.model_construct(None, limits=limits, dynamics=dynamics)


def _report_doubts(sidecar: Sidecar, motors: Mapping[str, Motor], diagnostics: Diagnostics) -> None:
    """Report, once for each motor, doubts about its figures, and those that no source gives (SB149)."""
    reported: set[str] = set()
    for name, motor in motors.items():
        if motor.name in reported or not (motor.doubts or motor.unknown):
            continue
        reported.add(motor.name)
        users = [one for one, other in motors.items() if other.name == motor.name]
        notes = [f"no source gives its {', '.join(motor.unknown)}"] if motor.unknown else []
        what = "doubtful figures" if motor.doubts else "unknown figures"
        message = (
            f"actuator '{name}'{f' and {len(users) - 1} more' if len(users) > 1 else ''}: {what} of '{motor.name}'"
        )
        help = [f"sources: `stepbot motors {motor.name}`; `limits` and `dynamics` of the joint override its figures"]
        diagnostics.add(
            "SB149", message, sidecar.span("actuators", name, "motor"), help=help, notes=(*motor.doubts, *notes)
        )
