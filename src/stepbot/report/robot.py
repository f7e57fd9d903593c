"""A robot as JSON data, for ``report.json``."""

from dataclasses import dataclass
from math import isfinite
from typing import Any

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.spatial import Pose, tidy
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.loop_followers import loop_followers
from stepbot.robot.model import Actuator, Joint, JointKind, Limit, Link, LoopClosure, Module, Robot
from stepbot.robot.motors import Motor
from stepbot.robot.pybullet_closures import LoopConstraint, loop_constraints
from stepbot.robot.self_collision import PairContact, SelfCollision
from stepbot.robot.sensors import SEEING, Sensor
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.standing import standing_height
from stepbot.robot.tuning import Tuning

from .results import Check, Content, LinkCollision, Results, Row, SimplifiedVisuals, Status, WrittenFile

Json = dict[str, Any]


def self_collision_document(found: SelfCollision) -> Json:
    """All pairs with their evidence: number of poses, depth [m] and joint positions [rad] or [m] of the first one."""
    return {
        "samples": found.samples,
        "exclude": [kind.value for kind in found.exclude],
        "pairs": [_pair(pair) for pair in found.pairs],
    }


def _pair(pair: PairContact) -> Json:
    return {
        "links": [pair.link_a, pair.link_b],
        "class": pair.kind.value,
        "contacts": pair.contacts,
        "first": pair.first,
        "depth": pair.depth,
        "pose": dict(pair.pose),
    }


__all__ = [
    "Check",
    "Content",
    "LinkCollision",
    "MeasuredBody",
    "Report",
    "Results",
    "Row",
    "SimplifiedVisuals",
    "Status",
    "WrittenFile",
]


@dataclass(frozen=True)
class MeasuredBody:
    """One definition of the assembly, measured twice, at a density of 1 kg/m^3."""

    name: str
    occurrences: int
    mesh: MassProperties | None
    """By trimesh, on the written mesh."""
    exact: MassProperties | None
    """By integration over the exact solid."""
    deviation: float | None
    """The largest relative difference between the two, of volume, centre and inertia."""
    error: float | None
    """Estimated relative error of ``exact``; None without an exact solid or an estimate."""
    used: MassProperties | None
    """The one that masses are computed from; None if neither is known."""
    written: str
    """Which of the two is used in the files, and why; why the body has no mass if neither is."""


@dataclass(frozen=True)
class Report(Results):
    """The results, with the robot and its bodies."""

    robot: Robot | None = None
    bodies: tuple[MeasuredBody, ...] = ()


def number(value: float | None) -> float | None:
    """The number; null if it is NaN or infinite."""
    return float(value) if value is not None and isfinite(value) else None


def robot_document(report: Report, robot: Robot) -> Json:
    """The robot, its drawn pose, and the constraints that close its loops in PyBullet."""
    poses = link_poses(robot, initial_configuration(robot))
    total = combined(link.mass_properties.moved(tidy(poses[link.name])) for link in robot.links)
    return {
        "name": robot.name,
        "source": robot.source,
        "base": robot.base.value,
        "root": robot.root.name,
        **mass_document(total),
        "degrees_of_freedom": report.degrees_of_freedom,
        "driven": list(report.driven),
        "links": [_link(link) for link in robot.links],
        "joints": [_joint(joint) for joint in robot.joints],
        "closures": [_closure(closure) for closure in robot.closures],
        "followers": [
            {
                "joint": follower.joint,
                "leader": follower.mimic.joint,
                "multiplier": follower.mimic.multiplier,
                "offset": follower.mimic.offset,
                "deviation": follower.deviation,
            }
            for follower in loop_followers(robot)
        ],
        "pybullet": [_loop_constraint(constraint) for constraint in loop_constraints(robot)],
        "frames": [
            {"name": frame.name, "link": frame.link, "pose": _pose(frame.X_LF), "source": frame.source}
            for frame in robot.frames
        ],
        "actuators": [_actuator(actuator) for actuator in robot.actuators],
        "sensors": [_sensor(sensor) for sensor in robot.sensors],
        "standing_height": standing_height(robot, initial_configuration(robot)),
        "simulation": _simulation(robot),
        "self_collision": None if robot.self_collision is None else self_collision_document(robot.self_collision),
        "overlaps": [{"links": [a, b], "depth": depth} for a, b, depth in report.collisions],
        **({"modules": [_module(robot, module) for module in robot.modules]} if robot.modules else {}),
    }


def _module(robot: Robot, module: Module) -> Json:
    """A robot that this one is composed of, with its names here."""
    links = set(module.links)
    return {
        "name": module.name,
        "file": module.file,
        "prefix": module.prefix,
        "at": module.at or None,
        "mirror": module.mirror or None,
        "mass": exact_sum(robot.link_by_name[link].mass_properties.mass for link in module.links),
        "links": list(module.links),
        "joints": [joint.name for joint in robot.joints if joint.child in links and joint.parent in links],
    }


