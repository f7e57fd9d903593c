"""Actuators and sensors rewritten to what a format supports."""

from collections.abc import Callable
from math import inf, isinf

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.gains import actuator_limit, joint_range
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Actuator, ActuatorKind, Frame, JointKind, Limit, Robot
from stepbot.robot.renaming import names_of
from stepbot.robot.sensors import OPTICAL, SEEING, Sensor, SensorKind

from .joints import UNLIMITED, frames_as_links

NEAREST, FARTHEST = 0.1, 100.0
"""Range [m] of a camera or a lidar if a format requires one and the robot has none: SDFormat's default for a camera."""

_WITH_PLACE = (SensorKind.IMU, SensorKind.CAMERA, SensorKind.LIDAR)
"""Kinds of sensors that ROS expects on a link of their own."""
_SAME = 1e-6
"""Difference [m], or of rotation entries, of frames at one place."""


def sensors_where(condition: Callable[[Sensor], bool]) -> Callable[[Robot], list[str]]:
    """Names of the sensors that satisfy a condition, with their links or joints."""
    return lambda robot: [
        f"'{sensor.name}' on '{sensor.joint or sensor.link}'" for sensor in robot.sensors if condition(sensor)
    ]


def each_sensor(rewrite: Callable[[Sensor], Sensor]) -> Callable[[Robot], Robot]:
    """The robot with every sensor rewritten."""
    return lambda robot: replace(robot, sensors=tuple(map(rewrite, robot.sensors)))


def actuators_where(condition: Callable[[Robot, Actuator], bool]) -> Callable[[Robot], list[str]]:
    """Names of the actuators that satisfy a condition, and their joints."""
    return lambda robot: [
        f"'{actuator.name}' on '{actuator.joint}'" for actuator in robot.actuators if condition(robot, actuator)
    ]


def further_actuators(robot: Robot) -> list[str]:
    """Actuators on a joint that another one before them is on."""
    return [f"'{actuator.name}' on '{actuator.joint}'" for actuator in robot.actuators if actuator not in _first(robot)]


def without_further_actuators(robot: Robot) -> Robot:
    """The robot with the first actuator of each joint."""
    return replace(robot, actuators=_first(robot))


def _first(robot: Robot) -> tuple[Actuator, ...]:
    return tuple({actuator.joint: actuator for actuator in reversed(robot.actuators)}.values())[::-1]


def gears_at_joints(robot: Robot) -> Robot:
    """The robot with gains and inputs converted from the motor's side of each gear to the joint's."""

    def direct(actuator: Actuator) -> Actuator:
        square = actuator.gear**2
        return replace(actuator, kp=actuator.kp * square, kv=actuator.kv * square, gear=1.0)

    return replace(robot, actuators=tuple(direct(actuator) for actuator in robot.actuators))


def is_bounded_actuator(robot: Robot, actuator: Actuator) -> bool:
    """Whether an actuator's input has narrower bounds than its joint."""
    joint = robot.joint_by_name[actuator.joint]
    return joint_range(actuator, joint) != joint_range(_as_joint(actuator), joint)


def _as_joint(actuator: Actuator) -> Actuator:
    """The actuator without bounds of its own input; that of a motor is its effort."""
    effort = inf if actuator.kind is ActuatorKind.MOTOR else actuator.limit.effort
    return replace(actuator, limit=Limit(effort=effort))


def bounded_by_joints(robot: Robot) -> Robot:
    """The robot with actuators whose inputs are bounded only by their joints."""
    return replace(robot, actuators=tuple(_as_joint(actuator) for actuator in robot.actuators))


def is_unlimited_actuator(robot: Robot, actuator: Actuator) -> bool:
    """Whether a controlled actuator has no effort limit."""
    limit = actuator_limit(actuator, robot.joint_by_name[actuator.joint])
    return actuator.kind is not ActuatorKind.MOTOR and isinf(limit.effort)


