"""Checks what the readers of a URDF assume: names, ends of joints, shapes and numbers.

Without these they raise exceptions of many types, which do not state a place in the file.
"""

from collections.abc import Iterator
from math import isfinite, isnan
from typing import Any

from ..observation import EngineRefused
from ..urdf_versions import EXTRA_LIMITS, QUATERNION
from .description import OpenLimit

Element = Any
"""``lxml.etree._Element``; the stubs lack ``sourceline``."""

_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3, QUATERNION: 4},
    "axis": {"xyz": 3},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity", *EXTRA_LIMITS), 1),
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
_EXPAND = "expand macros first, `xacro robot.urdf.xacro -o robot.urdf`"
_UNBOUNDED = ("limit", "dynamics")
"""Elements whose numbers may be infinite."""
SHAPES = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
    "mesh": ("filename",),
}
"""Geometries and their attributes, without which they have no size."""
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
        raise _refused(macro, f"<xacro:{name}>: {_EXPAND}")
    links, joints = robot.findall("link"), robot.findall("joint")
    names = _names(links)
    _names(joints)
    _check_ends(joints, names)
    for joint in joints:
        _check_joint(joint)
    for link in links:
        _check_link(link)
    for top in (*links, *joints, *robot.findall("material")):
        for element in top.iter("*"):
            for name, count in _NUMBERS.get(str(element.tag), {}).items():
                _numbers(element, name, count)
            if element.tag == "origin":
                _check_rotation(element)
            if element.tag == "color":
                _check_color(element)


def open_limits(robot: Element) -> Iterator[OpenLimit]:
    """What revolute and prismatic joints lack, although URDF requires it."""
    for joint in robot.findall("joint"):
        limit = joint.find("limit")
        if joint.get("type") not in ("revolute", "prismatic"):
            continue
        missing = [bound for bound in ("lower", "upper") if limit is None or limit.get(bound) is None]
        if missing:
            yield OpenLimit(joint.get("name"), joint.sourceline, tuple(missing), has_element=limit is not None)


def _check_ends(joints: list[Element], links: set[str]) -> None:
    """Check that each joint has two links, and each link at most one joint above it."""
    above: dict[str, str] = {}
    for joint in joints:
        _once(joint, "parent", "child")
        for tag in ("parent", "child"):
            end = joint.find(tag)
            if end is None or end.get("link") not in links:
                name = "" if end is None else end.get("link", "")
                lacks = f"no <{tag}>" if end is None else f"{tag} link '{name}' does not exist"
                if name == "world":
                    lacks += ', which Drake alone adds: add `<link name="world"/>`'
                raise _refused(joint, f"joint '{joint.get('name')}': {lacks}")
        parent, child = joint.find("parent").get("link"), joint.find("child").get("link")
        if parent == child:
            raise _refused(joint, f"joint '{joint.get('name')}': parent and child are both '{child}'")
        if child in above:
            raise _refused(
                joint, f"link '{child}' is the child of two joints, '{above[child]}' and '{joint.get('name')}'"
            )
        above[child] = joint.get("name")


def _check_joint(joint: Element) -> None:
    kind = _need(joint, "type")
    _once(joint, "origin", "axis", "limit", "dynamics", "mimic")
    mimic, axis = joint.find("mimic"), joint.find("axis")
    if mimic is not None:
        _need(mimic, "joint")
    needs_axis = kind not in _WITHOUT_AXIS and axis is not None
    if needs_axis and not any(_numbers(axis, "xyz", 3, (1.0, 0.0, 0.0))):
        raise _refused(axis, f"joint '{joint.get('name')}': the axis is zero")


def _check_rotation(origin: Element) -> None:
    """Check that an origin has one rotation: urdfdom rejects two, and a quaternion of zeros has no direction."""
    if origin.get(QUATERNION) is None:
        return
    if origin.get("rpy") is not None:
        raise _refused(origin, f"<origin> has 'rpy' and '{QUATERNION}': remove one")
    if not any(_numbers(origin, QUATERNION, 4)):
        raise _refused(origin, f"'{QUATERNION}' of <origin> is zero, and no rotation")


def _check_color(color: Element) -> None:
    """Check that channels are shares: of colours written in bytes, each reader shows another one."""
    rgba = _numbers(color, "rgba", 4)
    if not all(0.0 <= channel <= 1.0 for channel in rgba):
        in_bytes = all(channel.is_integer() and 0.0 <= channel <= 255.0 for channel in rgba)
        hint = "; divide by 255" if in_bytes else ""
        raise _refused(color, f"'rgba' of <color> is '{color.get('rgba')}', not numbers from 0 to 1{hint}")


def _check_link(link: Element) -> None:
    _once(link, "inertial")
    inertial = link.find("inertial")
    if inertial is not None:
        _once(inertial, "origin", "mass", "inertia")
        mass = inertial.find("mass")
        if mass is not None:
            _numbers(mass, "value", 1)
    for shape in (*link.findall("visual"), *link.findall("collision")):
        _once(shape, "origin", "geometry")
        _check_geometry(shape, f"link '{link.get('name')}': <{shape.tag}>")


def _check_geometry(shape: Element, subject: str) -> None:
    children = list(shape.iterfind("geometry/*"))
    known = [child for child in children if child.tag in SHAPES]
    if children and not known:
        names = ", ".join(f"<{tag}>" for tag in SHAPES)
        raise _refused(children[0], f"<{children[0].tag}> is not a geometry of URDF: {names}")
    if len(known) != 1:
        raise _refused(shape, f"{subject} has {'several geometries' if known else 'no geometry'}")
    for attribute in SHAPES[known[0].tag]:
        _need(known[0], attribute)


def _once(element: Element, *tags: str) -> None:
    """Check that elements of which readers use one do not contradict each other."""
    for tag in tags:
        first, *others = element.findall(tag) or [None]
        for other in others:
            if len(other) or dict(other.attrib) != dict(first.attrib):
                raise _refused(other, f"duplicate <{tag}> in <{element.tag}>, with another content")


def _names(elements: list[Element]) -> set[str]:
    names: set[str] = set()
    for element in elements:
        name = _need(element, "name")
        if name in names:
            raise _refused(element, f"duplicate {element.tag} '{name}'")
        names.add(name)
    return names


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
        hint = f"; {_EXPAND}" if "$" in text else ""
        raise _refused(element, f"'{name}' of <{element.tag}> is '{text}', not {expected}{hint}")
    return values


def _refused(element: Element, message: str) -> EngineRefused:
    return EngineRefused(f"line {element.sourceline}: {message}")
