"""Motors, position sensors and other sensors: https://cyberbotics.com/doc/reference/motor.

A motor of Webots has a controller of its own. Motors whose names have the same beginning before ``::`` are coupled:
they get the same command, times their ``multiplier``.
"""

from math import isinf

from stepbot.robot.gains import actuator_limit
from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.model import Actuator, Joint, JointKind, Robot
from stepbot.robot.sensors import Sensor, SensorKind

from ..lowering.joints import UNLIMITED
from ..lowering.stops import has_stops
from .vrml import Node, text


def stops(parameters: Node, joint: Joint) -> None:
    """Add the stops of a joint, damping and friction."""
    if has_stops(joint):
        parameters.set("minStop", max(joint.limit.lower, -UNLIMITED))
        parameters.set("maxStop", min(joint.limit.upper, UNLIMITED))
    if joint.dynamics.damping:
        parameters.set("dampingConstant", joint.dynamics.damping)
    if joint.dynamics.friction:
        parameters.set("staticFriction", joint.dynamics.friction)


def joint_devices(joint: Joint, robot: Robot) -> list[Node]:
    """The motor of a joint, if it has one, and its position sensor."""
    drives = {actuator.joint: actuator for actuator in robot.actuators}
    followed = {other.mimic.joint for other in robot.joints if other.mimic is not None}
    devices = []
    if joint.name in drives:
        drive = drives[joint.name]
        name = f"{drive.name}{SCOPE}{joint.name}" if joint.name in followed else drive.name
        devices.append(_motor(name, joint, drive))
    elif joint.mimic is not None and joint.mimic.joint in drives:
        name = f"{drives[joint.mimic.joint].name}{SCOPE}{joint.name}"
        devices.append(_motor(name, joint, None).set("multiplier", joint.mimic.multiplier))
    return [*devices, Node("PositionSensor").set("name", text(f"{joint.name}_sensor"))]


def _motor(name: str, joint: Joint, drive: Actuator | None) -> Node:
    slides = joint.kind is JointKind.PRISMATIC
    limit = joint.limit if drive is None else actuator_limit(drive, joint)
    motor = Node("LinearMotor" if slides else "RotationalMotor").set("name", text(name))
    if not (isinf(joint.limit.lower) and isinf(joint.limit.upper)):
        motor.set("minPosition", max(joint.limit.lower, -UNLIMITED))
        motor.set("maxPosition", min(joint.limit.upper, UNLIMITED))
    motor.set("maxVelocity", min(joint.limit.velocity, UNLIMITED))
    return motor.set("maxForce" if slides else "maxTorque", min(limit.effort, UNLIMITED))


def sensor_nodes(sensor: Sensor) -> list[Node]:
    """The devices of a sensor on a link; an IMU is three."""
    view = sensor.view
    match sensor.kind:
        case SensorKind.IMU:
            parts = {"InertialUnit": "", "Accelerometer": "_accelerometer", "Gyro": "_gyro"}
            return [_device(kind, sensor, sensor.name + suffix) for kind, suffix in parts.items()]
        case SensorKind.CAMERA:
            camera = _device("Camera", sensor, sensor.name).set("fieldOfView", view.fov)
            camera.set("width", view.columns).set("height", view.rows)
            return [camera.set("near", view.nearest).set("far", view.farthest)]
        case SensorKind.LIDAR:
            lidar = _device("Lidar", sensor, sensor.name).set("fieldOfView", view.fov)
            lidar.set("horizontalResolution", view.columns).set("numberOfLayers", 1).set("near", view.nearest)
            return [lidar.set("minRange", view.nearest).set("maxRange", view.farthest)]
        case _:
            return []


def _device(kind: str, sensor: Sensor, name: str) -> Node:
    return Node(kind).place(sensor.X_LS).set("name", text(name))
