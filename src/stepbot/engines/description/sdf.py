"""SDFormat by stepbot's own reader."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Box, Capsule, Cylinder, Rgba, Sphere

from .. import engine_of
from ..observation import EngineCannotRead, Observation, Request
from ..sdformat_reader.frames import number_at, numbers, read_pose
from ..sdformat_reader.tree import read_model
from .description import DescribedShape, Description, Primitive
from .meshes import MeshFiles

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


def describe_sdf(file: str, packages: Iterable[Path] = ()) -> Description:
    """Read an SDFormat file; its meshes are searched for in ``packages``, too.

    Raises:
        EngineRefused: It violates its format.
        EngineCannotRead: It uses unsupported features.
    """
    observation = engine_of("reader").observer.observe(Request(file, "sdf", configurations=({},), simulate=0.0))
    files = MeshFiles(Path(file), packages)
    shapes = tuple(shape for link in read_model(Path(file)).findall("link") for shape in _shapes(link, files))
    return Description(observation, _at_zero(observation), shapes, files.unread)


def _at_zero(observation: Observation) -> dict[str, Pose]:
    """Poses in the parents at q = 0; the reader moves mimicking joints like any other."""
    if not observation.poses:
        raise EngineCannotRead("the poses of its links are not known")
    poses = observation.poses[0]
    return {joint.child: poses[joint.parent].inverse() @ poses[joint.child] for joint in observation.joints}


def _shapes(link: Element, files: MeshFiles) -> Iterator[DescribedShape]:
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            geometry = shape.find("geometry")
            found = None if geometry is None else _geometry(geometry, files)
            if found is not None:
                name, X_LG, rgba = shape.get("name", ""), read_pose(shape), _color(shape)
                yield DescribedShape(link.get("name", ""), name, found, X_LG, rgba, kind == "collision")


def _color(shape: Element) -> Rgba | None:
    """The diffuse colour of a visual."""
    values = numbers(shape.findtext("material/diffuse") or "")
    return (values[0], values[1], values[2], values[3] if len(values) > 3 else 1.0) if len(values) >= 3 else None


def _geometry(geometry: Element, files: MeshFiles) -> TriMesh | Primitive | None:
    for shape in geometry:
        if shape.tag == "mesh":
            scale = tuple(numbers(shape.findtext("scale") or "1 1 1"))
            return files.mesh((shape.findtext("uri") or "").strip(), scale)
        if shape.tag == "box":
            x, y, z = numbers(shape.findtext("size") or "0 0 0")
            return Box((x, y, z))
        radius, length = number_at(shape, "radius", 0.0), number_at(shape, "length", 0.0)
        if shape.tag == "cylinder":
            return Cylinder(radius, length)
        if shape.tag == "capsule":
            return Capsule(radius, length)
        if shape.tag == "sphere":
            return Sphere(radius)
    return None