def bound_actuators(robot: Robot) -> Robot:
    """The robot with numbers in place of missing effort limits of actuators."""
    actuators = [
        replace(a, limit=replace(a.limit, effort=UNLIMITED)) if is_unlimited_actuator(robot, a) else a
        for a in robot.actuators
    ]
    return replace(robot, actuators=tuple(actuators))


def is_open_view(sensor: Sensor) -> bool:
    """Whether a camera or a lidar has an unlimited range, or no minimum."""
    return sensor.kind in SEEING and (sensor.view.nearest == 0.0 or isinf(sensor.view.farthest))


def bounded_view(sensor: Sensor) -> Sensor:
    """The camera or lidar with a finite range."""
    nearest = sensor.view.nearest or min(NEAREST, 0.1 * sensor.view.farthest)
    farthest = max(FARTHEST, 10.0 * nearest) if isinf(sensor.view.farthest) else sensor.view.farthest
    return replace(sensor, view=replace(sensor.view, nearest=nearest, farthest=farthest))


def has_place(sensor: Sensor) -> bool:
    """Whether a sensor is not at the origin of its link."""
    return sensor.kind in _WITH_PLACE and sensor.X_LS != IDENTITY


def sensors_as_links(robot: Robot) -> Robot:
    """The robot with a massless link on a fixed joint for every sensor that is not at the origin of its link."""
    taken = set(names_of(robot, "links", "joints", "closures"))
    frames: list[Frame] = []
    sensors: list[Sensor] = []
    for sensor in robot.sensors:
        if has_place(sensor):
            frames.append(Frame(free_name(sensor.name, "_sensor", taken), sensor.link, sensor.X_LS))
            sensors.append(replace(sensor, link=frames[-1].name, X_LS=IDENTITY))
        else:
            sensors.append(sensor)
    mounted = frames_as_links(replace(robot, frames=tuple(frames), sensors=tuple(sensors)))
    return replace(mounted, frames=robot.frames)


def lacks_optical_frame(sensor: Sensor) -> bool:
    """Whether a sensor is a camera without a frame for its images."""
    return sensor.kind is SensorKind.CAMERA and not sensor.frame


def with_optical_frames(robot: Robot) -> Robot:
    """The robot with an optical frame for every camera, by which its images are named; one that exists is kept."""
    taken = set(names_of(robot, "links", "joints", "closures", "frames"))
    added: list[Frame] = []
    sensors: list[Sensor] = []
    for sensor in robot.sensors:
        if lacks_optical_frame(sensor):
            name, X_LF = f"{sensor.name}_optical_frame", sensor.X_LS @ OPTICAL
            if not _is_there(robot, name, sensor.link, X_LF):
                name = free_name(name, "_2", taken)
                added.append(Frame(name, sensor.link, X_LF))
            sensor = replace(sensor, frame=name)
        sensors.append(sensor)
    return replace(robot, frames=(*robot.frames, *added), sensors=tuple(sensors))


def _is_there(robot: Robot, name: str, link: str, X_LF: Pose) -> bool:
    """Whether a frame or a link that is fixed to a link is at a place."""
    frames = [(frame.link, frame.X_LF) for frame in robot.frames if frame.name == name]
    above = {joint.child: joint for joint in robot.joints if joint.kind is JointKind.FIXED}
    if name in robot.link_by_name:
        X = IDENTITY
        while name != link and name in above:
            name, X = above[name].parent, above[name].X_PC @ X
        frames.append((name, X))
    return any(on == link and np.allclose(X.matrix, X_LF.matrix, rtol=0.0, atol=_SAME) for on, X in frames)


def has_camera_extras(sensor: Sensor) -> bool:
    """Whether a camera has a rate or a limited range."""
    bounded = sensor.view.nearest != 0.0 or not isinf(sensor.view.farthest)
    return sensor.kind is SensorKind.CAMERA and (sensor.rate != 0.0 or bounded)
