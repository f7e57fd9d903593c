"""The blocks of a URDF that no engine reads, read back: `<gazebo>`, `<transmission>`, `<ros2_control>`.

It is stepbot's own parser, written from the documentation of Gazebo and ros2_control, independent of the writer. It
reports springs, links without gravity, actuators and sensors; the engines check everything else. It confirms the text,
not the behaviour of an engine: reports count its checks separately.

https://control.ros.org/rolling/doc, http://wiki.ros.org/urdf/XML/Transmission
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from math import inf, isnan
from pathlib import Path

from msgspec.structs import replace

from stepbot.robot.joint_types import PAIRS
from stepbot.robot.model import ActuatorKind, JointDynamics
from stepbot.robot.sensors import SensorKind
from stepbot.version import __version__

from ..observation import (
    EngineRefused,
    Observation,
    ObservedActuator,
    ObservedJoint,
    ObservedLink,
    ObservedSensor,
    Quantity,
    Request,
)
from ..sdformat_reader.frames import bool_at, number_at, numbers, read_pose
from ..sdformat_reader.sensors import read_sensor
from ..xml import Element, xml_root
from . import ENGINE

_TOLD = (
    Quantity.LOAD,
    Quantity.DYNAMICS,
    Quantity.GRAVITY_SETTINGS,
    Quantity.ACTUATORS,
    Quantity.SENSORS,
    Quantity.WARNINGS,
)
_LEFT = "checked by the engines"
_NOTE = "extension blocks, read by stepbot's own parser only"


def prepare() -> None:
    """Nothing to import."""
    import lxml.etree  # noqa: F401


def observe(request: Request) -> Observation:
    """Parse the file and report the content of its blocks.

    Raises:
        EngineRefused: The file is not XML, or a value is not a number.
    """
    top = xml_root(Path(request.file))
    blocks = bool(top.findall("gazebo") or top.findall("transmission") or top.findall("ros2_control"))
    return Observation(
        engine=ENGINE.name,
        version=__version__,
        format=request.format,
        links=tuple(_link(link, top) for link in top.findall("link")),
        joints=tuple(_joint(joint, top) for joint in top.findall("joint")),
        gravity=(),
        actuators=tuple(observed_actuators(top)),
        sensors=tuple(_sensors(top)),
        warnings=tuple(faults(top)),
        not_run={quantity: _LEFT for quantity in Quantity if quantity not in _TOLD},
        notes=(_NOTE,) if blocks else (),
    )


def _ends(joint: Element) -> tuple[str, str]:
    parent, child = joint.find("parent"), joint.find("child")
    return ("" if parent is None else parent.get("link", "")), ("" if child is None else child.get("link", ""))


def _link(link: Element, top: Element) -> ObservedLink:
    """A link, with nothing but its gravity compensation."""
    name, weightless = link.get("name", ""), False
    for block in top.findall("gazebo"):
        if block.get("reference") == name:
            weightless = not _stated(block, "gravity", not _stated(block, "turnGravityOff", weightless, False), True)
    return ObservedLink(name, gravity_compensation=1.0 if weightless else 0.0)


def _stated(block: Element, name: str, default: bool, empty: bool) -> bool:
    """The truth value of an element of a block, as Gazebo reads it if it is ``empty``."""
    is_empty = block.find(name) is not None and not (block.findtext(name) or "").strip()
    return empty if is_empty else bool_at(block, name, default)


def _joint(joint: Element, top: Element) -> ObservedJoint:
    """A joint, of which only the spring is reported."""
    name, (parent, child) = joint.get("name", ""), _ends(joint)
    blocks = [block for block in top.findall("gazebo") if block.get("reference") == name]
    block = next((block for block in blocks if block.find("springStiffness") is not None), None)
    spring = JointDynamics(
        stiffness=number_at(block, "springStiffness", 0.0), spring_reference=number_at(block, "springReference", 0.0)
    )
    return ObservedJoint(
        name, joint.get("type", ""), parent, child, dynamics=spring, dynamics_fields=("stiffness", "spring_reference")
    )


def _sensors(top: Element) -> Iterator[ObservedSensor]:
    """The sensors in Gazebo's blocks, combined with those of ros2_control."""
    joints = {joint.get("name", ""): joint for joint in top.findall("joint")}
    states = state_sensors(top)
    for block in top.findall("gazebo"):
        on = block.get("reference", "")
        for element in block.findall("sensor"):
            sensor = _in_block(element, on, joints, top)
            state = states.pop(sensor.name, None)
            yield in_gazebo_alone(sensor) if state is None else in_both(state, sensor)
    for state in states.values():
        yield in_ros2_control_alone(state)


