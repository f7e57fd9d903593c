"""Actuators and joint sensors as plugins of Gazebo Sim: https://gazebosim.org/docs/latest/joint_controllers.

An actuator is controlled by a PID controller without an integral part, whose gains and limits are given at the joint; a
motor takes efforts directly, within the limit of its joint. Topics are Gazebo's defaults, which contain the joint's
name: the names of actuators and sensors are not written.
"""

from stepbot.robot.actuators import force_range
from stepbot.robot.model import Actuator, ActuatorKind, Joint, Robot
from stepbot.robot.sensors import SensorKind

from ..xml import Element, element

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
