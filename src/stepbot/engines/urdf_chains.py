"""URDF with chains of single joints in place of planar and floating joints.

Engines differ in what they make of these: PyBullet and yourdfpy fix them, MuJoCo rejects a floating joint within a
robot, and names the directions of a plane itself. https://wiki.ros.org/urdf/XML/joint
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stepbot.geometry.spatial import Vector3, perpendicular_frame, vector3

from .observation import EngineRefused

Element = Any
"""``lxml.etree._Element``."""

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_UNLIMITED = {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"}
"""A prismatic joint must have limits."""


ChainNames = tuple[tuple[str, ...], tuple[str, ...]]
"""Names of the joints that replace a joint, from the parent on, and of the links in between, one less."""


def with_chains(robot: Element, chains: Mapping[str, ChainNames]) -> None:
    """Replace joints by chains.

    Args:
        robot: The root element of a URDF; changed.
        chains: Planar and floating joints, and the names of what replaces each.
    """
    for joint in robot.findall("joint"):
        names = chains.get(joint.get("name", ""))
        if names is not None:
            _replace(robot, joint, names)


def _replace(robot: Element, joint: Element, names: ChainNames) -> None:
    from lxml import etree

    parent, child = (joint.find(tag).get("link") for tag in ("parent", "child"))
    joints, between = names
    links = [parent, *between, child]
    for name in between:
        etree.SubElement(robot, "link", name=name)
    steps = zip(joints, _steps(joint), links[:-1], links[1:], strict=True)
    for number, (name, (kind, axis), parent, child) in enumerate(steps):
        step = etree.SubElement(robot, "joint", name=name, type=kind)
        etree.SubElement(step, "parent", link=parent)
        etree.SubElement(step, "child", link=child)
        etree.SubElement(step, "axis", xyz=" ".join(map(repr, axis)))
        if kind == "prismatic":
            etree.SubElement(step, "limit", _UNLIMITED)
        if not number and joint.find("origin") is not None:
            step.append(joint.find("origin"))
    robot.remove(joint)


def _steps(joint: Element) -> list[tuple[str, Vector3]]:
    """Type and axis of each joint of a chain."""
    if joint.get("type") == "floating":
        return [("prismatic", _X), ("prismatic", _Y), ("prismatic", _Z), *(("continuous", one) for one in (_Z, _Y, _X))]
    axis = joint.find("axis")
    given = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
    x, y, z = (vector3(column) for column in perpendicular_frame([float(part) for part in given.split()]).T)
    return [("prismatic", x), ("prismatic", y), ("continuous", z)]


def xml_root(file: Path) -> Any:
    """The root element (``lxml.etree._Element``) of a file, without comments; entities are not expanded.

    Raises:
        EngineRefused: The file is not XML.
    """
    from lxml import etree

    try:
        parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True, huge_tree=True)
        return etree.fromstring(file.read_bytes(), parser)  # `etree.parse` raises OSError for some invalid encodings
    except etree.XMLSyntaxError as error:
        raise EngineRefused(f"not XML: {error.msg}") from error
