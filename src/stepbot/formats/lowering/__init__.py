"""Rewrites a robot for a format that does not support all of its features: one table of rules, and their application.

Every writer declares how its format expresses each :class:`Feature`. :func:`lower` rewrites what the format expresses
by other means, removes what it cannot express, and reports both. The result is the content of the file, so it is also
the expectation for engines that read the file.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import Base, JointKind, MeshFormat, Robot
from stepbot.robot.multi_dof import (
    ball_to_revolutes,
    cylindrical_to_two,
    floating_to_slides_and_ball,
    planar_to_three,
    screw_to_mimic,
    universal_to_revolutes,
)
from stepbot.robot.sensors import SensorKind

from ..features import Feature, Level
from ..format import Format
from .devices import (
    actuators_where,
    bound_actuators,
    bound_views,
    bounded_by_joints,
    further_actuators,
    gears_at_joints,
    has_camera_extras,
    has_place,
    is_blind_when_near,
    is_bounded_actuator,
    is_off_joint,
    is_open_view,
    is_timed_encoder,
    is_unlimited_actuator,
    lacks_optical_frame,
    seeing_what_is_near,
    sensors_as_links,
    sensors_of,
    sensors_where,
    with_optical_frames,
    without_actuators,
    without_camera_extras,
    without_encoder_rates,
    without_further_actuators,
    without_rates,
    without_sensors,
)
from .joints import (
    bound,
    bound_effort,
    chained_mimics,
    describe_closures,
    describe_followers,
    drop_closures,
    each_joint,
    far_limits,
    flatten_mimics,
    frames_as_links,
    is_limited_ball,
    is_loaded_ball,
    is_open,
    joints_of,
    joints_where,
    lacks_effort,
    loop_zeros,
    mimic_followers,
    mixed_mimics,
    move_loop_zeros,
    passive_limits,
    without_armature,
    without_ball_force,
    without_ball_limit,
    without_far_limits,
    without_mixed_mimics,
    without_passive_limits,
    without_spring,
)
from .masses import (
    collisions_as,
    massless_links,
    massless_moving_links,
    visuals_as,
    with_least_masses,
    with_obj_collisions,
    with_obj_visuals,
    with_stand_in_masses,
)
from .names import rename_frames, rename_joints, renamed_frames, renamed_joints, reserved
from .rerooted_loops import reroot_loops, sliding_closures
from .shapes import (
    concave_collisions,
    drop_flat_collisions,
    excluded_pairs,
    flat_collisions,
    is_dead,
    links_with_capsules,
    mixed_surfaces,
    one_surface,
    split_capsules,
    surfaces_where,
    without_dead_bounce,
    without_surface,
)


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
    names = reserved(robot, written.writer.reserves)
    if names:
        support = written.expresses[Feature.RESERVED_NAME]
        code = f"{support.code}:{Feature.RESERVED_NAME.word}"
        found.add(code, f"{written.title}: {support.how}: {', '.join(names)}", span)
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
    return _Handling(sensors_of(kind), leave_out=without_sensors(kind))


# In this order: names before references to them, zeros of loops before limits and drawn poses.
_HANDLINGS: Mapping[Feature, _Handling] = {
    Feature.JOINT_NAME: _Handling(renamed_joints, rename_joints),
    Feature.FRAME_NAME: _Handling(renamed_frames, rename_frames),
    Feature.FLOATING: _Handling(joints_of(JointKind.FLOATING), floating_to_slides_and_ball),
    Feature.PLANAR: _Handling(joints_of(JointKind.PLANAR), planar_to_three),
    Feature.CYLINDRICAL: _Handling(joints_of(JointKind.CYLINDRICAL), cylindrical_to_two),
    Feature.SCREW: _Handling(joints_of(JointKind.SCREW), screw_to_mimic),
    Feature.UNIVERSAL: _Handling(joints_of(JointKind.UNIVERSAL), universal_to_revolutes),
    Feature.BALL: _Handling(joints_of(JointKind.BALL), ball_to_revolutes),
    Feature.BALL_LIMIT: _Handling(joints_where(is_limited_ball), each_joint(without_ball_limit)),
    Feature.BALL_FORCE: _Handling(joints_where(is_loaded_ball), each_joint(without_ball_force)),
    Feature.FOLLOWER: _Handling(describe_followers, mimic_followers),
    Feature.CLOSURE: _Handling(describe_closures(lambda closure: True), drop_closures),
    Feature.SLIDING_CLOSURE: _Handling(sliding_closures, reroot_loops),
    Feature.STUCK_CLOSURE: _Handling(describe_closures(lambda closure: closure.kind is JointKind.PRISMATIC)),
    Feature.LOOP_ZERO: _Handling(loop_zeros, move_loop_zeros),
    Feature.INITIAL_POSE: _Handling(joints_where(lambda joint: joint.drawn_position != 0.0)),
    Feature.OPEN_POSITION: _Handling(joints_where(is_open), each_joint(bound)),
    Feature.OPEN_EFFORT: _Handling(joints_where(lacks_effort), each_joint(bound_effort)),
    Feature.VELOCITY: _Handling(
        joints_where(lambda joint: joint.kind is not JointKind.FIXED and isfinite(joint.limit.velocity)),
    ),
    Feature.SPRING: _Handling(
        joints_where(lambda joint: joint.dynamics.stiffness != 0.0), leave_out=each_joint(without_spring)
    ),
    Feature.ARMATURE: _Handling(
        joints_where(lambda joint: joint.dynamics.armature != 0.0), each_joint(without_armature)
    ),
    Feature.ACCELERATION: _Handling(joints_where(lambda joint: joint.limit.is_smooth)),  # kept for MoveIt's settings
    Feature.MIMIC: _Handling(joints_where(lambda joint: joint.mimic is not None)),
    Feature.MIMIC_CHAIN: _Handling(chained_mimics, flatten_mimics),
    Feature.MIXED_MIMIC: _Handling(mixed_mimics, leave_out=without_mixed_mimics),
    Feature.OPTICAL: _Handling(sensors_where(lacks_optical_frame), with_optical_frames),
    Feature.FRAME: _Handling(
        lambda robot: [f"'{frame.name}' on '{frame.link}'" for frame in robot.frames], frames_as_links
    ),
    Feature.ACTUATOR: _Handling(actuators_where(lambda _robot, _actuator: True), leave_out=without_actuators),
    Feature.SECOND_ACTUATOR: _Handling(further_actuators, leave_out=without_further_actuators),
    Feature.GEAR: _Handling(actuators_where(lambda _robot, actuator: actuator.gear != 1.0), gears_at_joints),
    Feature.ACTUATOR_INPUT: _Handling(actuators_where(is_bounded_actuator), leave_out=bounded_by_joints),
    Feature.UNLIMITED_ACTUATOR: _Handling(actuators_where(is_unlimited_actuator), bound_actuators),
    # After what takes motors away.
    Feature.FAR_LIMIT: _Handling(far_limits, leave_out=without_far_limits),
    Feature.PASSIVE_LIMIT: _Handling(passive_limits, leave_out=without_passive_limits),
    Feature.JOINT_SENSOR: _sensors(SensorKind.JOINT),
    Feature.IMU: _sensors(SensorKind.IMU),
    Feature.FORCE_TORQUE: _sensors(SensorKind.FORCE_TORQUE),
    Feature.OFF_JOINT: _Handling(sensors_where(is_off_joint)),
    Feature.CAMERA: _sensors(SensorKind.CAMERA),
    Feature.LIDAR: _sensors(SensorKind.LIDAR),
    Feature.CONTACT: _sensors(SensorKind.CONTACT),
    Feature.SENSOR_PLACE: _Handling(sensors_where(has_place), sensors_as_links),
    Feature.SENSOR_RATE: _Handling(sensors_where(lambda sensor: sensor.rate != 0.0), leave_out=without_rates),
    Feature.ENCODER_RATE: _Handling(sensors_where(is_timed_encoder), leave_out=without_encoder_rates),
    Feature.CAMERA_EXTRAS: _Handling(sensors_where(has_camera_extras), leave_out=without_camera_extras),
    Feature.LIDAR_NEAREST: _Handling(sensors_where(is_blind_when_near), leave_out=seeing_what_is_near),
    Feature.OPEN_VIEW: _Handling(sensors_where(is_open_view), bound_views),
    Feature.TIMESTEP: _Handling(_given("timestep")),
    Feature.SOLVER: _Handling(_given("integrator", "closure_stiffness")),
    Feature.STL_VISUAL: _Handling(visuals_as(MeshFormat.STL), with_obj_visuals),
    Feature.DAE_VISUAL: _Handling(visuals_as(MeshFormat.DAE), with_obj_visuals),
    Feature.GLB_VISUAL: _Handling(visuals_as(MeshFormat.GLB), with_obj_visuals),
    Feature.STL_COLLISION: _Handling(collisions_as(MeshFormat.STL), with_obj_collisions),
    Feature.OTHER_COLLISION: _Handling(collisions_as(MeshFormat.DAE, MeshFormat.GLB), with_obj_collisions),
    Feature.CAPSULE: _Handling(links_with_capsules, split_capsules),
    Feature.EXCLUDED_CONTACT: _Handling(excluded_pairs),
    Feature.MIXED_SURFACE: _Handling(mixed_surfaces, one_surface),
    Feature.SURFACE: _Handling(
        surfaces_where(lambda one: one.friction is not None), leave_out=without_surface("friction")
    ),
    Feature.SPIN: _Handling(
        surfaces_where(lambda one: one.torsional is not None or one.rolling is not None),
        leave_out=without_surface("torsional", "rolling"),
    ),
    Feature.BOUNCE: _Handling(
        surfaces_where(lambda one: one.restitution is not None), leave_out=without_surface("restitution")
    ),
    Feature.DEAD_BOUNCE: _Handling(surfaces_where(is_dead), without_dead_bounce),
    Feature.SOFTNESS: _Handling(
        surfaces_where(lambda one: one.softness is not None), leave_out=without_surface("softness")
    ),
    Feature.FLAT_COLLISION: _Handling(flat_collisions, drop_flat_collisions),
    Feature.CONCAVE_COLLISION: _Handling(concave_collisions),
    Feature.MASSLESS: _Handling(massless_links, with_stand_in_masses),
    Feature.MASSLESS_BODY: _Handling(massless_moving_links, with_least_masses, leave_out=lambda robot: robot),
    Feature.FIXED_BASE: _Handling(_root_if(Base.FIXED)),
    Feature.FLOATING_BASE: _Handling(_root_if(Base.FLOATING)),
}
