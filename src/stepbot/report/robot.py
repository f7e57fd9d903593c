"""A robot as JSON data, for ``report.json``, and back: everything but shapes and sensors."""

from collections.abc import Mapping
from typing import Any, TypeVar

from msgspec import Struct

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.spatial import tidy
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.loop_followers import loop_followers
from stepbot.robot.model import Actuator, Base, Frame, Joint, JointKind, Link, LoopClosure, Module, Robot
from stepbot.robot.pybullet_closures import loop_constraints
from stepbot.robot.self_collision import SelfCollision
from stepbot.robot.sensors import SEEING, Sensor
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.tuning import Tuning

from .plain import Json, picked, unpicked
from .results import Check, Content, LinkCollision, Results, Row, SimplifiedVisuals, Status, WrittenFile

T = TypeVar("T")
MASS = "mass com inertia"
FRAME = "name link pose=X_LF source"
JOINT = "name kind parent child pose=X_PC axis axis2 pitch limits=limit dynamics mimic drawn_position"
CLOSURE = "name kind link_a pose_a=X_AF link_b pose_b=X_BF axis"
ACTUATOR = "name joint kind kp kv gear computed=tuning limits=limit motor"
TUNING = "bandwidth damping_ratio inertia weight stiffened braked"
LIMITS = "lower upper velocity effort"
MOTOR = "name part figures unknown doubts"
"""Keys of the objects of the robot, for :func:`.plain.picked`."""


def self_collision_document(result: SelfCollision) -> Json:
    """All pairs with their evidence: number of poses, depth [m] and joint positions [rad] or [m] of the first one."""
    keys = "links class=kind contacts first depth pose"
    pairs = [picked(pair, keys, links=[pair.link_a, pair.link_b], pose=dict(pair.pose)) for pair in result.pairs]
    return picked(result, "samples exclude pairs", pairs=pairs)


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


class MeasuredBody(Struct, frozen=True):
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


class Report(Results, frozen=True):
    """The results, with the robot and its bodies."""

    robot: Robot | None = None
    bodies: tuple[MeasuredBody, ...] = ()
    initial_penetrations: tuple[tuple[str, str], ...] = ()
    """Pairs of links without whose contacts a simulation would not have diverged."""


def robot_document(report: Report, robot: Robot) -> Json:
    """The robot, its drawn pose, and the constraints that close its loops in PyBullet."""
    poses = link_poses(robot, initial_configuration(robot))
    total = combined(link.mass_properties.moved(tidy(poses[link.name])) for link in robot.links)
    return {
        "name": robot.name,
        "source": robot.source,
        "base": robot.base.value,
        "root": robot.root.name,
        **picked(total, MASS),
        "degrees_of_freedom": report.degrees_of_freedom,
        "driven": list(report.driven),
        "links": [_link(link) for link in robot.links],
        "joints": [_joint(joint) for joint in robot.joints],
        "closures": [picked(closure, CLOSURE) for closure in robot.closures],
        "followers": [
            {
                "joint": follower.joint,
                **picked(follower.mimic, "leader=joint multiplier offset"),
                "deviation": follower.deviation,
            }
            for follower in loop_followers(robot)
        ],
        "pybullet": [constraint.document for constraint in loop_constraints(robot)],
        "frames": [picked(frame, FRAME) for frame in robot.frames],
        "actuators": [_actuator(actuator) for actuator in robot.actuators],
        "sensors": [_sensor(sensor) for sensor in robot.sensors],
        "standing_height": standing_height(robot, initial_configuration(robot)),
        "simulation": picked(settings_of(robot), "timestep integrator closure_stiffness"),
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
        "gains_alone": [{"actuator": name, "kp": kp, "kv": kv} for name, kp, kv in module.gains_alone],
    }


def _link(link: Link) -> Json:
    sources = [picked(source, "component mass density origin method") for source in link.masses]
    return {
        "name": link.name,
        **picked(link.mass_properties, MASS),
        "components": [*link.components],
        "sources": sources,
    }


def _joint(joint: Joint) -> Json:
    unused: Json = {}
    if joint.kind is JointKind.FIXED:
        unused["axis"] = None
    if joint.kind is not JointKind.UNIVERSAL:
        unused["axis2"] = None
    if joint.kind is not JointKind.SCREW:
        unused["pitch"] = None
    return picked(joint, JOINT, limits=picked(joint.limit, LIMITS), **unused)


def _actuator(actuator: Actuator) -> Json:
    """An actuator: what computed gains were asked for and follow from, and what its motor gives."""
    computed = None if actuator.tuning is None else picked(actuator.tuning, TUNING)
    motor = actuator.motor and picked(actuator.motor, MOTOR, part=actuator.motor.part or None)
    return picked(actuator, ACTUATOR, computed=computed, limits=picked(actuator.limit, LIMITS), motor=motor)


def _sensor(sensor: Sensor) -> Json:
    sees = picked(sensor.view, "fov columns rows nearest farthest") if sensor.kind in SEEING else None
    return picked(sensor, "name kind link joint pose=X_LS rate view source", joint=sensor.joint or None, view=sees)


def robot_of_report(document: Mapping[str, Any]) -> Robot:
    """The robot of a parsed ``report.json``, without shapes and sensors.

    Raises:
        KeyError, TypeError, ValueError: The document does not have the report's schema, or has no robot.
    """
    content = document["robot"]

    def records(key: str, kind: type[T], keys: str) -> tuple[T, ...]:
        return tuple(unpicked(kind, one, keys, key, has_defaults=True) for one in content[key])

    return Robot(
        name=str(content["name"]),
        links=tuple(Link(one["name"], unpicked(MassProperties, one, MASS, "links")) for one in content["links"]),
        joints=records("joints", Joint, JOINT),
        closures=records("closures", LoopClosure, CLOSURE),
        frames=records("frames", Frame, FRAME),
        actuators=tuple(map(_actuator_of, content["actuators"])),
        base=Base(content["base"]),
        source=str(content["source"]),
    )


def _actuator_of(content: Mapping[str, Any]) -> Actuator:
    """An actuator without the figures of its motor, and with what its computed gains were asked for."""
    computed = content.get("computed")
    tuning = None if computed is None else unpicked(Tuning, computed, TUNING, "actuators")
    given = {"tuning": tuning, "motor": None}
    return unpicked(Actuator, content, ACTUATOR, "actuators", has_defaults=True, **given)
