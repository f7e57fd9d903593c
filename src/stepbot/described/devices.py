"""The actuators and sensors of a description."""

from collections.abc import Iterable, Mapping, Sequence
from math import inf, isfinite

from msgspec.structs import replace

from stepbot.engines.description import Description
from stepbot.engines.observation import Observation, ObservedActuator, ObservedSensor, Quantity
from stepbot.geometry.spatial import IDENTITY
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Limit
from stepbot.robot.sensors import MOST_RAYS, PLACED, SEEING, Sensor, SensorKind, View
from stepbot.robot.tuning import Tuning

from .finding import DEVICE, RENAMED, Finding

_ON_JOINTS = (SensorKind.JOINT, SensorKind.FORCE_TORQUE)


def actuators_of(
    description: Description, joints: Mapping[str, Joint], findings: list[Finding]
) -> tuple[Actuator, ...]:
    """The actuators that move one joint; others are listed."""
    actuators = []
    taken: set[str] = set()
    for alternative in _without_alternatives(description.observation, findings):
        joint = joints.get(alternative.joint)
        powerless = _powerless(alternative)
        known = alternative.kind in set(ActuatorKind)
        leader = joint.mimic.joint if joint is not None and joint.mimic is not None else ""
        is_led = (
            bool(leader) and known and _gain(alternative) is None
        )  # what follows has no motion to compute gains for
        if joint is None or joint.kind is JointKind.FIXED or not known or powerless or is_led:
            on = f" on '{alternative.joint}'" if alternative.joint else ""
            why = f" with a {powerless} of 0" if powerless else f", which follows '{leader}'" if is_led else ""
            text = f"actuator '{alternative.name}' of type '{alternative.kind}'{on}{why}: not converted"
            findings.append(Finding(DEVICE, text, (Quantity.ACTUATORS,)))
            continue
        name = free_name(alternative.name or f"{alternative.joint}_{alternative.kind}", "_2", taken)
        gear = alternative.gear or 1.0
        limit = _own_limit(alternative, name, gear, joint.limit, findings)
        tuning = Tuning(at_least=True, assumed=True) if _gain(alternative) is None else None
        kp, kv = (0.0, 0.0) if tuning else (alternative.kp or 0.0, alternative.kv or 0.0)
        actuators.append(Actuator(name, alternative.joint, ActuatorKind(alternative.kind), kp, kv, gear, limit, tuning))
    return tuple(actuators)


def _without_alternatives(observation: Observation, findings: list[Finding]) -> list[ObservedActuator]:
    """The actuators without the further command interfaces of a URDF's joint: ros2_control claims one at a time.

    Of those without a transmission the first of position, velocity and effort stays, if no transmission drives the
    joint: together, a velocity input of 0 would brake what the position input moves.
    """
    every, order = list(observation.actuators or ()), [kind.value for kind in ActuatorKind]
    if observation.format != "urdf":
        return every
    claimed: dict[str, ObservedActuator] = {}
    for one in sorted(
        every, key=lambda one: (not one.name, order.index(one.kind) if one.kind in order else len(order))
    ):
        claimed.setdefault(one.joint, one)
    kept = []
    for one in every:
        first = claimed[one.joint]
        if one.name or first is one:
            kept.append(one)
            continue
        text = (
            f"command interface of type '{one.kind}' on '{one.joint}': not converted, as that of type '{first.kind}' is"
        )
        findings.append(Finding(DEVICE, text, (Quantity.ACTUATORS,)))
    return kept


def _gain(actuator: ObservedActuator) -> float | None:
    """The gain without which an actuator exerts no force, 1 for motors; None if the file gives none."""
    return {ActuatorKind.POSITION: actuator.kp, ActuatorKind.VELOCITY: actuator.kv}.get(
        ActuatorKind(actuator.kind), 1.0
    )


def _powerless(actuator: ObservedActuator) -> str:
    """What makes an actuator exert no force; empty if nothing does."""
    if actuator.gear == 0.0:
        return "gear"
    return "gain" if actuator.kind in set(ActuatorKind) and _gain(actuator) == 0.0 else ""


