"""Nodes of a PROTO: shapes, motors and sensors."""

from collections.abc import Sequence
from math import isinf

from stepbot.robot.gains import actuator_limit
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.model import (
    Actuator,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Joint,
    JointKind,
    MeshRef,
    Robot,
    Sphere,
    Visual,
)
from stepbot.robot.sensors import Sensor, SensorKind
from stepbot.robot.surfaces import Surface

from ..lowering.joints import UNLIMITED, has_stops
from ..lowering.shapes import upright
from ..xml import number
from .vrml import Node, text


def visual_node(visual: Visual, files: MeshFiles) -> Node:
    """A visual in its link."""
    red, green, blue, alpha = visual.rgba
    appearance = Node("PBRAppearance").set("baseColor", (red, green, blue)).set("roughness", 0.5).set("metalness", 0.0)
    if alpha < 1.0:
        appearance.set("transparency", 1.0 - alpha)
    shape = Node("Shape").set("appearance", appearance).set("geometry", _geometry(visual, files))
    return _placed(visual, shape)


def bounding_object(collisions: Sequence[Collision], files: MeshFiles) -> Node:
    """All collisions of a link."""
    nodes = [_placed(shape, _geometry(shape, files)) for shape in collisions]
    return nodes[0] if len(nodes) == 1 else Node("Group").set("children", nodes)


def contact_materials(robot: Robot) -> dict[Surface, str]:
    """The names of the contact properties of a lowered robot, of which a link has one."""
    stated = dict.fromkeys(shape.surface for link in robot.links for shape in link.collisions[:1])
    surfaces = [surface for surface in stated if surface.is_stated]
    return {surface: f"{robot.name} {i}" for i, surface in enumerate(surfaces, start=1)}


def contact_properties(robot: Robot) -> list[Node]:
    """The contact properties of a robot, against what has none."""
    nodes = []
    for surface, name in contact_materials(robot).items():
        node = Node("ContactProperties").set("material1", text(name))
        if surface.friction is not None:
            node.set("coulombFriction", f"[ {number(surface.friction)} ]")
        if surface.restitution is not None:
            node.set("bounce", surface.restitution)
        if surface.rolling is not None or surface.torsional is not None:
            rolling = surface.rolling or 0.0
            node.set("rollingFriction", (rolling, rolling, surface.torsional or 0.0))
        nodes.append(node)
    return nodes


def _placed(shape: Visual | Collision, node: Node) -> Node:
    return Node("Pose").place(upright(shape)).set("children", [node])


def _geometry(shape: Visual | Collision, files: MeshFiles) -> Node:
    match shape.geometry:
        case Box(size):
            return Node("Box").set("size", size)
        case Cylinder(radius, length):
            return Node("Cylinder").set("radius", radius).set("height", length)
        case Capsule(radius, length):
            return Node("Capsule").set("radius", radius).set("height", length)
        case Sphere(radius):
            return Node("Sphere").set("radius", radius)
        case MeshRef():
            return Node("Mesh").set("url", f"[ {text(files.of(shape).path)} ]")


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