def _in_block(element: Element, on: str, joints: dict[str, Element], top: Element) -> ObservedSensor:
    """A sensor of a block that refers to a joint or a link."""
    X_LS = read_pose(element)
    if on in joints:
        _, child = _ends(joints[on])
        return read_sensor(element, child, X_LS, joint=on)
    return read_sensor(element, on, X_LS, shapes=_shapes_in_gazebo(top, on))


def _shapes_in_gazebo(top: Element, link: str) -> list[str]:
    """Names of a link's collision shapes in Gazebo: that of the shape or the link, and a number."""
    shapes = [shape for one in top.findall("link") if one.get("name") == link for shape in one.findall("collision")]
    return [
        f"{shape.get('name') or link}_collision" + (f"_{number}" if number else "")
        for number, shape in enumerate(shapes)
    ]


_COMMANDS = {"position": ActuatorKind.POSITION, "velocity": ActuatorKind.VELOCITY, "effort": ActuatorKind.MOTOR}
_INTERFACES = {f"hardware_interface/{word.capitalize()}JointInterface": kind for word, kind in _COMMANDS.items()}
"""ROS 1's names of an actuator's input."""
_TRANSMISSION = "ros2_control/transmission"
_SIMPLE = "transmission_interface/SimpleTransmission"
_STATES = {"position", "velocity", "effort"}
_READINGS = {
    frozenset({"position", "velocity"}): SensorKind.JOINT,
    frozenset(f"{what}.{axis}" for what in ("force", "torque") for axis in "xyz"): SensorKind.FORCE_TORQUE,
    frozenset(
        (
            *(f"orientation.{axis}" for axis in "xyzw"),
            *(f"{what}.{axis}" for what in ("angular_velocity", "linear_acceleration") for axis in "xyz"),
        )
    ): SensorKind.IMU,
}
"""The kind of a sensor, by its state interfaces."""
_WITH_STATES = (SensorKind.IMU.value, SensorKind.FORCE_TORQUE.value)
"""Kinds of sensors for which ros2_control has broadcasters."""


def in_both(state: ObservedSensor, sensor: ObservedSensor) -> ObservedSensor:
    """The sensor of a Gazebo block with one of its name in ros2_control, if both agree."""
    if state.kind != sensor.kind:
        return replace(sensor, kind=f"{sensor.kind} in <gazebo>, {state.kind} in <ros2_control>")
    if sensor.joint is not None and state.joint != sensor.joint:
        return replace(sensor, joint=f"{sensor.joint} in <gazebo>, {state.joint} in <ros2_control>")
    return sensor


def in_ros2_control_alone(state: ObservedSensor) -> ObservedSensor:
    """A sensor of ros2_control without a Gazebo counterpart."""
    kind = state.kind if state.kind not in _WITH_STATES else f"{state.kind} in <ros2_control> alone"
    return replace(state, kind=kind, joint=state.joint or "")


def in_gazebo_alone(sensor: ObservedSensor) -> ObservedSensor:
    """A Gazebo sensor without a ros2_control counterpart, which is correct for kinds that ros2_control lacks."""
    return replace(sensor, kind=f"{sensor.kind} in <gazebo> alone") if sensor.kind in _WITH_STATES else sensor


def state_sensors(top: Element) -> dict[str, ObservedSensor]:
    """The sensors of ros2_control, by name."""
    sensors = {}
    for element in top.findall("ros2_control/sensor"):
        readings = frozenset(one.get("name", "") for one in element.findall("state_interface"))
        kind = _READINGS.get(readings)
        name, joint = element.get("name", ""), element.find("param[@name='joint']")
        on = None if joint is None else (joint.text or "").strip()
        sensors[name] = ObservedSensor(name, kind.value if kind else " and ".join(sorted(readings)), joint=on)
    return sensors


