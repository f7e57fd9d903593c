"""What becomes of a robot in a format that cannot say all of it: one table, and the rewriting that follows from it.

Every writer declares for each :class:`Notion` how its format says it. :func:`lower` makes of a robot the one that the
format can hold: it rewrites what the format lacks into what it has, leaves out what has no place there, and reports
both. What it returns is what the file says, so it is also what an engine that reads the file is compared with.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import Base, JointKind, Robot
from stepbot.robot.multi_dof import (
    ball_to_revolutes,
    cylindrical_to_two,
    floating_to_slides_and_ball,
    planar_to_three,
    screw_to_mimic,
    universal_to_revolutes,
)
from stepbot.robot.sensors import SensorKind
from stepbot.robot.unique_names import free_name

from .devices import (
    bound_drives,
    bound_views,
    bounded_by_joints,
    drives_where,
    gears_at_joints,
    has_camera_extras,
    has_place,
    is_blind_when_near,
    is_bounded_drive,
    is_off_joint,
    is_open_drive,
    is_open_view,
    is_timed_encoder,
    seeing_what_is_near,
    sensors_as_links,
    sensors_of,
    sensors_where,
    without_camera_extras,
    without_drives,
    without_encoder_rates,
    without_rates,
    without_sensors,
)
from .features import Format, Level, Notion, Support, exact, lowered, refused, reported
from .joints import (
    UNLIMITED,
    bound,
    bound_effort,
    chained_mimics,
    describe_closures,
    drop_closures,
    each_joint,
    flatten_mimics,
    frames_as_links,
    is_limited_ball,
    is_loaded_ball,
    is_open,
    joints_of,
    joints_where,
    lacks_effort,
    loop_zeros,
    move_loop_zeros,
    without_armature,
    without_ball_force,
    without_ball_limit,
    without_spring,
)
from .names import rename_frames, rename_joints, renamed_frames, renamed_joints, reserved
from .rerooted_loops import recut_loops, sliding_closures
from .shapes import (
    concave_collisions,
    drop_flat_collisions,
    flat_collisions,
    geometries,
    links_with_capsules,
    split_capsules,
)

__all__ = [
    "UNLIMITED",
    "Format",
    "Level",
    "Notion",
    "Support",
    "exact",
    "free_name",
    "geometries",
    "lower",
    "lowered",
    "refused",
    "reported",
]


@dataclass(frozen=True)
class _Handling:
    """What to do where a format does not say a notion as it is."""

    affected: Callable[[Robot], list[str]]
    """What of the robot is concerned, for the message; empty where the robot does not have the notion."""
    rewrite: Callable[[Robot], Robot] = lambda robot: robot
    """What the format says in place of the notion."""
    leave_out: Callable[[Robot], Robot] | None = None
    """Without the notion, for formats that have no place for it; ``rewrite`` where there is none."""


def lower(robot: Robot, written: Format, found: Diagnostics) -> Robot:
    """The robot as the format can say it; what is rewritten or left out is reported, once per notion."""
    span = Span(f"{robot.name}{written.SUFFIX}")
    names = reserved(robot, written.reserves)
    if names:
        support = written.EXPRESSES[Notion.RESERVED_NAME]
        found.add(support.code, f"{written.TITLE}: {support.how}: {', '.join(names)}", span)
    for notion, handling in _HANDLINGS.items():
        support = written.EXPRESSES[notion]
        affected = [] if support.level is Level.EXACT else handling.affected(robot)
        if affected:
            found.add(support.code, f"{written.TITLE}: {support.how}: {', '.join(affected)}", span)
            left_out = support.level is Level.REPORTED and handling.leave_out is not None
            robot = handling.leave_out(robot) if left_out and handling.leave_out else handling.rewrite(robot)
    return robot


def _root_if(base: Base) -> Callable[[Robot], list[str]]:
    return lambda robot: [f"'{robot.root.name}' is {robot.base}"] if robot.base is base else []


def _sensors(kind: SensorKind) -> _Handling:
    return _Handling(sensors_of(kind), leave_out=without_sensors(kind))


# In this order: names before what refers to them, zeros of loops before limits and drawn poses.
_HANDLINGS: Mapping[Notion, _Handling] = {
    Notion.JOINT_NAME: _Handling(renamed_joints, rename_joints),
    Notion.FRAME_NAME: _Handling(renamed_frames, rename_frames),
    Notion.FLOATING: _Handling(joints_of(JointKind.FLOATING), floating_to_slides_and_ball),
    Notion.PLANAR: _Handling(joints_of(JointKind.PLANAR), planar_to_three),
    Notion.CYLINDRICAL: _Handling(joints_of(JointKind.CYLINDRICAL), cylindrical_to_two),
    Notion.SCREW: _Handling(joints_of(JointKind.SCREW), screw_to_mimic),
    Notion.UNIVERSAL: _Handling(joints_of(JointKind.UNIVERSAL), universal_to_revolutes),
    Notion.BALL: _Handling(joints_of(JointKind.BALL), ball_to_revolutes),
    Notion.BALL_LIMIT: _Handling(joints_where(is_limited_ball), each_joint(without_ball_limit)),
    Notion.BALL_FORCE: _Handling(joints_where(is_loaded_ball), each_joint(without_ball_force)),
    Notion.CLOSURE: _Handling(describe_closures(lambda closure: True), drop_closures),
    Notion.SLIDING_CLOSURE: _Handling(sliding_closures, recut_loops),
    Notion.STUCK_CLOSURE: _Handling(describe_closures(lambda closure: closure.kind is JointKind.PRISMATIC)),
    Notion.LOOP_ZERO: _Handling(loop_zeros, move_loop_zeros),
    Notion.INITIAL_POSE: _Handling(joints_where(lambda joint: joint.drawn_position != 0.0)),
    Notion.OPEN_POSITION: _Handling(joints_where(is_open), each_joint(bound)),
    Notion.OPEN_EFFORT: _Handling(joints_where(lacks_effort), each_joint(bound_effort)),
    Notion.VELOCITY: _Handling(
        joints_where(lambda joint: joint.kind is not JointKind.FIXED and isfinite(joint.limit.velocity))
    ),
    Notion.SPRING: _Handling(
        joints_where(lambda joint: joint.dynamics.stiffness != 0.0), leave_out=each_joint(without_spring)
    ),
    Notion.ARMATURE: _Handling(
        joints_where(lambda joint: joint.dynamics.armature != 0.0), each_joint(without_armature)
    ),
    Notion.MIMIC: _Handling(joints_where(lambda joint: joint.mimic is not None)),
    Notion.MIMIC_CHAIN: _Handling(chained_mimics, flatten_mimics),
    Notion.FRAME: _Handling(
        lambda robot: [f"'{frame.name}' on '{frame.link}'" for frame in robot.frames], frames_as_links
    ),
    Notion.ACTUATOR: _Handling(drives_where(lambda _robot, _actuator: True), leave_out=without_drives),
    Notion.GEAR: _Handling(drives_where(lambda _robot, actuator: actuator.gear != 1.0), gears_at_joints),
    Notion.DRIVE_INPUT: _Handling(drives_where(is_bounded_drive), leave_out=bounded_by_joints),
    Notion.OPEN_DRIVE: _Handling(drives_where(is_open_drive), bound_drives),
    Notion.JOINT_SENSOR: _sensors(SensorKind.JOINT),
    Notion.IMU: _sensors(SensorKind.IMU),
    Notion.FORCE_TORQUE: _sensors(SensorKind.FORCE_TORQUE),
    Notion.OFF_JOINT: _Handling(sensors_where(is_off_joint)),
    Notion.CAMERA: _sensors(SensorKind.CAMERA),
    Notion.LIDAR: _sensors(SensorKind.LIDAR),
    Notion.CONTACT: _sensors(SensorKind.CONTACT),
    Notion.SENSOR_PLACE: _Handling(sensors_where(has_place), sensors_as_links),
    Notion.SENSOR_RATE: _Handling(sensors_where(lambda sensor: sensor.rate != 0.0), leave_out=without_rates),
    Notion.ENCODER_RATE: _Handling(sensors_where(is_timed_encoder), leave_out=without_encoder_rates),
    Notion.CAMERA_EXTRAS: _Handling(sensors_where(has_camera_extras), leave_out=without_camera_extras),
    Notion.LIDAR_NEAREST: _Handling(sensors_where(is_blind_when_near), leave_out=seeing_what_is_near),
    Notion.OPEN_VIEW: _Handling(sensors_where(is_open_view), bound_views),
    Notion.CAPSULE: _Handling(links_with_capsules, split_capsules),
    Notion.FLAT_COLLISION: _Handling(flat_collisions, drop_flat_collisions),
    Notion.CONCAVE_COLLISION: _Handling(concave_collisions),
    Notion.FIXED_BASE: _Handling(_root_if(Base.FIXED)),
    Notion.FLOATING_BASE: _Handling(_root_if(Base.FLOATING)),
}
