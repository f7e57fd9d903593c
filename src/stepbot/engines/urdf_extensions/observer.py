"""The blocks of a URDF that no engine reads, read back: `<gazebo>`, `<transmission>`, `<ros2_control>`.

It is stepbot's own parser, written from the documentation of Gazebo and ros2_control, independent of the writer. It
reports springs, links without gravity, actuators and sensors; the engines check everything else. It confirms the text,
not the behaviour of an engine: reports count its checks separately.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.robot.model import JointDynamics
from stepbot.version import __version__

from ..observation import Observation, ObservedJoint, ObservedLink, ObservedSensor, Quantity, Request
from ..sdformat_reader.frames import bool_at, number_at, read_pose
from ..sdformat_reader.sensors import read_sensor
from ..urdf_chains import xml_root
from . import ENGINE
from .ros2_control import faults, in_gazebo_alone, observed_actuators, state_sensors

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


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
            weightless = not bool_at(block, "gravity", not bool_at(block, "turnGravityOff", weightless))
    return ObservedLink(name, gravity_compensation=1.0 if weightless else 0.0)


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
            yield in_gazebo_alone(sensor) if state is None else state.beside(sensor)
    for state in states.values():
        yield state.alone()


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
