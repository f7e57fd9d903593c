"""Elements of a URDF for specific readers: `<contact>`, `<gazebo>`, `<transmission>` and `<ros2_control>`.

https://github.com/gazebosim/sdf_tutorials/blob/master/docs/urdf/sdf_extensions.md
https://control.ros.org/rolling/doc

The hardware plugin depends on the hardware or the simulator: the written one is a placeholder of ros2_control that
mirrors every command. Inputs and limits are given at the joint. Gears are transmissions: the first of a joint takes the
joint's first command interface, and so on.
"""

from collections.abc import Collection, Sequence

from stepbot.robot.gains import actuator_limit, joint_range
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Link, Robot
from stepbot.robot.sensors import Sensor, SensorKind
from stepbot.robot.surfaces import PLAIN, Surface

from ..lowering.joints import UNLIMITED
from ..sdformat.sensors import sensors_on_joint, sensors_on_link
from ..xml import Element, element
from .chains import module_of_joint, passive_joints

HARDWARE = "mock_components/GenericSystem"
"""Placeholder for the hardware plugin, to be replaced in the user's configuration."""
INITIAL = "initial_value"
"""Parameter with the position in which a placeholder, or Gazebo, starts."""
_SIMPLE = "transmission_interface/SimpleTransmission"
COMMANDS = {ActuatorKind.POSITION: "position", ActuatorKind.VELOCITY: "velocity", ActuatorKind.MOTOR: "effort"}
"""The command interface of each kind of actuator."""
_STATES = ("position", "velocity", "effort")
_READINGS = {
    SensorKind.IMU: (
        *(f"orientation.{axis}" for axis in "xyzw"),
        *(f"angular_velocity.{axis}" for axis in "xyz"),
        *(f"linear_acceleration.{axis}" for axis in "xyz"),
    ),
    SensorKind.FORCE_TORQUE: (*(f"force.{axis}" for axis in "xyz"), *(f"torque.{axis}" for axis in "xyz")),
    SensorKind.JOINT: ("position", "velocity"),
}
"""The state interfaces that broadcasters of ros2_control look for."""


def transmissions(top: Element, robot: Robot) -> None:
    """Add a transmission for every actuator, by which Drake finds its joint; Drake reads no kind and no gear there."""
    for actuator in robot.actuators:
        xml = element(top, "transmission", name=actuator.name)
        element(xml, "type", _SIMPLE)
        element(xml, "joint", name=actuator.joint)
        element(xml, "actuator", name=actuator.name)


def systems(robot: Robot) -> dict[str, str]:
    """The ``<ros2_control>`` blocks of a robot: the name of each, by its module; empty for what is in none."""
    inside = module_of_joint(robot)
    used = {inside.get(actuator.joint, "") for actuator in robot.actuators}
    if any(sensor.kind in _READINGS for sensor in robot.sensors):
        used.add("")
    ordered = ("", *dict.fromkeys(inside.values()))
    return {module: f"{robot.name}_{module}" if module else robot.name for module in ordered if module in used}


def ros2_control(top: Element, robot: Robot) -> None:
    """Add a system for each module with actuators, one for all others, and the sensors that ros2_control reads."""
    inside, names = module_of_joint(robot), systems(robot)
    for module, name in names.items():
        system = element(top, "ros2_control", name=name, type="system")
        element(element(system, "hardware"), "plugin", HARDWARE)
        actuators = [actuator for actuator in robot.actuators if inside.get(actuator.joint, "") == module]
        sensors = [sensor for sensor in robot.sensors if sensor.kind in _READINGS and not module]
        passive = [joint for joint in passive_joints(robot) if _among(inside.get(joint, ""), names) == module]
        _system(system, robot, actuators, passive, sensors)


def _among(module: str, names: Collection[str]) -> str:
    """The system of a module, or the first one if it has none."""
    return module if module in names else next(iter(names))


