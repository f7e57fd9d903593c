"""Sensors of an SDFormat model, or of the `<gazebo>` blocks of a URDF, read by the specification.

http://sdformat.org/spec?elem=sensor
"""

from collections.abc import Iterable, Iterator

from msgspec.structs import replace

from stepbot.geometry.spatial import Pose
from stepbot.robot.sensors import SensorKind

from ..observation import ObservedSensor
from ..xml import Element
from .frames import Frames, count_at, ends, finite_at, number_at, read_pose, relative_to

_KINDS = {
    "imu": SensorKind.IMU,
    "force_torque": SensorKind.FORCE_TORQUE,
    "camera": SensorKind.CAMERA,
    "contact": SensorKind.CONTACT,
    **dict.fromkeys(("lidar", "gpu_lidar", "ray", "gpu_ray"), SensorKind.LIDAR),
}
"""The format's names of sensor kinds; others are reported verbatim."""


def model_sensors(model: Element, frames: Frames) -> Iterator[ObservedSensor]:
    """The sensors on the links and in the joints of a model."""
    for link in model.findall("link"):
        name = link.get("name", "")
        shapes = [collision.get("name", "") for collision in link.findall("collision")]
        for sensor in link.findall("sensor"):
            X_LS = frames.X_M(name).inverse() @ frames.X_M(relative_to(sensor) or name) @ read_pose(sensor)
            yield read_sensor(sensor, name, X_LS, shapes=shapes)
    for joint in model.findall("joint"):
        name, child = joint.get("name", ""), frames.link_of(ends(joint)[1])
        for sensor in joint.findall("sensor"):
            X_LS = frames.X_M(child).inverse() @ frames.X_M(relative_to(sensor) or name) @ read_pose(sensor)
            yield read_sensor(sensor, child, X_LS, joint=name)


def read_sensor(
    sensor: Element, link: str, X_LS: Pose, *, joint: str | None = None, shapes: Iterable[str] = ()
) -> ObservedSensor:
    """One sensor.

    Args:
        link: Its link; the child of its joint.
        shapes: Names of the collision shapes of the link.
    """
    word = sensor.get("type", "")
    kind = _KINDS.get(word)
    rate = number_at(sensor, "update_rate", 0.0)
    seen = ObservedSensor(sensor.get("name", ""), word if kind is None else kind.value, link, joint, rate=rate)
    match kind:
        case SensorKind.IMU:
            return replace(seen, X_LS=X_LS)
        case SensorKind.FORCE_TORQUE:
            return _force_torque(sensor, seen, X_LS)
        case SensorKind.CAMERA:
            return _camera(sensor, seen, X_LS)
        case SensorKind.LIDAR:
            return _lidar(sensor, seen, X_LS)
        case SensorKind.CONTACT:
            watched = sorted((element.text or "").strip() for element in sensor.findall("contact/collision"))
            return seen if watched == sorted(shapes) else replace(seen, kind=f"contact of {', '.join(watched)}")
    return seen


def _force_torque(sensor: Element, seen: ObservedSensor, X_LS: Pose) -> ObservedSensor:
    """In the axes of the sensor or of the child, of the parent on the child: anything else is another kind."""
    frame = sensor.findtext("force_torque/frame", "child").strip()
    direction = sensor.findtext("force_torque/measure_direction", "child_to_parent").strip()
    if frame not in ("sensor", "child") or direction != "parent_to_child":
        return replace(seen, kind=f"{seen.kind} in the {frame} frame, {direction}")
    return replace(seen, X_LS=X_LS if frame == "sensor" else Pose())


def _camera(sensor: Element, seen: ObservedSensor, X_LS: Pose) -> ObservedSensor:
    camera = sensor.find("camera")
    return replace(
        seen,
        X_LS=X_LS @ read_pose(camera),
        fov=finite_at(camera, "horizontal_fov", 1.047),
        columns=count_at(camera, "image/width", 320),
        rows=count_at(camera, "image/height", 240),
        nearest=number_at(camera, "clip/near", 0.1),
        farthest=number_at(camera, "clip/far", 100.0),
    )


def _lidar(sensor: Element, seen: ObservedSensor, X_LS: Pose) -> ObservedSensor:
    """The centre of a lidar's range is x of its frame, along which a single ray points."""
    lidar = sensor.find("lidar") if sensor.find("lidar") is not None else sensor.find("ray")
    low = finite_at(lidar, "scan/horizontal/min_angle", 0.0)
    high = finite_at(lidar, "scan/horizontal/max_angle", 0.0)
    columns = count_at(lidar, "scan/horizontal/samples", 640)
    return replace(
        seen,
        X_LS=X_LS @ Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, 0.5 * low + 0.5 * high)),
        fov=high - low if columns > 1 else 0.0,
        columns=columns,
        rows=count_at(lidar, "scan/vertical/samples", 1),
        nearest=number_at(lidar, "range/min", 0.0),
        farthest=number_at(lidar, "range/max", 0.0),
    )
