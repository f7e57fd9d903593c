"""Rewrites a robot for a format that does not support all of its features: one table of rules, and their application.

Every writer declares how its format expresses each :class:`Feature`. :func:`lower` rewrites what the format expresses
by other means, removes what it cannot express, and reports both. The result is the content of the file, so it is also
the expectation for engines that read the file.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot import multi_dof
from stepbot.robot.model import Base, JointKind, MeshFormat, Robot
from stepbot.robot.sensors import SensorKind

from ..features import Feature, Level
from ..format import Format
from . import devices, joints, masses, names, rerooted_loops, shapes


@dataclass(frozen=True)
class _Handling:
    """The rule for a feature that the format does not express exactly."""

    affected: Callable[[Robot], list[str]]
    """The affected elements of the robot, for the message; empty if the robot does not have the feature."""
    rewrite: Callable[[Robot], Robot] = lambda robot: robot
    """Replaces the feature by what the format has."""
    leave_out: Callable[[Robot], Robot] | None = None
    """Removes the feature, for formats that cannot express it; ``rewrite`` if None."""


def lower(robot: Robot, written: Format, found: Diagnostics, file: str | None = None) -> Robot:
    """The robot as the format expresses it; rewritten or removed features are reported, once each.

    Args:
        file: Name of the file in diagnostics; None for the robot's with the suffix of the format.
    """
    span = Span(file or f"{written.stem(robot.name)}{written.suffix}")
    reserved = names.reserved(robot, written.writer.reserves)
    if reserved:
        support = written.expresses[Feature.RESERVED_NAME]
        code = f"{support.code}:{Feature.RESERVED_NAME.word}"
        found.add(code, f"{written.title}: {support.how}: {', '.join(reserved)}", span)
    for feature, handling in _HANDLINGS.items():
        support = written.expresses[feature]
        exact = support.level is Level.EXACT or written.version_of(robot) >= support.exact_from
        affected = [] if exact else handling.affected(robot)
        if affected:
            found.add(f"{support.code}:{feature.word}", f"{written.title}: {support.how}: {', '.join(affected)}", span)
            left_out = support.level is Level.REPORTED and handling.leave_out is not None
            robot = handling.leave_out(robot) if left_out and handling.leave_out else handling.rewrite(robot)
    return robot


def _root_if(base: Base) -> Callable[[Robot], list[str]]:
    return lambda robot: [f"'{robot.root.name}' is {robot.base}"] if robot.base is base else []


def _given(*names: str) -> Callable[[Robot], list[str]]:
    """The settings for simulations that are given; defaults are not reported."""
    return lambda robot: [
        f"{name} {value}{' s' if name == 'timestep' else ''}"
        for name in names
        if (value := getattr(robot.simulation, name)) is not None
    ]


def _sensors(kind: SensorKind) -> _Handling:
    return _Handling(devices.sensors_of(kind), leave_out=devices.without_sensors(kind))


# In this order: names before references to them, zeros of loops before limits and drawn poses.
_HANDLINGS: Mapping[Feature, _Handling] = {
    Feature.JOINT_NAME: _Handling(names.renamed_joints, names.rename_joints),
    Feature.FRAME_NAME: _Handling(names.renamed_frames, names.rename_frames),
    Feature.FLOATING: _Handling(joints.joints_of(JointKind.FLOATING), multi_dof.floating_to_slides_and_ball),
    Feature.PLANAR: _Handling(joints.joints_of(JointKind.PLANAR), multi_dof.planar_to_three),
    Feature.CYLINDRICAL: _Handling(joints.joints_of(JointKind.CYLINDRICAL), multi_dof.cylindrical_to_two),
    Feature.SCREW: _Handling(joints.joints_of(JointKind.SCREW), multi_dof.screw_to_mimic),
    Feature.UNIVERSAL: _Handling(joints.joints_of(JointKind.UNIVERSAL), multi_dof.universal_to_revolutes),
    Feature.BALL: _Handling(joints.joints_of(JointKind.BALL), multi_dof.ball_to_revolutes),
    Feature.BALL_LIMIT: _Handling(
        joints.joints_where(joints.is_limited_ball), joints.each_joint(joints.without_ball_limit)
    ),
    Feature.BALL_FORCE: _Handling(
        joints.joints_where(joints.is_loaded_ball), joints.each_joint(joints.without_ball_force)
    ),
    Feature.FOLLOWER: _Handling(joints.describe_followers, joints.mimic_followers),
    Feature.CLOSURE: _Handling(joints.describe_closures(lambda closure: True), joints.drop_closures),
    Feature.SLIDING_CLOSURE: _Handling(rerooted_loops.sliding_closures, rerooted_loops.reroot_loops),
    Feature.STUCK_CLOSURE: _Handling(joints.describe_closures(lambda closure: closure.kind is JointKind.PRISMATIC)),
    Feature.LOOP_ZERO: _Handling(joints.loop_zeros, joints.move_loop_zeros),
    Feature.INITIAL_POSE: _Handling(joints.joints_where(lambda joint: joint.drawn_position != 0.0)),
    Feature.OPEN_POSITION: _Handling(joints.joints_where(joints.is_open), joints.each_joint(joints.bound)),
    Feature.OPEN_EFFORT: _Handling(joints.joints_where(joints.lacks_effort), joints.each_joint(joints.bound_effort)),
    Feature.VELOCITY: _Handling(
        joints.joints_where(lambda joint: joint.kind is not JointKind.FIXED and isfinite(joint.limit.velocity)),
    ),
    Feature.SPRING: _Handling(
        joints.joints_where(lambda joint: joint.dynamics.stiffness != 0.0),
        leave_out=joints.each_joint(joints.without_spring),
    ),
    Feature.ARMATURE: _Handling(
        joints.joints_where(lambda joint: joint.dynamics.armature != 0.0), joints.each_joint(joints.without_armature)
    ),
    # Kept for MoveIt's settings.
    Feature.ACCELERATION: _Handling(joints.joints_where(lambda joint: joint.limit.is_smooth)),
    Feature.MIMIC: _Handling(joints.joints_where(lambda joint: joint.mimic is not None)),
    Feature.MIMIC_CHAIN: _Handling(joints.chained_mimics, joints.flatten_mimics),
    Feature.MIXED_MIMIC: _Handling(joints.mixed_mimics, leave_out=joints.without_mixed_mimics),
    Feature.OPTICAL: _Handling(devices.sensors_where(devices.lacks_optical_frame), devices.with_optical_frames),
    Feature.FRAME: _Handling(
        lambda robot: [f"'{frame.name}' on '{frame.link}'" for frame in robot.frames], joints.frames_as_links
    ),
    Feature.ACTUATOR: _Handling(
        devices.actuators_where(lambda _robot, _actuator: True), leave_out=devices.without_actuators
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
    Feature.FAR_LIMIT: _Handling(joints.far_limits, leave_out=joints.without_far_limits),
    Feature.PASSIVE_LIMIT: _Handling(joints.passive_limits, leave_out=joints.without_passive_limits),
    Feature.JOINT_SENSOR: _sensors(SensorKind.JOINT),
    Feature.IMU: _sensors(SensorKind.IMU),
    Feature.FORCE_TORQUE: _sensors(SensorKind.FORCE_TORQUE),
    Feature.OFF_JOINT: _Handling(devices.sensors_where(devices.is_off_joint)),
    Feature.CAMERA: _sensors(SensorKind.CAMERA),
    Feature.LIDAR: _sensors(SensorKind.LIDAR),
    Feature.CONTACT: _sensors(SensorKind.CONTACT),
    Feature.SENSOR_PLACE: _Handling(devices.sensors_where(devices.has_place), devices.sensors_as_links),
    Feature.SENSOR_RATE: _Handling(
        devices.sensors_where(lambda sensor: sensor.rate != 0.0), leave_out=devices.without_rates
    ),
    Feature.ENCODER_RATE: _Handling(
        devices.sensors_where(devices.is_timed_encoder), leave_out=devices.without_encoder_rates
    ),
    Feature.CAMERA_EXTRAS: _Handling(
        devices.sensors_where(devices.has_camera_extras), leave_out=devices.without_camera_extras
    ),
    Feature.LIDAR_NEAREST: _Handling(
        devices.sensors_where(devices.is_blind_when_near), leave_out=devices.seeing_what_is_near
    ),
    Feature.OPEN_VIEW: _Handling(devices.sensors_where(devices.is_open_view), devices.bound_views),
    Feature.TIMESTEP: _Handling(_given("timestep")),
    Feature.SOLVER: _Handling(_given("integrator", "closure_stiffness")),
    Feature.STL_VISUAL: _Handling(masses.visuals_as(MeshFormat.STL), masses.with_obj_visuals),
    Feature.DAE_VISUAL: _Handling(masses.visuals_as(MeshFormat.DAE), masses.with_obj_visuals),
    Feature.GLB_VISUAL: _Handling(masses.visuals_as(MeshFormat.GLB), masses.with_obj_visuals),
    Feature.STL_COLLISION: _Handling(masses.collisions_as(MeshFormat.STL), masses.with_obj_collisions),
    Feature.OTHER_COLLISION: _Handling(
        masses.collisions_as(MeshFormat.DAE, MeshFormat.GLB), masses.with_obj_collisions
    ),
    Feature.CAPSULE: _Handling(shapes.links_with_capsules, shapes.split_capsules),
    Feature.EXCLUDED_CONTACT: _Handling(shapes.excluded_pairs),
    Feature.MIXED_SURFACE: _Handling(shapes.mixed_surfaces, shapes.one_surface),
    Feature.SURFACE: _Handling(
        shapes.surfaces_where(lambda one: one.friction is not None), leave_out=shapes.without_surface("friction")
    ),
    Feature.SPIN: _Handling(
        shapes.surfaces_where(lambda one: one.torsional is not None or one.rolling is not None),
        leave_out=shapes.without_surface("torsional", "rolling"),
    ),
    Feature.BOUNCE: _Handling(
        shapes.surfaces_where(lambda one: one.restitution is not None), leave_out=shapes.without_surface("restitution")
    ),
    Feature.DEAD_BOUNCE: _Handling(shapes.surfaces_where(shapes.is_dead), shapes.without_dead_bounce),
    Feature.SOFTNESS: _Handling(
        shapes.surfaces_where(lambda one: one.softness is not None), leave_out=shapes.without_surface("softness")
    ),
    Feature.FLAT_COLLISION: _Handling(shapes.flat_collisions, shapes.drop_flat_collisions),
    Feature.CONCAVE_COLLISION: _Handling(shapes.concave_collisions),
    Feature.MASSLESS: _Handling(masses.massless_links, masses.with_stand_in_masses),
    Feature.MASSLESS_BODY: _Handling(
        masses.massless_moving_links, masses.with_least_masses, leave_out=lambda robot: robot
    ),
    Feature.FIXED_BASE: _Handling(_root_if(Base.FIXED)),
    Feature.FLOATING_BASE: _Handling(_root_if(Base.FLOATING)),
}
