"""URDF: links and joints as yourdfpy reads them, shapes and the poses of the joints from the XML."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stepbot.geometry.spatial import ZERO3, Array, Pose

from .. import engine_of
from ..observation import EngineRefused, Request
from .description import DescribedShape, Description
from .meshes import MeshFiles, corners

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


def describe_urdf(file: str) -> Description:
    """Read a URDF.

    Raises:
        EngineRefused: It contradicts its format.
    """
    from lxml import etree

    observation = engine_of("yourdfpy").observer.observe(Request(file, "urdf", simulate=0.0))
    top = etree.parse(file, etree.XMLParser(resolve_entities=False, no_network=True)).getroot()
    files = MeshFiles(Path(file))
    try:
        X_PC = {_name(joint.find("child"), "link"): _origin(joint) for joint in top.findall("joint")}
        shapes = tuple(shape for link in top.findall("link") for shape in _shapes(link, files))
    except ValueError as error:
        raise EngineRefused(str(error)) from error
    return Description(observation, X_PC, shapes, files.unread)


def _name(element: Element | None, key: str = "name") -> str:
    return "" if element is None else element.get(key, "")


def _shapes(link: Element, files: MeshFiles) -> Iterator[DescribedShape]:
    for shape in link.findall("visual") or link.findall("collision"):
        geometry = shape.find("geometry")
        mesh = None if geometry is None else geometry.find("mesh")
        points = _primitive(geometry) if mesh is None else _mesh(mesh, files)
        if points is not None:
            name = shape.get("name", "") or Path(_name(mesh, "filename")).stem
            yield DescribedShape(_name(link), name, _origin(shape).apply(points))


def _mesh(mesh: Element, files: MeshFiles) -> Array | None:
    vertices = files.vertices(mesh.get("filename", ""))
    return None if vertices is None else vertices * np.array(_numbers(mesh.get("scale"), (1.0, 1.0, 1.0)))


def _primitive(geometry: Element | None) -> Array | None:
    for shape in () if geometry is None else geometry:
        if shape.tag == "box":
            x, y, z = _numbers(shape.get("size"), ZERO3)
            return corners((0.5 * x, 0.5 * y, 0.5 * z), Pose())
        if shape.tag in ("cylinder", "sphere", "capsule"):
            (radius,), (length,) = _numbers(shape.get("radius"), (0.0,)), _numbers(shape.get("length"), (0.0,))
            ends = radius if shape.tag != "cylinder" else 0.0
            return corners((radius, radius, 0.5 * length + ends), Pose())
    return None


def _origin(element: Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return Pose()
    return Pose.from_xyz_rpy(_numbers(origin.get("xyz"), ZERO3), _numbers(origin.get("rpy"), ZERO3))


def _numbers(text: str | None, default: Iterable[float]) -> tuple[float, ...]:
    values = tuple(default)
    if text is None:
        return values
    read = tuple(float(word) for word in text.split())
    if len(read) != len(values):
        raise ValueError(f"'{text}' has {len(read)} numbers, {len(values)} expected")
    return read
