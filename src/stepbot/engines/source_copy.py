"""Copies of descriptions that every engine can read; to be called in a worker process.

Chains of single joints take the place of planar and floating joints of a URDF, of which engines differ in what they
make: PyBullet and yourdfpy fix them, MuJoCo rejects a floating joint within a robot, and names directions of a plane
itself. A joint that its limits lock is fixed: MuJoCo ignores equal limits. https://wiki.ros.org/urdf/XML/joint
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from stepbot.geometry.spatial import Vector3, perpendicular_frame, vector3
from stepbot.runtime.file import resolved

from .observation import EngineRefused
from .resources import resolve
from .xml import xml_root

Element = Any
"""``lxml.etree._Element``."""


class MissingMesh(NamedTuple):
    """A mesh that a description names, and that does not exist."""

    uri: str
    line: int


ChainNames = tuple[tuple[str, ...], tuple[str, ...]]
"""Names of the joints that replace a joint, from the parent on, and of the links in between, one less."""


def located_copy(file: str, copy: str, packages: Iterable[Path]) -> tuple[MissingMesh, ...]:
    """Write a copy with absolute paths of meshes, if a mesh is not where its name states: PyBullet does not search.

    Args:
        file: A URDF or SDFormat.

    Returns:
        The meshes that were not found, each once, with the first line that names it; empty for a file that is not XML,
        which engines report.
    """
    from lxml import etree

    try:
        top = xml_root(Path(file))
    except EngineRefused:
        return ()
    named = {uri: element.sourceline or 0 for element, uri in reversed(list(_meshes(top)))}
    places = {uri: resolve(uri, Path(file), packages) for uri in named}
    missing = [MissingMesh(uri, line) for uri, line in named.items() if places[uri] is None]
    if any(place not in (None, Path(file).parent / uri) for uri, place in places.items()):
        locate(top, Path(file), packages)
        Path(copy).write_bytes(etree.tostring(top, encoding="UTF-8", xml_declaration=True))
    return tuple(sorted(missing, key=lambda one: (one.line, one.uri)))


def _meshes(top: Element) -> Iterator[tuple[Element, str]]:
    """The elements that name a mesh, and its name."""
    for element in top.iter("mesh"):
        uri = element.get("filename", "") or (element.findtext("uri") or "").strip()
        if uri:
            yield element, uri


def source_copy(file: str, copy: str, packages: Iterable[Path], chains: Mapping[str, ChainNames]) -> None:
    """Write a copy with absolute paths of meshes, and single joints in place of others.

    Engines do not search folders of packages. A mesh that is not found keeps its name.

    Args:
        chains: Joints of a URDF that engines read differently, and the names of what replaces each.
    """
    from lxml import etree

    top = xml_root(Path(file))
    locate(top, Path(file), packages)
    _with_chains(top, chains)
    Path(copy).write_bytes(etree.tostring(top, encoding="UTF-8", xml_declaration=True))


def locate(top: Element, file: Path, packages: Iterable[Path]) -> None:
    """Make the paths of meshes absolute."""
    for element in top.iter("mesh", "uri"):
        uri = element.get("filename", "") or (element.text or "").strip()
        target = resolve(uri, file, packages) if uri else None
        if target is not None and element.get("filename"):
            element.set("filename", resolved(target).as_posix())
        elif target is not None:
            element.text = resolved(target).as_posix()


_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_UNLIMITED = {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"}
"""A prismatic joint must have limits."""


def _with_chains(robot: Element, chains: Mapping[str, ChainNames]) -> None:
    """Replace joints by chains.

    Args:
        robot: The root element of a URDF; changed.
        chains: Joints that engines read differently, and the names of what replaces each.
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
    if joint.get("type") not in ("floating", "planar"):
        return [("fixed", _X)]
    if joint.get("type") == "floating":
        return [("prismatic", _X), ("prismatic", _Y), ("prismatic", _Z), *(("continuous", one) for one in (_Z, _Y, _X))]
    axis = joint.find("axis")
    given = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
    x, y, z = (vector3(column) for column in perpendicular_frame([float(part) for part in given.split()]).T)
    return [("prismatic", x), ("prismatic", y), ("continuous", z)]
