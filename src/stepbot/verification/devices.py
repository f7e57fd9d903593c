"""Compares actuators and sensors, paired by name, or by joint if they have no names."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf, isfinite
from typing import TypeVar

from stepbot.engines.observation import Observation, ObservedActuator, ObservedSensor
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.robot.model import ActuatorKind

from .deviation import Deviations

Device = TypeVar("Device", ObservedActuator, ObservedSensor)

_ROUNDING = 1e-6
"""Relative error of a bound that was divided by the gear and multiplied again, in single precision."""
_UNITS = {"rate": "Hz", "fov": "rad", "columns": "pixels", "rows": "pixels", "nearest": "m", "farthest": "m"}


def compare_actuators(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Joint, kind, gear, gains, and the bounds of input and force."""
    if reference.actuators is not None and observed.actuators is not None:
        _compare_devices(deviations, "actuator", reference.actuators, observed.actuators, _compare_actuator)


def compare_sensors(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Kind, link, joint, pose, rate, and field of view."""
    if reference.sensors is not None and observed.sensors is not None:
        _compare_devices(deviations, "sensor", reference.sensors, observed.sensors, _compare_sensor)


def _compare_devices(
    deviations: Deviations,
    what: str,
    reference: Sequence[Device],
    observed: Sequence[Device],
    compare: Callable[[Deviations, Device, Device], None],
) -> None:
    """Compare pairs; a device on one side only is a failure."""
    ours: list[Device] = _named(reference, observed)
    theirs: list[Device] = _named(observed, reference)
    pairs = {device.name: device for device in ours}
    for name in dict.fromkeys(device.name for device in (*ours, *theirs)):
        expected, found = _count(ours, name), _count(theirs, name)
        wrong = "is missing" if found < expected else "is not in the robot"
        deviations.equal(expected == found, f"{what} '{name}' {wrong}")
    for device in theirs:
        if device.name in pairs:
            compare(deviations, pairs[device.name], device)


def _count(devices: Sequence[Device], name: str) -> int:
    return sum(device.name == name for device in devices)


def _named(devices: Sequence[Device], others: Sequence[Device]) -> list[Device]:
    """The devices by name if the other side has the same name on the same joint, or else by joint."""
    free = [other for other in others if other.name and all(other.name != device.name for device in devices)]
    named = []
    for device in devices:
        if not device.name:
            like = [other for other in free if (other.kind, other.joint) == (device.kind, device.joint)]
            free = [other for other in free if other not in like[:1]]
            device = replace(device, name=like[0].name if like else f"{device.kind} of {device.joint}")
        named.append(device)
    return named


def _compare_actuator(deviations: Deviations, a: ObservedActuator, b: ObservedActuator) -> None:
    who = f"actuator '{a.name}'"
    deviations.equal(a.joint == b.joint, f"{who}: on joint '{b.joint}', '{a.joint}' expected")
    deviations.equal(a.kind == b.kind, f"{who}: {b.kind}, {a.kind} expected")
    for name in ("gear", "kp", "kv"):
        expected, seen = getattr(a, name), getattr(b, name)
        if expected is not None and seen is not None:
            deviations.near(seen, expected, f"{name} of {who}", "SI", abs(expected))
        elif name != "gear" and expected:  # formats without gears have gains, too, and 0 may be left out
            deviations.equal(False, f"{who}: no {name}, {expected} expected")
        elif name != "gear" and seen is not None:
            deviations.untold.append(name)
    for name in ("control", "force"):
        bounds, found = getattr(a, name), getattr(b, name)
        if bounds is None or found is None:
            if bounds is not None and any(map(isfinite, bounds)):
                deviations.untold.append(f"{name} range")
            continue
        ranges = _both_or_none(bounds, _at_joint(a, name)), _both_or_none(found, _at_joint(b, name))
        for side, wanted, given in zip(("lowest", "highest"), *ranges, strict=True):
            deviations.near(given, wanted, f"{side} {name} of {who}", "SI", abs(wanted) if isfinite(wanted) else 0.0)


def _at_joint(drive: ObservedActuator, what: str) -> float:
    """Factor from the actuator to its joint, of inputs or forces."""
    gear = abs(drive.gear or 1.0)
    return gear if what == "force" or drive.kind == ActuatorKind.MOTOR else 1.0 / gear


def _both_or_none(bounds: tuple[float, float], at_joint: float) -> tuple[float, float]:
    """A range; one that is unbounded on one side, or has a number that means unlimited at the joint, is unlimited."""
    return bounds if all(abs(bound) * at_joint < UNLIMITED * (1.0 - _ROUNDING) for bound in bounds) else (-inf, inf)


def _compare_sensor(deviations: Deviations, a: ObservedSensor, b: ObservedSensor) -> None:
    who = f"sensor '{a.name}'"
    deviations.equal(a.kind == b.kind, f"{who}: {b.kind}, {a.kind} expected")
    for name in ("link", "joint"):
        expected, found = getattr(a, name), getattr(b, name)
        if expected is not None and found is not None:
            deviations.equal(expected == found, f"{who}: on {name} '{found}', '{expected}' expected")
    if a.X_LS is not None and b.X_LS is not None:
        distance, angle = a.X_LS.distance_to(b.X_LS)
        deviations.off(distance, f"place of {who}", "m")
        deviations.off(angle, f"place of {who}", "rad")
    for name, unit in _UNITS.items():
        expected, found = getattr(a, name), getattr(b, name)
        if expected is not None and found is not None:
            deviations.near(found, expected, f"{name} of {who}", unit, abs(expected) if isfinite(expected) else 0.0)
        elif expected:
            deviations.untold.append(name)