def mass_document(body: MassProperties) -> Json:
    """Mass, centre of mass and inertia."""
    return {"mass": body.mass, "com": list(body.com), "inertia": [list(row) for row in body.inertia]}


def _pose(X: Pose) -> Json:
    return {"xyz": list(X.position), "rpy": list(X.rpy)}


def _loop_constraint(constraint: LoopConstraint) -> Json:
    frames = {
        name: {"xyz": list(position), "quaternion": list(turn)}
        for name, (position, turn) in (("frame_a", constraint.frame_a), ("frame_b", constraint.frame_b))
    }
    words = {name: getattr(constraint, name) for name in ("closure", "type", "link_a", "link_b")}
    return {**words, **frames, "axis": list(constraint.axis)}


def _link(link: Link) -> Json:
    return {
        "name": link.name,
        **mass_document(link.mass_properties),
        "components": list(link.components),
        "sources": [
            {
                "component": source.component,
                "mass": source.mass,
                "density": number(source.density),
                "origin": source.origin,
                "method": source.method,
            }
            for source in link.masses
        ],
    }


def _joint(joint: Joint) -> Json:
    moves = joint.kind is not JointKind.FIXED
    return {
        "name": joint.name,
        "kind": joint.kind.value,
        "parent": joint.parent,
        "child": joint.child,
        "pose": _pose(joint.X_PC),
        "axis": list(joint.axis) if moves else None,
        "axis2": list(joint.axis2) if joint.kind is JointKind.UNIVERSAL else None,
        "pitch": joint.pitch if joint.kind is JointKind.SCREW else None,
        "limits": _limits(joint.limit),
        "dynamics": {
            name: float(getattr(joint.dynamics, name))
            for name in ("damping", "friction", "stiffness", "spring_reference", "armature")
        },
        "mimic": None
        if joint.mimic is None
        else {"joint": joint.mimic.joint, "multiplier": joint.mimic.multiplier, "offset": joint.mimic.offset},
        "drawn_position": joint.drawn_position,
    }


def _limits(limit: Limit) -> Json:
    return {name: number(getattr(limit, name)) for name in ("lower", "upper", "velocity", "effort")}


def _actuator(actuator: Actuator) -> Json:
    return {
        "name": actuator.name,
        "joint": actuator.joint,
        "kind": actuator.kind.value,
        "kp": actuator.kp,
        "kv": actuator.kv,
        "gear": actuator.gear,
        "computed": None if actuator.tuning is None else _tuning(actuator.tuning),
        "limits": _limits(actuator.limit),
        "motor": None if actuator.motor is None else _motor(actuator.motor),
    }


def _motor(motor: Motor) -> Json:
    """The motor and each figure that it gives, with its source; where the sidecar sets another one, that applies."""
    return {
        "name": motor.name,
        "part": motor.part or None,
        "figures": [
            {"quantity": one.quantity, "value": one.value, "unit": one.unit, "source": one.source}
            for one in motor.figures
        ],
        "unknown": list(motor.unknown),
        "doubts": list(motor.doubts),
    }


def _tuning(tuning: Tuning) -> Json:
    """What computed gains were asked for, and what they follow from."""
    return {
        "bandwidth": tuning.bandwidth,
        "damping_ratio": tuning.damping_ratio,
        "inertia": tuning.inertia,
        "weight": tuning.weight,
        "stiffened": tuning.stiffened,
        "braked": tuning.braked,
    }


def _simulation(robot: Robot) -> Json:
    settings = settings_of(robot)
    return {
        "timestep": settings.timestep,
        "integrator": settings.integrator.value,
        "closure_stiffness": settings.closure_stiffness,
    }


def _sensor(sensor: Sensor) -> Json:
    view = sensor.view
    sees = {"fov": view.fov, "columns": view.columns, "rows": view.rows, "nearest": view.nearest}
    return {
        "name": sensor.name,
        "kind": sensor.kind.value,
        "link": sensor.link,
        "joint": sensor.joint or None,
        "pose": _pose(sensor.X_LS),
        "rate": sensor.rate,
        "view": {**sees, "farthest": number(view.farthest)} if sensor.kind in SEEING else None,
        "source": sensor.source,
    }


def _closure(closure: LoopClosure) -> Json:
    return {
        "name": closure.name,
        "kind": closure.kind.value,
        "link_a": closure.link_a,
        "pose_a": _pose(closure.X_AF),
        "link_b": closure.link_b,
        "pose_b": _pose(closure.X_BF),
        "axis": list(closure.axis),
    }
