"""Rewrites a robot for a format that does not support all of its features: one table of rules, and their application.

Every writer declares how its format expresses each :class:`Feature`. :func:`lower` rewrites what the format expresses
by other means, removes what it cannot express, and reports both. The result is the content of the file, so it is also
the expectation for engines that read the file.
"""

from collections.abc import Callable, Mapping
from math import inf, isfinite
from typing import TypeVar

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import Base, Collision, Joint, JointDynamics, JointKind, Limit, Link, MeshFormat, Robot, Visual
from stepbot.robot.multi_dof import split
from stepbot.robot.sensors import Sensor, SensorKind

from ..features import Feature, Level
from ..format import Format
from . import devices, joints, masses, names, rerooted_loops, shapes

T = TypeVar("T")


def _unchanged(robot: Robot) -> Robot:
    return robot


class _Handling(Struct, frozen=True):
    """The rule for a feature that the format does not express exactly."""

    affected: Callable[[Robot], list[str]]
    """The affected elements of the robot, for the message; empty if the robot does not have the feature."""
    rewrite: Callable[[Robot], Robot] = _unchanged
    """Replaces the feature by what the format has."""
    leave_out: Callable[[Robot], Robot] | None = None
    """Removes the feature, for formats that cannot express it; ``rewrite`` if None."""


def lower(robot: Robot, written: Format, diagnostics: Diagnostics, file: str | None = None) -> Robot:
    """The robot as the format expresses it; rewritten or removed features are reported, once each.

    Args:
        file: Name of the file in diagnostics; None for the robot's with the suffix of the format.
    """
    span = Span(file or f"{written.stem(robot.name)}{written.suffix}")
    reserved = names.reserved(robot, written.writer.reserves)
    if reserved:
        support = written.expresses[Feature.RESERVED_NAME]
        code = f"{support.code}:{Feature.RESERVED_NAME.word}"
        diagnostics.add(code, f"{written.title}: {support.how}: {', '.join(reserved)}", span)
    if written.version_of(robot) >= written.expresses[Feature.ACCELERATION].exact_from:
        robot = _accelerated(robot, written, diagnostics, span)
    for feature, handling in _HANDLINGS.items():
        support = written.expresses[feature]
        exact = support.level is Level.EXACT or written.version_of(robot) >= support.exact_from
        affected = [] if exact else handling.affected(robot)
        if affected:
            diagnostics.add(
                f"{support.code}:{feature.word}", f"{written.title}: {support.how}: {', '.join(affected)}", span
            )
            left_out = support.level is Level.REPORTED and handling.leave_out is not None
            robot = handling.leave_out(robot) if left_out and handling.leave_out else handling.rewrite(robot)
    return robot


def _accelerated(robot: Robot, written: Format, diagnostics: Diagnostics, span: Span) -> Robot:
    """The robot with the accelerations that its efforts allow, where it has an effort and states none."""
    from stepbot.robot.datasheet import with_accelerations

    limited = with_accelerations(robot)
    added = [f"'{a.name}'" for a, b in zip(limited.joints, robot.joints, strict=True) if a.limit != b.limit]
    if added:
        how = "these joints have the acceleration that their efforts allow in the worst posture as a limit"
        diagnostics.add(f"SB763:{Feature.ACCELERATION.word}", f"{written.title}: {how}: {', '.join(added)}", span)
    return limited


def _root_if(base: Base) -> Callable[[Robot], list[str]]:
    return lambda robot: [f"'{robot.root.name}' is {robot.base}"] if robot.base is base else []


def _given(*names: str) -> Callable[[Robot], list[str]]:
    """The settings for simulations that are given; defaults are not reported."""
    return lambda robot: [
        f"{name} {value}{' s' if name == 'timestep' else ''}"
        for name in names
        if (value := getattr(robot.simulation, name)) is not None
    ]


def _each(
    affected: Callable[[Robot], list[str]],
    each: Callable[[Callable[[T], T]], Callable[[Robot], Robot]],
    condition: Callable[[T], bool],
    rewrite: Callable[[T], T] | None,
    leave_out: Callable[[T], T] | None,
) -> _Handling:
    """The elements that satisfy a condition; each of them is changed on its own."""

    def changed(change: Callable[[T], T]) -> Callable[[Robot], Robot]:
        return each(lambda one: change(one) if condition(one) else one)

    return _Handling(affected, changed(rewrite) if rewrite else _unchanged, changed(leave_out) if leave_out else None)


def _joints(
    condition: Callable[[Joint], bool],
    rewrite: Callable[[Joint], Joint] | None = None,
    leave_out: Callable[[Joint], Joint] | None = None,
) -> _Handling:
    return _each(joints.joints_where(condition), joints.each_joint, condition, rewrite, leave_out)


def _split(kind: JointKind) -> _Handling:
    return _Handling(joints.joints_where(lambda joint: joint.kind is kind), lambda robot: split(robot, kind))