def _system(
    system: Element, robot: Robot, actuators: Sequence[Actuator], passive: Sequence[str], sensors: Sequence[Sensor]
) -> None:
    for name in dict.fromkeys(actuator.joint for actuator in actuators):
        joint = element(system, "joint", name=name)
        for actuator in actuators:
            if actuator.joint == name:
                _command(joint, actuator, robot)
        _state(joint, robot.joint_by_name[name])
    for one in passive:
        _state(element(system, "joint", name=one), robot.joint_by_name[one])
    for sensor in sensors:
        xml = element(system, "sensor", name=sensor.name)
        for reading in _READINGS[sensor.kind]:
            element(xml, "state_interface", name=reading)
        if sensor.kind is not SensorKind.IMU:
            element(xml, "param", sensor.joint, name="joint")
    for actuator in actuators:
        xml = element(system, "transmission", name=actuator.name)
        element(xml, "plugin", _SIMPLE)
        element(xml, "actuator", name=actuator.name, role="actuator1")
        joint = element(xml, "joint", name=actuator.joint, role="joint1")
        if actuator.gear != 1.0:
            element(joint, "mechanical_reduction", actuator.gear)


def _state(xml: Element, joint: Joint) -> None:
    """Add what ros2_control states of a joint, with its drawn position as the start."""
    for name in _STATES:
        interface = element(xml, "state_interface", name=name)
        if name == "position":
            element(interface, "param", joint.drawn_position, name=INITIAL)


def _command(joint: Element, actuator: Actuator, robot: Robot) -> None:
    command = element(joint, "command_interface", name=COMMANDS[actuator.kind])
    driven = robot.joint_by_name[actuator.joint]
    low, high = joint_range(actuator, driven)
    parameters = {"min": low, "max": high}
    if actuator.kind is not ActuatorKind.MOTOR:
        effort = actuator_limit(actuator, driven).effort
        parameters |= {"max_effort": effort, "kp": actuator.kp, "kv": actuator.kv}
    for name, value in parameters.items():
        if value if name in ("kp", "kv") else abs(value) < UNLIMITED:
            element(command, "param", value, name=name)


def extensions(top: Element, robot: Robot) -> None:
    """Add friction, springs, actuators and sensors."""
    for joint in robot.joints:
        _of_joint(top, joint, robot)
    for link in robot.links:
        block = element(top, "gazebo", reference=link.name)
        friction = surface_of(link).friction
        if friction is not None:
            element(block, "mu1", friction)
            element(block, "mu2", friction)
        sensors_on_link(block, link, robot.sensors, _shapes_in_gazebo(link))
        if not len(block):
            top.remove(block)
    transmissions(top, robot)
    ros2_control(top, robot)


_BULLET = {
    "lateral_friction": "friction",
    "rolling_friction": "rolling",
    "spinning_friction": "torsional",
    "restitution": "restitution",
}


def surface_of(link: Link) -> Surface:
    """The contact properties of a link of a lowered robot, whose shapes all have the same."""
    return link.collisions[0].surface if link.collisions else PLAIN


def contact(xml: Element, link: Link) -> None:
    """Add PyBullet's contact properties of a link."""
    given = {tag: getattr(surface_of(link), name) for tag, name in _BULLET.items()}
    block = element(xml, "contact") if any(value is not None for value in given.values()) else xml
    for tag, value in given.items():
        if value is not None:
            element(block, tag, value=value)


def _shapes_in_gazebo(link: Link) -> list[str]:
    """Names of a link's collision shapes after Gazebo's conversion of URDF to SDFormat."""
    numbers = ["", *(f"_{i}" for i in range(1, len(link.collisions)))]
    return [f"{shape.name}_collision{number}" for shape, number in zip(link.collisions, numbers, strict=False)]


def _of_joint(top: Element, joint: Joint, robot: Robot) -> None:
    """The `<gazebo>` settings of a joint.

    Without them, Gazebo merges fixed joints, and loses their force-torque sensors and the names of shapes that contact
    sensors refer to.
    """
    fixed = joint.kind is JointKind.FIXED
    weighed = any(s.kind is SensorKind.FORCE_TORQUE and s.joint == joint.name for s in robot.sensors)
    watched = fixed and any(s.kind is SensorKind.CONTACT and s.link == joint.child for s in robot.sensors)
    spring = joint.dynamics.stiffness
    if not (weighed or watched or spring):
        return
    block = element(top, "gazebo", reference=joint.name)
    if spring:
        element(block, "springStiffness", spring)
        element(block, "springReference", joint.dynamics.spring_reference)
    if fixed:
        element(block, "preserveFixedJoint", "true")
    sensors_on_joint(block, joint.name, robot.sensors)
