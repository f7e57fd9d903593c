"""Sensors in SDFormat: http://sdformat.org/spec?elem=sensor. URDF has the same elements in `<gazebo>`.

Gazebo's only lidar is rendered on the graphics card: hence ``gpu_lidar``. The format has no joint sensor.
"""

from collections.abc import Sequence

from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import Link
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
    match sensor.kind:
        case SensorKind.FORCE_TORQUE:
            cell = element(xml, "force_torque")
            if sensor.X_LS.rotation != IDENTITY.rotation:
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
