"""Actuators and joint sensors from a model's Gazebo Sim plugins, read by the plugins' documentation."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stepbot.robot.model import ActuatorKind
from stepbot.robot.sensors import SensorKind

from ..observation import ObservedActuator, ObservedSensor
from .frames import number_at

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object

_SYSTEMS = "gz::sim::systems::"


def plugin_actuators(model: Element) -> Iterator[ObservedActuator]:
    """The actuators, which have no names here; gains and bounds are those at the joint."""
    for plugin in model.findall("plugin"):
        joint = (plugin.findtext("joint_name") or "").strip()
        match _system(plugin):
            case "JointPositionController":
                yield _controlled(plugin, joint, ActuatorKind.POSITION, default_i=0.1, default_d=0.01)
            case "JointController":
                yield _controlled(plugin, joint, ActuatorKind.VELOCITY, default_i=0.0, default_d=0.0)
            case "ApplyJointForce":
                yield ObservedActuator("", joint, ActuatorKind.MOTOR.value, gear=None)


def plugin_sensors(model: Element) -> Iterator[ObservedSensor]:
    """Publishers of joint states: of the listed joints, or of all."""
    for plugin in model.findall("plugin"):
        if _system(plugin) == "JointStatePublisher":
            named = [(element.text or "").strip() for element in plugin.findall("joint_name")]
            moving = [joint.get("name", "") for joint in model.findall("joint") if joint.get("type") != "fixed"]
            for joint in named or moving:
                yield ObservedSensor("", SensorKind.JOINT.value, joint=joint)


def _system(plugin: Element) -> str:
    """The class of a plugin, if it comes from its own library: ``gz-sim-<class-in-lower-case>-system``."""
    name = plugin.get("name", "").removeprefix(_SYSTEMS)
    library = "".join(f"-{letter.lower()}" if letter.isupper() else letter for letter in name)
    return name if plugin.get("filename") == f"gz-sim{library}-system" else ""


def _controlled(
    plugin: Element, joint: str, kind: ActuatorKind, *, default_i: float, default_d: float
) -> ObservedActuator:
    """An actuator with a PID controller; one with further features is reported as another kind."""
    p, i, d = (
        number_at(plugin, f"{letter}_gain", default)
        for letter, default in (("p", 1.0), ("i", default_i), ("d", default_d))
    )
    high, low = number_at(plugin, "cmd_max", 1000.0), number_at(plugin, "cmd_min", -1000.0)
    word = kind.value
    if kind is ActuatorKind.VELOCITY and plugin.findtext("use_force_commands", "").strip() not in ("true", "1"):
        word = "velocity without a force limit"
    if i or (d and kind is ActuatorKind.VELOCITY) or plugin.findtext("use_velocity_commands", "").strip() == "true":
        word = f"{word}, controlled otherwise"
    gains = (p, d) if kind is ActuatorKind.POSITION else (0.0, p)
    return ObservedActuator("", joint, word, *gains, gear=None, force=(low, high))
