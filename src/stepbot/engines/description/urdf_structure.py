"""Checks what the readers of a URDF assume: names, ends of joints, shapes and numbers.

Without these they raise exceptions of many types, which do not state a place in the file.
"""

from math import isfinite, isnan
from typing import Any

from ..observation import EngineRefused

Element = Any
"""``lxml.etree._Element``; the stubs lack ``sourceline``."""

_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), 1),
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"scale": 3},
    "color": {"rgba": 4},
}
"""For each element its attributes with numbers, and how many."""
_UNBOUNDED = ("limit", "dynamics")
"""Elements whose numbers may be infinite."""
_WITHOUT_AXIS = ("fixed", "floating")
"""Types of joints whose axis has no meaning: the SolidWorks exporter writes 0 0 0 for fixed joints."""


def check_structure(robot: Element) -> None:
    """Check the elements that make links, joints and shapes.

    Raises:
        EngineRefused: One is missing or contradicts the format; the message has its line.
    """
    _need(robot, "name")
    macro = next((one for one in robot.iter("{*}*") if "xacro" in str(one.tag).partition("}")[0]), None)
    if macro is not None:
        name = str(macro.tag).rpartition("}")[2]
        raise _refused(macro, f"<xacro:{name}>: expand macros first, `xacro robot.urdf.xacro -o robot.urdf`")
    links = _names(robot.findall("link"))
    joints = robot.findall("joint")
    _names(joints)
    for joint in joints:
        _need(joint, "type")
        for tag in ("parent", "child"):
            end = joint.find(tag)
            if end is None or end.get("link") not in links:
                lacks = f"no <{tag}>" if end is None else f"{tag} link '{end.get('link', '')}' does not exist"
                raise _refused(joint, f"joint '{joint.get('name')}': {lacks}")
        axis = joint.find("axis")
        needs_axis = joint.get("type") not in _WITHOUT_AXIS
        if needs_axis and axis is not None and not any(_numbers(axis, "xyz", 3, (1.0, 0.0, 0.0))):
            raise _refused(axis, f"joint '{joint.get('name')}': the axis is zero")
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            geometry = shape.find("geometry")
            if geometry is None or next(geometry.iterchildren("*"), None) is None:
                raise _refused(shape, f"link '{link.get('name')}': <{shape.tag}> has no geometry")
    for element in (
        one for tag in ("link", "joint", "material") for top in robot.findall(tag) for one in top.iter("*")
    ):
        for name, count in _NUMBERS.get(str(element.tag), {}).items():
            _numbers(element, name, count)


def _names(elements: list[Element]) -> set[str]:
    found: set[str] = set()
    for element in elements:
        name = _need(element, "name")
        if name in found:
            raise _refused(element, f"duplicate {element.tag} '{name}'")
        found.add(name)
    return found


def _need(element: Element, attribute: str) -> str:
    value = element.get(attribute)
    if value is None:
        raise _refused(element, f"<{element.tag}> without attribute '{attribute}'")
    return str(value)


def _numbers(element: Element, name: str, count: int, default: tuple[float, ...] = ()) -> tuple[float, ...]:
    text = element.get(name)
    if text is None:
        return default
    try:
        values = tuple(map(float, text.split()))
    except ValueError:
        values = ()
    bounded = element.tag not in _UNBOUNDED
    if len(values) != count or any(map(isnan, values)) or (bounded and not all(map(isfinite, values))):
        expected = "a number" if count == 1 else f"{count} numbers"
        raise _refused(element, f"'{name}' of <{element.tag}> is '{text}', not {expected}")
    return values


def _refused(element: Element, message: str) -> EngineRefused:
    return EngineRefused(f"line {element.sourceline}: {message}")