def _links(
    condition: Callable[[Link], bool],
    rewrite: Callable[[Link], Link] | None = None,
    leave_out: Callable[[Link], Link] | None = None,
) -> _Handling:
    return _each(
        lambda robot: [f"'{link.name}'" for link in robot.links if condition(link)],
        shapes.each_link,
        condition,
        rewrite,
        leave_out,
    )


def _sensors(
    condition: Callable[[Sensor], bool],
    rewrite: Callable[[Sensor], Sensor] | None = None,
    leave_out: Callable[[Sensor], Sensor] | None = None,
) -> _Handling:
    return _each(devices.sensors_where(condition), devices.each_sensor, condition, rewrite, leave_out)


def _sensor_kind(kind: SensorKind) -> _Handling:
    """All sensors of a kind, which are left out."""
    return _Handling(
        devices.sensors_where(lambda sensor: sensor.kind is kind),
        leave_out=lambda robot: replace(robot, sensors=tuple(s for s in robot.sensors if s.kind is not kind)),
    )


def _surfaces(*names: str) -> _Handling:
    """Contact properties that are given, which are left out."""
    return _links(
        lambda link: any(getattr(shape.surface, name) is not None for shape in link.collisions for name in names),
        leave_out=lambda link: shapes.with_surfaces(link, lambda one: replace(one, **dict.fromkeys(names))),
    )


def _as_obj(kind: type[Visual | Collision], *formats: MeshFormat) -> _Handling:
    return _Handling(shapes.meshes_as(kind, *formats), shapes.as_obj(kind))


def _without_rate(sensor: Sensor) -> Sensor:
    """The sensor, which then measures in every step."""
    return replace(sensor, rate=0.0)


