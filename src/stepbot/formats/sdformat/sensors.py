"""Sensors in SDFormat: http://sdformat.org/spec?elem=sensor. URDF has the same elements in `<gazebo>`.

Gazebo's only lidar is rendered on the graphics card: hence ``gpu_lidar``. The format has no joint sensor.
"""

import re
from collections.abc import Sequence

from stepbot.geometry.spatial import Pose
from stepbot.robot.gains import force_range
from stepbot.robot.model import Actuator, ActuatorKind, Joint, Link, Robot
from stepbot.robot.sensors import Sensor, SensorKind

from ..xml import Element, element

_TYPES = {
    SensorKind.IMU: "imu",
    SensorKind.FORCE_TORQUE: "force_torque",
    SensorKind.CAMERA: "camera",
    SensorKind.LIDAR: "gpu_lidar",
    SensorKind.CONTACT: "contact",
}
"""The format's name of each kind."""
_TOPICS = {
    SensorKind.IMU: "imu",
    SensorKind.FORCE_TORQUE: "wrench",
    SensorKind.CAMERA: "image",
    SensorKind.LIDAR: "scan",
}
_IN_LINK = (SensorKind.IMU, SensorKind.LIDAR)
"""Kinds that measure in the frame of their link if they are at its origin."""
_TOPIC = re.compile(r"[A-Za-z][A-Za-z0-9_]*|\$\{prefix\}[A-Za-z0-9_]+")
"""Names that ROS allows in topics; the prefix of a xacro is the user's."""


def sensors_on_link(xml: Element, link: Link, sensors: Sequence[Sensor], shapes: Sequence[str]) -> None:
    """Add the sensors that are mounted on a link; ``shapes`` are the names of its collision shapes."""
    for sensor in sensors:
        if sensor.link == link.name and sensor.kind in _TYPES and sensor.kind is not SensorKind.FORCE_TORQUE:
            sdf_sensor(xml, sensor, shapes)


def sensors_on_joint(xml: Element, joint: str, sensors: Sequence[Sensor]) -> None:
    """Add the force-torque sensors of a joint."""
    for sensor in sensors:
        if sensor.joint == joint and sensor.kind is SensorKind.FORCE_TORQUE:
            sdf_sensor(xml, sensor)


def sdf_sensor(parent: Element, sensor: Sensor, shapes: Sequence[str] = ()) -> Element:
    """Add one sensor; ``shapes`` are the collision shapes of a contact sensor."""
    xml = element(parent, "sensor", name=sensor.name, type=_TYPES[sensor.kind])
    sdf_pose(xml, sensor.X_LS)
    if sensor.rate:
        element(xml, "update_rate", sensor.rate)
    if topic := topic_of(sensor):
        element(xml, "topic", topic)
    at_link = sensor.kind in _IN_LINK and sensor.X_LS.is_identity
    if frame := sensor.frame or (sensor.link if at_link else ""):
        element(xml, "gz_frame_id", frame)
    match sensor.kind:
        case SensorKind.FORCE_TORQUE:
            cell = element(xml, "force_torque")
            if not sensor.X_LS.is_identity:
                element(cell, "frame", "sensor")
            element(cell, "measure_direction", "parent_to_child")
        case SensorKind.CAMERA:
            _camera(xml, sensor)
        case SensorKind.LIDAR:
            _lidar(xml, sensor)
        case SensorKind.CONTACT:
            contact = element(xml, "contact")
            for shape in shapes:
                element(contact, "collision", shape)
    return xml


def topic_of(sensor: Sensor) -> str:
    """The topic on which Gazebo publishes a sensor, ``wrist_camera/image``; empty for a name that none can have."""
    ending = _TOPICS.get(sensor.kind, "")
    return f"{sensor.name}/{ending}" if ending and _TOPIC.fullmatch(sensor.name) else ""


def _camera(xml: Element, sensor: Sensor) -> None:
    camera = element(xml, "camera")
    element(camera, "horizontal_fov", sensor.view.fov)
    image = element(camera, "image")
    element(image, "width", sensor.view.columns)
    element(image, "height", sensor.view.rows)
    clip = element(camera, "clip")
    element(clip, "near", sensor.view.nearest)
    element(clip, "far", sensor.view.farthest)


def _lidar(xml: Element, sensor: Sensor) -> None:
    lidar = element(xml, "lidar")
    horizontal = element(element(lidar, "scan"), "horizontal")
    element(horizontal, "samples", sensor.view.columns)
    element(horizontal, "min_angle", -0.5 * sensor.view.fov)
    element(horizontal, "max_angle", 0.5 * sensor.view.fov)
    reach = element(lidar, "range")
    element(reach, "min", sensor.view.nearest)
    element(reach, "max", sensor.view.farthest)


def sdf_pose(parent: Element, X: Pose) -> None:
    """Add a pose, which is omitted if it is the identity."""
    if not X.is_identity:
        element(parent, "pose", (*X.position, *X.rpy))


_PLUGINS = {
    ActuatorKind.POSITION: ("gz-sim-joint-position-controller-system", "gz::sim::systems::JointPositionController"),
    ActuatorKind.VELOCITY: ("gz-sim-joint-controller-system", "gz::sim::systems::JointController"),
    ActuatorKind.MOTOR: ("gz-sim-apply-joint-force-system", "gz::sim::systems::ApplyJointForce"),
}
"""Library and class for each kind of actuator."""
_STATE = ("gz-sim-joint-state-publisher-system", "gz::sim::systems::JointStatePublisher")


def plugins(model: Element, robot: Robot) -> None:
    """Add a plugin for every actuator, and one for all joint sensors: they publish on one topic."""
    for actuator in robot.actuators:
        _drive(model, actuator, robot.joint_by_name[actuator.joint])
    measured = [sensor.joint for sensor in robot.sensors if sensor.kind is SensorKind.JOINT]
    if measured:
        xml = _plugin(model, *_STATE)
        for joint in measured:
            element(xml, "joint_name", joint)


def _drive(model: Element, actuator: Actuator, joint: Joint) -> None:
    xml = _plugin(model, *_PLUGINS[actuator.kind])
    element(xml, "joint_name", actuator.joint)
    if actuator.kind is ActuatorKind.MOTOR:
        return
    low, high = force_range(actuator, joint)
    if actuator.kind is ActuatorKind.POSITION:
        gains = {"p_gain": actuator.kp, "i_gain": 0.0, "d_gain": actuator.kv}
    else:
        element(xml, "use_force_commands", "true")  # without it the plugin sets velocities with unlimited force
        gains = {"p_gain": actuator.kv}
    for name, value in {**gains, "cmd_max": high, "cmd_min": low}.items():
        element(xml, name, value)


def _plugin(model: Element, filename: str, name: str) -> Element:
    return element(model, "plugin", filename=filename, name=name)
