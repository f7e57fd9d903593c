"""Actuators and sensors for ros2_control in a URDF: https://control.ros.org/rolling/doc.

The hardware plugin depends on the hardware or the simulator: the written one is a placeholder of ros2_control that
mirrors every command. Inputs and limits are given at the joint. Gears are transmissions: the first of a joint takes the
joint's first command interface, and so on.
"""

from collections.abc import Sequence

from stepbot.robot.gains import actuator_limit, joint_range
from stepbot.robot.model import Actuator, ActuatorKind, Robot
from stepbot.robot.sensors import Sensor, SensorKind

from ..lowering.joints import UNLIMITED
from ..xml import Element, element
from .chains import module_of_joint

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
    modules = [inside.get(actuator.joint, "") for actuator in robot.actuators]
    if any(sensor.kind in _READINGS for sensor in robot.sensors):
        modules.append("")
    return {module: f"{robot.name}_{module}" if module else robot.name for module in sorted(set(modules))}


def ros2_control(top: Element, robot: Robot) -> None:
    """Add a system for each module with actuators, one for all others, and the sensors that ros2_control reads."""
    inside = module_of_joint(robot)
    for module, name in systems(robot).items():
        system = element(top, "ros2_control", name=name, type="system")
        element(element(system, "hardware"), "plugin", HARDWARE)
        actuators = [one for one in robot.actuators if inside.get(one.joint, "") == module]
        sensors = [one for one in robot.sensors if one.kind in _READINGS and not module]
        _system(system, robot, actuators, sensors)


def _system(system: Element, robot: Robot, actuators: Sequence[Actuator], sensors: Sequence[Sensor]) -> None:
    for name in dict.fromkeys(actuator.joint for actuator in actuators):
        joint = element(system, "joint", name=name)
        for actuator in actuators:
            if actuator.joint == name:
                _command(joint, actuator, robot)
        for state in _STATES:
            interface = element(joint, "state_interface", name=state)
            if state == "position":
                element(interface, "param", robot.joint_by_name[name].drawn_position, name=INITIAL)
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
