"""A robot as the values of a sidecar: what a description states, in the words in which a sidecar changes it."""

from collections.abc import Mapping
from math import inf, isfinite
from typing import Any

from stepbot.geometry.spatial import Pose
from stepbot.robot.joint_types import kinds_with
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointDynamics, JointKind, Limit, Link, Robot
from stepbot.robot.sensors import PLACED, SEEING, Sensor, SensorKind

from . import VERSION
from .joint_settings import settings_of

Json = dict[str, Any]
_BOUNDED = kinds_with(bounded=True)
_WITH_AXIS = kinds_with(has_axis=True)
_SINGLE = kinds_with(coordinates=1)


def values_of(robot: Robot, source: str, kinds: Mapping[str, object]) -> Json:
    """The values of a robot, in SI; what a sidecar cannot express, such as an effort limit of 0, is left out.

    Args:
        kinds: Types that joints get; a joint that gets another one keeps no settings, which have other units.
    """
    return {
        "version": VERSION,
        "robot": robot.name,
        "step": source,
        "base": robot.base.value,
        "links": {link.name: _link(link) for link in robot.links},
        "joints": {joint.name: _joint(joint, kinds.get(joint.name, joint.kind)) for joint in robot.joints},
        "frames": {
            frame.name: {"link": frame.link, "origin": _origin(frame.X_LF, frame.link)} for frame in robot.frames
        },
        "actuators": {actuator.name: _actuator(actuator) for actuator in robot.actuators},
        "sensors": {sensor.name: _sensor(sensor) for sensor in robot.sensors},
        "excluded_contacts": [list(pair) for pair in robot.excluded_contacts],
    }


def limit_values(limit: Limit) -> Json:
    """The limits that a sidecar can state."""
    values = {name: getattr(limit, name) for name in ("velocity", "effort", "acceleration", "deceleration", "jerk")}
    bounds = {name: getattr(limit, name) for name in ("lower", "upper") if isfinite(getattr(limit, name))}
    return bounds | {name: value for name, value in values.items() if 0.0 < value < inf}


def dynamics_values(dynamics: JointDynamics) -> Json:
    """The passive forces that a sidecar can state."""
    names = ("damping", "friction", "stiffness", "armature")
    values = {name: getattr(dynamics, name) for name in names if getattr(dynamics, name) > 0.0}
    return values | ({"spring_reference": dynamics.spring_reference} if dynamics.stiffness > 0.0 else {})


def _link(link: Link) -> Json:
    mass = link.mass_properties
    if not mass.mass > 0.0 or not all(mass.inertia[i][i] > 0.0 for i in range(3)):
        return {}
    axes = "xyz"
    tensor = {f"i{axes[i]}{axes[j]}": float(mass.inertia[i][j]) for i in range(3) for j in range(i, 3)}
    return {"inertial": {"mass": mass.mass, "com": list(mass.com), "inertia": tensor}}


def _joint(joint: Joint, kind: object) -> Json:
    made: Json = {"type": joint.kind.value, "parent": joint.parent, "child": joint.child}
    made["origin"] = _origin(joint.X_PC, joint.parent)
    if joint.kind.has_axis and kind in _WITH_AXIS:
        made["axis"] = list(joint.axis)
    if kind != joint.kind:
        return made
    known = settings_of(joint.kind)
    limits = {key: value for key, value in limit_values(joint.limit).items() if key in known}
    if joint.kind in _BOUNDED:
        limits = {"lower": limits.get("lower", "-inf"), "upper": limits.get("upper", "inf"), **limits}
    dynamics = {key: value for key, value in dynamics_values(joint.dynamics).items() if key in known}
    made |= {key: value for key, value in (("limits", limits), ("dynamics", dynamics)) if value}
    if joint.kind is JointKind.UNIVERSAL:
        made["axis2"] = list(joint.axis2)
    if joint.mimic is not None:
        made["mimic"] = {"joint": joint.mimic.joint, "multiplier": joint.mimic.multiplier, "offset": joint.mimic.offset}
    if joint.kind in _SINGLE and joint.drawn_position and joint.mimic is None:
        made["zero"] = joint.drawn_position
    return made | ({"pitch": joint.pitch} if joint.pitch else {})


def _origin(pose: Pose, link: str) -> Json:
    return {"xyz": list(pose.position), "rpy": list(pose.rpy), "relative_to": link}


def _actuator(actuator: Actuator) -> Json:
    made: Json = {"joint": actuator.joint, "kind": actuator.kind.value, "gear": actuator.gear}
    if actuator.tuning is None and actuator.kind is not ActuatorKind.MOTOR:
        made |= {key: getattr(actuator, key) for key in ("kp", "kv") if getattr(actuator, key) > 0.0}
    elif actuator.tuning is not None:
        made["gains"] = "auto"
    limits = limit_values(actuator.limit)
    return made | ({"limits": limits} if limits else {})


def _sensor(sensor: Sensor) -> Json:
    made: Json = {"type": sensor.kind.value, **({"joint": sensor.joint} if sensor.joint else {"link": sensor.link})}
    if sensor.kind in PLACED:
        made["origin"] = _origin(sensor.X_LS, sensor.link)
    if sensor.rate:
        made["rate"] = sensor.rate
    if sensor.kind in SEEING:
        view = sensor.view
        made |= {"fov": view.fov} if view.fov else {}
        pixels = view.columns and view.rows
        made |= {"samples": view.columns} if sensor.kind is SensorKind.LIDAR and view.columns else {}
        made |= {"resolution": [view.columns, view.rows]} if sensor.kind is SensorKind.CAMERA and pixels else {}
        made |= {"range": [view.nearest, view.farthest]} if isfinite(view.farthest) else {}
    return made
