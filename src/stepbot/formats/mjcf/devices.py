"""Actuators and sensors of MJCF.

The readings of a sensor are named ``<sensor>::<reading>``, and its site ``<sensor>::site``, which no name of the robot
can be. MuJoCo's cameras look along -z with y up, its rangefinders along z.
"""

from collections.abc import Collection
from math import atan, degrees, isfinite, tan

from stepbot.geometry.spatial import Pose
from stepbot.robot.gains import control_range, force_range, line_damping
from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Link, Robot
from stepbot.robot.multi_dof import steps_by_child
from stepbot.robot.sensors import Sensor, SensorKind

from ..xml import Element, Value, element

SITE = "site"
"""Last part of the name of a sensor's site."""
MARK = "mark"
"""Class of the sites that only mark the pose of a sensor or a closure."""
RAY = "ray"
"""Last part of the names of a lidar's rays, before their numbers."""

# The camera's x, y, z in the axes of the sensor: right is -y, up is z, and it looks along x.
_X_SC = Pose(((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
_QUARTER_ABOUT_Y = Pose(((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)))
"""Pose of a ray, which is z of its site, along x of the sensor."""

_READINGS = {
    SensorKind.IMU: {"accelerometer": "accelerometer", "gyro": "gyro", "orientation": "framequat"},
    SensorKind.FORCE_TORQUE: {"force": "force", "torque": "torque"},
}
"""For each kind of sensor at a site, the names of its readings, and their elements."""
NEW = 3.7
"""The first version of MuJoCo that is known to read contact sensors, intervals of sensors and damping of actuators."""
AT_SITES = frozenset({*_READINGS, SensorKind.LIDAR})
"""Kinds of sensors that have sites."""


def actuators(top: Element, robot: Robot, lines: Collection[str]) -> None:
    """Add the actuators.

    Args:
        lines: Actuators whose torque-speed line is a constraint.
    """
    if robot.actuators:
        xml = element(top, "actuator")
        for actuator in robot.actuators:
            joint, has_damping = robot.joint_by_name[actuator.joint], robot.versions.mjcf >= NEW
            _actuator(xml, actuator, joint, has_damping=has_damping, has_line=actuator.name in lines)


def _actuator(parent: Element, actuator: Actuator, joint: Joint, *, has_damping: bool, has_line: bool) -> None:
    """An actuator; its control and force are on the actuator's side of the gear, its joint's limits on the other.

    Args:
        has_damping: Whether this version of MuJoCo has damping of actuators.
        has_line: Whether a constraint has the damping of its torque-speed line.
    """
    optional: dict[str, Value] = {"gear": actuator.gear} if actuator.gear != 1.0 else {}
    if actuator.kind is ActuatorKind.POSITION:
        optional["kp"] = actuator.kp
    # The part of kv that the effort limit does not cut off: at the velocity limit it uses up the effort.
    line = min(line_damping(actuator, joint) / actuator.gear**2, actuator.kv) if has_damping or has_line else 0.0
    if line and not has_line:
        optional["damping"] = line
    if actuator.kind is ActuatorKind.VELOCITY or actuator.kv > line:
        optional["kv"] = actuator.kv - line
    control, force = control_range(actuator, joint), force_range(actuator, joint)
    if all(map(isfinite, control)):
        optional["ctrlrange"] = control
    if isfinite(force[1]) and actuator.kind is not ActuatorKind.MOTOR:
        optional["forcerange"] = force
    element(parent, actuator.kind.value, name=actuator.name, joint=actuator.joint, **optional)


def mounts(body: Element, link: Link, robot: Robot) -> None:
    """Add the sites of the sensors on a link."""
    for sensor in robot.sensors:
        if sensor.link != link.name:
            continue
        if sensor.kind in _READINGS:
            element(body, "site", name=f"{sensor.name}{SCOPE}{SITE}", class_=MARK, **mjcf_pose(sensor.X_LS))
        elif sensor.kind is SensorKind.CAMERA:
            view = sensor.view
            fovy = degrees(2.0 * atan(tan(0.5 * view.fov) * view.rows / view.columns))
            place = mjcf_pose(sensor.X_LS @ _X_SC)
            element(body, "camera", name=sensor.name, **place, fovy=fovy, resolution=(view.columns, view.rows))
        elif sensor.kind is SensorKind.LIDAR:
            _rays(body, sensor)


def _rays(body: Element, sensor: Sensor) -> None:
    """A site for each ray of a lidar, from the right edge of its field of view to the left one.

    Each is written, since dm_control has no ``<replicate>``.
    """
    view = sensor.view
    step = view.fov / (view.columns - 1) if view.columns > 1 else 0.0
    for number, site in enumerate(_ray_names(sensor, RAY)):
        turn = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, number * step - 0.5 * view.fov))
        element(body, "site", name=site, class_=MARK, **mjcf_pose(sensor.X_LS @ turn @ _QUARTER_ABOUT_Y))


def _ray_names(sensor: Sensor, part: str) -> list[str]:
    """A name for each ray of a lidar."""
    digits = len(str(sensor.view.columns - 1))
    return [f"{sensor.name}{SCOPE}{part}{SCOPE}{number:0{digits}}" for number in range(sensor.view.columns)]


def sensors(top: Element, robot: Robot) -> None:
    """Add the readings of the sensors; a camera has none, it is rendered on request."""
    measuring = [sensor for sensor in robot.sensors if sensor.kind is not SensorKind.CAMERA]
    if measuring:
        xml = element(top, "sensor")
        for sensor in measuring:
            _readings(xml, sensor, robot)


def _readings(xml: Element, sensor: Sensor, robot: Robot) -> None:
    # Without a buffer for its last reading, MuJoCo ignores the interval, and measures in every step.
    timing: dict[str, Value] = {"interval": 1.0 / sensor.rate, "nsample": 1} if sensor.rate else {}
    match sensor.kind:
        case SensorKind.IMU | SensorKind.FORCE_TORQUE:
            for reading, tag in _READINGS[sensor.kind].items():
                site = f"{sensor.name}{SCOPE}{SITE}"
                place = {"objtype": "site", "objname": site} if tag == "framequat" else {"site": site}
                element(xml, tag, name=f"{sensor.name}{SCOPE}{reading}", **place, **timing)
        case SensorKind.JOINT:
            steps = [step for step in steps_by_child(robot)[sensor.link] if step.mimic is None]
            for step in steps or [robot.joint_by_name[sensor.joint]]:
                _joint_readings(xml, sensor, step, alone=len(steps) <= 1, timing=timing)
        case SensorKind.LIDAR:
            farthest: dict[str, Value] = {"cutoff": sensor.view.farthest} if isfinite(sensor.view.farthest) else {}
            for name, site in zip(_ray_names(sensor, "range"), _ray_names(sensor, RAY), strict=True):
                element(xml, "rangefinder", name=name, site=site, **farthest, **timing)
        case SensorKind.CONTACT:
            what: dict[str, Value] = {"data": "found force torque", "reduce": "netforce"}
            element(xml, "contact", name=sensor.name, body1=sensor.link, **what, **timing)


def _joint_readings(xml: Element, sensor: Sensor, step: Joint, *, alone: bool, timing: dict[str, Value]) -> None:
    ball = step.kind is JointKind.BALL
    stem = sensor.name if alone else f"{sensor.name}{SCOPE}{step.name}"
    element(xml, "ballquat" if ball else "jointpos", name=f"{stem}{SCOPE}position", joint=step.name, **timing)
    element(xml, "ballangvel" if ball else "jointvel", name=f"{stem}{SCOPE}velocity", joint=step.name, **timing)


def mjcf_pose(X: Pose) -> dict[str, Value]:
    """The attributes of a pose; none for the identity."""
    pose: dict[str, Value] = {}
    if any(X.position):
        pose["pos"] = X.position
    if any(X.quaternion[1:]):
        pose["quat"] = X.quaternion
    return pose
