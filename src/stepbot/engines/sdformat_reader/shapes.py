"""The shapes of an SDFormat link: names, colours, and bounding boxes."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere
from stepbot.robot.surfaces import Surface

from ..observation import OBLIQUE, ObservedShape
from ..shape_bounds import mesh_file_bounds
from .frames import number_at, numbers, read_pose, three_at

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


def shapes_of(shapes: Iterable[Element], file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """All shapes in the link's frame, and the missing mesh files.

    A shape has no box if this reader cannot determine its extent.
    """
    seen: list[ObservedShape] = []
    missing: list[str] = []
    for shape in shapes:
        geometry, X_LG = shape.find("geometry"), read_pose(shape)
        bounds, lost = _bounds(geometry, X_LG, file)
        oblique, _ = _bounds(geometry, OBLIQUE @ X_LG, file)
        missing += lost
        rgba, ambient = (_color(shape, name) if shape.tag == "visual" else None for name in ("diffuse", "ambient"))
        surface = surface_of(shape) if shape.tag == "collision" else None
        seen.append(ObservedShape(shape.get("name", ""), rgba, ambient, bounds, oblique, surface=surface))
    return tuple(seen), missing


def surface_of(shape: Element) -> Surface:
    """Friction and restitution of a collision, if they are given."""
    paths = {"friction": "surface/friction/ode/mu", "restitution": "surface/bounce/restitution_coefficient"}
    given = {name: path for name, path in paths.items() if shape.find(path) is not None}
    return Surface(**{name: number_at(shape, path, 0.0) for name, path in given.items()})


def _color(shape: Element, name: str) -> tuple[float, ...]:
    """Red, green, blue and opacity; empty if the file gives none."""
    values = numbers(shape.findtext(f"material/{name}"))
    return tuple(values if len(values) != 3 else (*values, 1.0))


def _bounds(geometry: Element | None, X_LG: Pose, file: Path) -> tuple[Bounds | None, list[str]]:
    """The bounding box of a shape, if known, and its mesh file if missing."""
    mesh = None if geometry is None else geometry.find("mesh")
    if geometry is None:
        return None, []
    if mesh is None:
        return _primitive_bounds(geometry, X_LG), []
    uri, scale = (mesh.findtext("uri") or "").strip(), three_at(mesh, "scale", "1 1 1")
    return mesh_file_bounds(uri, file, X_LG, scale)


def _primitive_bounds(geometry: Element, X_LG: Pose) -> Bounds | None:
    def number(path: str) -> float:
        return number_at(geometry, path, 0.0)

    if geometry.find("box") is not None:
        return primitive_bounds(Box(three_at(geometry, "box/size", "0 0 0")), X_LG)
    if geometry.find("sphere") is not None:
        return primitive_bounds(Sphere(number("sphere/radius")), X_LG)
    if geometry.find("cylinder") is not None:
        return primitive_bounds(Cylinder(number("cylinder/radius"), number("cylinder/length")), X_LG)
    if geometry.find("capsule") is not None:
        return primitive_bounds(Capsule(number("capsule/radius"), number("capsule/length")), X_LG)
    return None