def observed_actuators(top: Element) -> Iterator[ObservedActuator]:
    """The actuators: the inputs of their joints, converted by the gears of their transmissions.

    Actuators without a transmission have no names; those with only a ROS 1 transmission have neither gains nor bounds.
    """
    old = top.findall("transmission")  # names of which may be repeated
    taken: set[tuple[str, str]] = set()
    before: Counter[str] = Counter()
    for element in top.findall(_TRANSMISSION):
        joint = _name_of(element.find("joint"))
        same = next((one for one in old if one.get("name", "") == element.get("name", "")), None)
        old = [one for one in old if one is not same]
        actuator = _behind_gear(element, same, _inputs(top, joint), before[joint])
        before[joint] += 1
        taken.add((actuator.joint, actuator.kind))
        yield actuator
    for element in old:
        joint, word, gear = _of_ros_1(element)
        if not word and (inputs := _inputs(top, joint)):
            word = inputs[0].get("name", "")
            word = _COMMANDS[word].value if word in _COMMANDS else word
        taken.add((joint, word))
        yield ObservedActuator(element.get("name", ""), joint, word, None, None, gear)
    for holder in top.findall("ros2_control/joint"):
        joint = holder.get("name", "")
        for command in holder.findall("command_interface"):
            kind = _COMMANDS.get(command.get("name", ""))
            if kind is not None and (joint, kind.value) not in taken:
                yield _commanded("", joint, kind, command, 1.0)


def initial_positions(top: Element) -> dict[str, float]:
    """The positions [rad], [m] in which placeholders and simulators start; an empty value states none."""
    path = "state_interface[@name='position']/param[@name='initial_value']"
    positions = {one.get("name", ""): one.find(path) for one in top.findall("ros2_control/joint")}
    return {
        joint: _one(parameter) for joint, parameter in positions.items() if parameter is not None and parameter.text
    }


def _inputs(top: Element, joint: str) -> list[Element]:
    return [
        command
        for holder in top.findall("ros2_control/joint")
        if holder.get("name") == joint
        for command in holder.findall("command_interface")
    ]


def _behind_gear(element: Element, old: Element | None, inputs: Sequence[Element], before: int) -> ObservedActuator:
    """An actuator with a transmission in `<ros2_control>`.

    Args:
        old: The transmission of ROS 1 of the same name, which may give the input.
        inputs: The command interfaces of the joint; without a transmission of ROS 1 the first transmission takes the
            first, and further ones that are left over the last.
        before: Number of transmissions of this joint before this one.
    """
    name, joint = _name_of(element.find("actuator")), _name_of(element.find("joint"))
    gear = number_at(element.find("joint"), "mechanical_reduction", 1.0)
    command = inputs[min(before, len(inputs) - 1)] if inputs else None
    if old is not None:
        joint_1, kind_1, gear_1 = _of_ros_1(old)
        if joint_1 != joint or (gear_1 != gear and old.find("actuator/mechanicalReduction") is not None):
            return ObservedActuator(name, joint, f"{kind_1} with another <transmission> on {joint_1}", gear=gear)
        if kind_1:
            command = next((one for one in inputs if _kind_of(one) == kind_1), None)
    kind = None if command is None else _kind_of(command)
    if command is None or kind is None:
        return ObservedActuator(name, joint, "actuator without a matching <command_interface>", gear=gear)
    return _commanded(name, joint, kind, command, gear)


def _kind_of(command: Element) -> ActuatorKind | None:
    return _COMMANDS.get(command.get("name", ""))


def _name_of(element: Element | None) -> str:
    return "" if element is None else element.get("name", "")


def _of_ros_1(element: Element) -> tuple[str, str, float]:
    """Joint, kind and gear of a transmission."""
    interface = (element.findtext("joint/hardwareInterface") or "").strip()
    kind = _INTERFACES.get(interface)
    gear = number_at(element.find("actuator"), "mechanicalReduction", 1.0)
    return _name_of(element.find("joint")), (kind.value if kind else interface), gear


def _commanded(name: str, joint: str, kind: ActuatorKind, command: Element, gear: float) -> ObservedActuator:
    """An actuator whose input is a command interface; bounds are converted from the joint to the actuator."""
    values = {one.get("name", ""): _one(one) for one in command.findall("param")}
    low, high = values.get("min", -inf), values.get("max", inf)
    if gear == 0.0:  # no position or effort of the joint has one of the actuator
        return ObservedActuator(name, joint, kind.value, gear=gear)
    scale = 1.0 / gear if kind is ActuatorKind.MOTOR else gear
    low, high = sorted((low * scale, high * scale))
    seen = ObservedActuator(name, joint, kind.value, gear=gear, control=(low, high))
    if kind is ActuatorKind.MOTOR:
        return seen
    force = values.get("max_effort", inf) / abs(gear)
    return replace(seen, kp=values.get("kp"), kv=values.get("kv"), force=(-force, force))