def _own_limit(actuator: ObservedActuator, name: str, gear: float, joint: Limit, findings: list[Finding]) -> Limit:
    """What the actuator's ranges limit beyond its joint, at the joint."""
    motor = actuator.kind == ActuatorKind.MOTOR
    low, high = sorted(bound * (gear if motor else 1.0 / gear) for bound in actuator.control or (-inf, inf))
    force = sorted(bound * gear for bound in actuator.force or (-inf, inf))
    effort = _symmetric(force[0], force[1], f"actuator '{name}': force", findings)
    limit = Limit()
    if actuator.kind == ActuatorKind.POSITION:
        limit = Limit(low, high, effort=effort)
        if actuator.control is not None and (-inf < low < joint.lower or inf > high > joint.upper):
            text = f"actuator '{name}': inputs beyond the limits of joint '{actuator.joint}' are not converted"
            findings.append(Finding(DEVICE, f"{text}: {max(low, joint.lower):g} to {min(high, joint.upper):g} taken"))
    elif actuator.kind == ActuatorKind.VELOCITY:
        limit = Limit(velocity=_symmetric(low, high, f"actuator '{name}': speed", findings), effort=effort)
    elif motor:
        limit = Limit(effort=min(_symmetric(low, high, f"actuator '{name}': control", findings), effort))
    return Limit(
        limit.lower if limit.lower > joint.lower else -inf,
        limit.upper if limit.upper < joint.upper else inf,
        limit.velocity if limit.velocity < joint.velocity else inf,
        limit.effort if limit.effort < joint.effort else inf,
    )


def _symmetric(low: float, high: float, what: str, findings: list[Finding]) -> float:
    """The bound of both sides of a range; of one that is not symmetric, that of the narrower side, unless it is 0."""
    narrow, wide = sorted((abs(low), abs(high)))
    if narrow != wide:
        bounds = f"from {low + 0.0:g} to {high + 0.0:g} at the joint"
        text = f"{what} {bounds}: not symmetric, {narrow or wide:g} taken for both directions"
        findings.append(Finding(DEVICE, text, (Quantity.ACTUATORS,)))
    return narrow or wide


def sensors_of(
    seen: Iterable[ObservedSensor], joints: Sequence[Joint], links: set[str], findings: list[Finding]
) -> tuple[Sensor, ...]:
    """The sensors of the model's kinds; others are listed."""
    children = {joint.name: joint.child for joint in joints}
    sensors = []
    taken: set[str] = set()
    for number, one in enumerate(seen, start=1):
        kind = SensorKind(one.kind) if one.kind in set(SensorKind) else None
        name = one.name and free_name(one.name, "_2", taken)  # a name is used twice, such as by sensors of two links
        link = children.get(one.joint or "", "") if kind in _ON_JOINTS else one.link
        if kind is None or not link or link not in links:
            findings.append(
                Finding(DEVICE, f"sensor '{one.name}' of type '{one.kind}': not converted", (Quantity.SENSORS,))
            )
            continue
        if kind in SEEING and any(count is not None and count < 1 for count in (one.columns, one.rows)):
            text = f"sensor '{one.name}': {one.columns} x {one.rows} pixels or rays: not converted"
            findings.append(Finding(DEVICE, text, (Quantity.SENSORS,)))
            continue
        if kind is SensorKind.LIDAR and (one.columns or 0) > MOST_RAYS:
            text = f"sensor '{one.name}': {one.columns} rays, more than {MOST_RAYS}: not converted"
            findings.append(Finding(DEVICE, text, (Quantity.SENSORS,)))
            continue
        if kind is SensorKind.LIDAR and (one.rows or 1) > 1:
            text = f"sensor '{one.name}': {one.rows} rows of rays: one converted, level with its frame"
            findings.append(Finding(DEVICE, text, (Quantity.SENSORS,)))
            one = replace(one, rows=1)
        if name != one.name:
            findings.append(Finding(RENAMED, f"sensor '{one.name}' of link '{link}' is renamed to '{name}'"))
        name = name or free_name(f"{one.joint or link}_{kind.value}_{number}", "_2", taken)
        X_LS = (one.X_LS or IDENTITY) if kind in PLACED else IDENTITY
        joint = (one.joint or "") if kind in _ON_JOINTS else ""
        view = _view(one) if kind in SEEING else View()
        sensors.append(Sensor(name, kind, link, X_LS, joint, one.rate or 0.0, view))
    return tuple(sensors)


def _view(sensor: ObservedSensor) -> View:
    farthest = (
        sensor.farthest if sensor.farthest is not None and isfinite(sensor.farthest) and sensor.farthest > 0.0 else inf
    )
    return View(sensor.fov or 0.0, sensor.columns or 0, sensor.rows or 0, sensor.nearest or 0.0, farthest)