# In this order: names before references to them, zeros of loops before limits and drawn poses.
_HANDLINGS: Mapping[Feature, _Handling] = {
    Feature.JOINT_NAME: _Handling(names.renamed_joints, names.rename_joints),
    Feature.FRAME_NAME: _Handling(names.renamed_frames, names.rename_frames),
    Feature.FLOATING: _split(JointKind.FLOATING),
    Feature.PLANAR: _split(JointKind.PLANAR),
    Feature.CYLINDRICAL: _split(JointKind.CYLINDRICAL),
    Feature.SCREW: _split(JointKind.SCREW),
    Feature.UNIVERSAL: _split(JointKind.UNIVERSAL),
    Feature.BALL: _split(JointKind.BALL),
    Feature.BALL_LIMIT: _joints(
        lambda joint: joint.kind is JointKind.BALL and joint.limit != Limit(),
        lambda joint: replace(joint, limit=Limit()),
    ),
    Feature.BALL_FORCE: _joints(
        joints.is_loaded_ball, lambda joint: replace(joint, dynamics=JointDynamics(armature=joint.dynamics.armature))
    ),
    Feature.FOLLOWER: _Handling(joints.describe_followers, joints.mimic_followers),
    Feature.CLOSURE: _Handling(
        joints.describe_closures(lambda closure: True), lambda robot: replace(robot, closures=())
    ),
    Feature.SLIDING_CLOSURE: _Handling(rerooted_loops.sliding_closures, rerooted_loops.reroot_loops),
    Feature.STUCK_CLOSURE: _Handling(joints.describe_closures(lambda closure: closure.kind is JointKind.PRISMATIC)),
    Feature.LOOP_ZERO: _Handling(
        joints.loop_zeros, lambda robot: joints.with_moved_zeros(robot, joints.joints_in_loops(robot))
    ),
    Feature.INITIAL_POSE: _joints(lambda joint: joint.drawn_position != 0.0),
    Feature.OPEN_POSITION: _joints(joints.is_open, joints.bound),
    Feature.OPEN_EFFORT: _joints(joints.lacks_effort, joints.bound_effort),
    Feature.VELOCITY: _joints(lambda joint: joint.kind is not JointKind.FIXED and isfinite(joint.limit.velocity)),
    Feature.SPRING: _joints(
        lambda joint: joint.dynamics.stiffness != 0.0,
        leave_out=lambda joint: replace(joint, dynamics=replace(joint.dynamics, stiffness=0.0, spring_reference=0.0)),
    ),
    Feature.ARMATURE: _joints(lambda joint: joint.dynamics.armature != 0.0, joints.without_armature),
    Feature.STIFF_DAMPING: _Handling(joints.stiffly_damped),
    # Kept for MoveIt's settings.
    Feature.ACCELERATION: _joints(lambda joint: joint.limit.is_smooth),
    Feature.MIMIC: _joints(lambda joint: joint.mimic is not None),
    Feature.MIMIC_CHAIN: _Handling(joints.chained_mimics, joints.flatten_mimics),
    Feature.MIXED_MIMIC: _Handling(joints.mixed_mimics, leave_out=joints.without_mixed_mimics),
    Feature.OPTICAL: _Handling(devices.sensors_where(devices.lacks_optical_frame), devices.with_optical_frames),
    Feature.FRAME: _Handling(
        lambda robot: [f"'{frame.name}' on '{frame.link}'" for frame in robot.frames], joints.frames_as_links
    ),
    Feature.ACTUATOR: _Handling(
        devices.actuators_where(lambda _robot, _actuator: True), leave_out=lambda robot: replace(robot, actuators=())
    ),
    Feature.SECOND_ACTUATOR: _Handling(devices.further_actuators, leave_out=devices.without_further_actuators),
    Feature.GEAR: _Handling(
        devices.actuators_where(lambda _robot, actuator: actuator.gear != 1.0), devices.gears_at_joints
    ),
    Feature.ACTUATOR_INPUT: _Handling(
        devices.actuators_where(devices.is_bounded_actuator), leave_out=devices.bounded_by_joints
    ),
    Feature.UNLIMITED_ACTUATOR: _Handling(
        devices.actuators_where(devices.is_unlimited_actuator), devices.bound_actuators
    ),
    # After what takes motors away.
    Feature.FAR_LIMIT: _Handling(joints.joints_where(joints.is_far), leave_out=joints.without_far_limits),
    Feature.PASSIVE_LIMIT: _Handling(joints.passive_limits, leave_out=joints.without_passive_limits),
    Feature.JOINT_SENSOR: _sensor_kind(SensorKind.JOINT),
    Feature.IMU: _sensor_kind(SensorKind.IMU),
    Feature.FORCE_TORQUE: _sensor_kind(SensorKind.FORCE_TORQUE),
    # Torques are measured about the origin of the joint.
    Feature.OFF_JOINT: _sensors(lambda sensor: sensor.kind is SensorKind.FORCE_TORQUE and any(sensor.X_LS.position)),
    Feature.CAMERA: _sensor_kind(SensorKind.CAMERA),
    Feature.LIDAR: _sensor_kind(SensorKind.LIDAR),
    Feature.CONTACT: _sensor_kind(SensorKind.CONTACT),
    Feature.SENSOR_PLACE: _Handling(devices.sensors_where(devices.has_place), devices.sensors_as_links),
    Feature.SENSOR_RATE: _sensors(lambda sensor: sensor.rate != 0.0, leave_out=_without_rate),
    Feature.ENCODER_RATE: _sensors(
        lambda sensor: sensor.kind is SensorKind.JOINT and sensor.rate != 0.0, leave_out=_without_rate
    ),
    Feature.CAMERA_EXTRAS: _sensors(
        devices.has_camera_extras,
        leave_out=lambda sensor: replace(sensor, rate=0.0, view=replace(sensor.view, nearest=0.0, farthest=inf)),
    ),
    Feature.LIDAR_NEAREST: _sensors(
        lambda sensor: sensor.kind is SensorKind.LIDAR and sensor.view.nearest != 0.0,
        leave_out=lambda sensor: replace(sensor, view=replace(sensor.view, nearest=0.0)),
    ),
    Feature.OPEN_VIEW: _sensors(devices.is_open_view, devices.bounded_view),
    Feature.TIMESTEP: _Handling(_given("timestep")),
    Feature.SOLVER: _Handling(_given("integrator", "closure_stiffness")),
    Feature.STL_VISUAL: _as_obj(Visual, MeshFormat.STL),
    Feature.DAE_VISUAL: _as_obj(Visual, MeshFormat.DAE),
    Feature.GLB_VISUAL: _as_obj(Visual, MeshFormat.GLB),
    Feature.STL_COLLISION: _as_obj(Collision, MeshFormat.STL),
    Feature.OTHER_COLLISION: _as_obj(Collision, MeshFormat.DAE, MeshFormat.GLB),
    Feature.CAPSULE: _links(shapes.has_capsule, shapes.split_capsules),
    Feature.EXCLUDED_CONTACT: _Handling(shapes.excluded_pairs),
    Feature.MIXED_SURFACE: _links(shapes.is_mixed, shapes.with_one_surface),
    Feature.SURFACE: _surfaces("friction"),
    Feature.SPIN: _surfaces("torsional", "rolling"),
    Feature.BOUNCE: _surfaces("restitution"),
    Feature.DEAD_BOUNCE: _links(shapes.has_dead_bounce, shapes.without_dead_bounce),
    Feature.SOFTNESS: _surfaces("softness"),
    Feature.FLAT_COLLISION: _Handling(shapes.flat_collisions, shapes.drop_flat_collisions),
    Feature.CONCAVE_COLLISION: _Handling(shapes.concave_collisions),
    Feature.MASSLESS: _links(masses.is_massless, masses.with_stand_in),
    Feature.MASSLESS_BODY: _Handling(
        lambda robot: [f"'{name}'" for name in masses.massless_bodies(robot)],
        masses.with_least_masses,
        leave_out=_unchanged,
    ),
    Feature.FIXED_BASE: _Handling(_root_if(Base.FIXED)),
    Feature.FLOATING_BASE: _Handling(_root_if(Base.FLOATING)),
}