def _one(parameter: Element) -> float:
    values = numbers(parameter.text)
    if len(values) != 1 or isnan(values[0]):
        raise EngineRefused(f"parameter '{parameter.get('name')}' is '{parameter.text}', not a number")
    return values[0]


def faults(top: Element) -> Iterator[str]:
    """What ros2_control and ROS 1 would reject: missing or unknown names, types and roles."""
    for system in top.findall("ros2_control"):
        if not system.get("name") or system.get("type") not in ("system", "sensor", "actuator"):
            yield "<ros2_control> needs a name, and a type that is system, sensor or actuator"
        if not (system.findtext("hardware/plugin") or "").strip():
            yield "<ros2_control> needs a <plugin> in its <hardware>"
        for joint in system.findall("joint"):
            states = {one.get("name", "") for one in joint.findall("state_interface")}
            if states != _STATES:
                present = ", ".join(sorted(states)) or "none"
                yield f"joint '{joint.get('name', '')}' in <ros2_control> has the state interfaces: {present}"
        for element in system.findall("transmission"):
            yield from _transmission_faults(element, "plugin")
            roles = [one.get("role") for one in (*element.findall("actuator"), *element.findall("joint"))]
            if roles != ["actuator1", "joint1"]:
                yield f"transmission '{element.get('name', '')}': roles 'actuator1' and 'joint1' expected"
    for element in top.findall("transmission"):
        yield from _transmission_faults(element, "type")
    old, new = ([one.get("name", "") for one in top.findall(path)] for path in ("transmission", _TRANSMISSION))
    for name in sorted(set(old) ^ set(new)) if old and new else ():
        where = "<robot>" if name in old else "<ros2_control>"
        yield f"transmission '{name}': defined in {where} only, unlike the others"
    for sensor in (*top.findall("gazebo/sensor"), *top.findall("ros2_control/sensor")):
        if not sensor.get("name"):
            yield f"a sensor of type {sensor.get('type', 'unknown')} has no name"
    yield from _unstated_joints(top)
    yield from _merged_joints(top)


def _unstated_joints(top: Element) -> Iterator[str]:
    """Joints whose positions nobody publishes, so that RViz lacks all below: those of mimics follow from others."""
    stated = {joint.get("name", "") for joint in top.findall("ros2_control/joint")}
    moving = [one for one in top.findall("joint") if one.get("type") in PAIRS and one.find("mimic") is None]
    for joint in moving if stated else ():
        if joint.get("name", "") not in stated:
            yield f"joint '{joint.get('name', '')}' moves, and is in no <ros2_control>"


def _merged_joints(top: Element) -> Iterator[str]:
    """Fixed joints that Gazebo merges unless disabled, although sensors need them.

    A force-torque sensor in the joint is lost with it, and shapes of the child, which a contact sensor names, are
    renamed.
    """
    kept, sensing = set(), set()
    for block in top.findall("gazebo"):
        on = block.get("reference", "")
        if (block.findtext("preserveFixedJoint") or "").strip() in ("true", "1"):
            kept.add(on)
        sensing |= {(on, one.get("type")) for one in block.findall("sensor")}
    for joint in top.findall("joint"):
        name, child = joint.get("name", ""), joint.find("child")
        needed = {(name, "force_torque"), ("" if child is None else child.get("link", ""), "contact")}
        if joint.get("type") == "fixed" and name not in kept and needed & sensing:
            yield f"joint '{name}': without <preserveFixedJoint> a sensor is lost"


def _transmission_faults(element: Element, word: str) -> Iterator[str]:
    name = element.get("name", "")
    motor = element.find("actuator")
    if not name or motor is None or motor.get("name") != name:
        yield f"transmission '{name}': it needs a name, and an actuator of that name"
    if (element.findtext(word) or "").strip() != _SIMPLE:
        yield f"transmission '{name}': not a SimpleTransmission"
