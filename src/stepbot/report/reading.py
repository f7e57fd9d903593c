"""The robot of a ``report.json``, the inverse of :mod:`stepbot.report.robot`: everything but shapes and sensors."""

from collections.abc import Mapping
from math import inf
from typing import Any

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose, matrix3, vector3
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Frame,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    Mimic,
    Robot,
)
from stepbot.robot.tuning import Tuning

Json = Mapping[str, Any]

_UNUSED_AXIS = (0.0, 0.0, 1.0)
_UNUSED_AXIS2 = (1.0, 0.0, 0.0)


def robot_of_report(document: Json) -> Robot:
    """The robot of a parsed ``report.json``, without shapes and sensors.

    Raises:
        KeyError, TypeError, ValueError: The document does not have the report's schema, or has no robot.
    """
    content = document["robot"]
    return Robot(
        name=str(content["name"]),
        links=tuple(Link(one["name"], _mass(one)) for one in content["links"]),
        joints=tuple(_joint(one) for one in content["joints"]),
        closures=tuple(_closure(one) for one in content["closures"]),
        frames=tuple(Frame(one["name"], one["link"], _pose(one["pose"]), one["source"]) for one in content["frames"]),
        actuators=tuple(_actuator(one) for one in content["actuators"]),
        base=Base(content["base"]),
        source=str(content["source"]),
    )


def _mass(content: Json) -> MassProperties:
    return MassProperties(float(content["mass"]), vector3(content["com"]), matrix3(content["inertia"]))


def _pose(content: Json) -> Pose:
    return Pose.from_xyz_rpy(content["xyz"], content["rpy"])


def _limit(content: Json) -> Limit:
    lower, upper, velocity, effort = (content[name] for name in ("lower", "upper", "velocity", "effort"))
    return Limit(
        lower=-inf if lower is None else float(lower),
        upper=inf if upper is None else float(upper),
        velocity=inf if velocity is None else float(velocity),
        effort=inf if effort is None else float(effort),
    )


def _joint(content: Json) -> Joint:
    mimic = content["mimic"]
    return Joint(
        name=content["name"],
        kind=JointKind(content["kind"]),
        parent=content["parent"],
        child=content["child"],
        X_PC=_pose(content["pose"]),
        axis=vector3(content["axis"] or _UNUSED_AXIS),
        axis2=vector3(content["axis2"] or _UNUSED_AXIS2),
        limit=_limit(content["limits"]),
        dynamics=JointDynamics(**{name: float(value) for name, value in content["dynamics"].items()}),
        mimic=None if mimic is None else Mimic(mimic["joint"], float(mimic["multiplier"]), float(mimic["offset"])),
        pitch=float(content["pitch"] or 0.0),
        drawn_position=float(content["drawn_position"]),
    )


def _closure(content: Json) -> LoopClosure:
    return LoopClosure(
        name=content["name"],
        kind=JointKind(content["kind"]),
        link_a=content["link_a"],
        X_AF=_pose(content["pose_a"]),
        link_b=content["link_b"],
        X_BF=_pose(content["pose_b"]),
        axis=vector3(content["axis"]),
    )


def _actuator(content: Json) -> Actuator:
    return Actuator(
        name=content["name"],
        joint=content["joint"],
        kind=ActuatorKind(content["kind"]),
        kp=float(content["kp"]),
        kv=float(content["kv"]),
        gear=float(content["gear"]),
        limit=_limit(content["limits"]),
        tuning=_tuning(content.get("computed")),
    )


def _tuning(content: Json | None) -> Tuning | None:
    if content is None:
        return None
    return Tuning(float(content["bandwidth"]), float(content["damping_ratio"]), braked=bool(content["braked"]))
