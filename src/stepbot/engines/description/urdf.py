"""URDF: links and joints as yourdfpy reads them, shapes and the poses of the joints from the XML."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import ZERO3, Pose
from stepbot.robot.model import Box, Capsule, Cylinder, Rgba, Sphere

from .. import engine_of
from ..observation import EngineRefused, Request
from .description import DescribedShape, Description, Primitive
from .meshes import MeshFiles

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
        materials = {_name(material): material for material in top.findall("material")}
        shapes = tuple(shape for link in top.findall("link") for shape in _shapes(link, files, materials))
    except ValueError as error:
        raise EngineRefused(str(error)) from error
    return Description(observation, X_PC, shapes, files.unread)


def _name(element: Element | None, key: str = "name") -> str:
    return "" if element is None else element.get(key, "")


def _shapes(link: Element, files: MeshFiles, materials: Mapping[str, Element]) -> Iterator[DescribedShape]:
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            geometry = shape.find("geometry")
            mesh = None if geometry is None else geometry.find("mesh")
            found = _primitive(geometry) if mesh is None else _mesh(mesh, files)
            if found is not None:
                name = shape.get("name", "") or Path(_name(mesh, "filename")).stem
                rgba = _color(shape.find("material"), materials)
                yield DescribedShape(_name(link), name, found, _origin(shape), rgba, kind == "collision")


def _color(material: Element | None, materials: Mapping[str, Element]) -> Rgba | None:
    """Colour of a material, its own or that of the material of the same name at the top of the file."""
    for one in (material, materials.get(_name(material))):
        color = None if one is None else one.find("color")
        if color is not None:
            r, g, b, a = _numbers(color.get("rgba"), (0.8, 0.8, 0.8, 1.0))
            return (r, g, b, a)
    return None


def _mesh(mesh: Element, files: MeshFiles) -> TriMesh | None:
    return files.mesh(mesh.get("filename", ""), _numbers(mesh.get("scale"), (1.0, 1.0, 1.0)))


def _primitive(geometry: Element | None) -> Primitive | None:
    for shape in () if geometry is None else geometry:
        if shape.tag == "box":
            x, y, z = _numbers(shape.get("size"), ZERO3)
            return Box((x, y, z))
        (radius,), (length,) = _numbers(shape.get("radius"), (0.0,)), _numbers(shape.get("length"), (0.0,))
        if shape.tag == "cylinder":
            return Cylinder(radius, length)
        if shape.tag == "capsule":
            return Capsule(radius, length)
        if shape.tag == "sphere":
            return Sphere(radius)
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
