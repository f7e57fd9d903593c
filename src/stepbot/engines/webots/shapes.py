"""The shapes of a solid: colours and bounding boxes."""

from collections.abc import Iterator
from pathlib import Path

from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere

from ..observation import ObservedShape
from ..shape_bounds import mesh_file_bounds
from .vrml import Node

_GROUPS = ("Pose", "Transform", "Group")


def visuals_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid that are seen, in its frame, and the missing mesh files."""
    return _observed([one for child in solid.nodes("children") for one in _shapes(child, Pose())], file)


def collisions_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid's bounding object, in its frame, and the missing mesh files."""
    bounding = solid.node("boundingObject")
    return _observed([] if bounding is None else list(_shapes(bounding, Pose(), geometries=True)), file)


def _shapes(node: Node, X: Pose, *, geometries: bool = False) -> Iterator[tuple[Node, Node | None, Pose]]:
    """Geometry, appearance and pose of the shapes in a node; solids and joints have shapes of their own."""
    if node.type in _GROUPS:
        for child in node.nodes("children"):
            yield from _shapes(child, X @ node.pose(), geometries=geometries)
    elif node.type == "Shape":
        geometry = node.node("geometry")
        if geometry is not None:
            yield geometry, node.node("appearance"), X
    elif geometries:
        yield node, None, X


def _observed(found: list[tuple[Node, Node | None, Pose]], file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    seen, missing = list[ObservedShape](), list[str]()
    for geometry, appearance, X in found:
        bounds, lost = _bounds(geometry, X, file)
        missing += lost
        seen.append(ObservedShape("", _color(appearance), bounds=bounds))
    return tuple(seen), missing


def _color(appearance: Node | None) -> tuple[float, ...] | None:
    if appearance is None:
        return None
    return (*appearance.numbers("baseColor", (1.0, 1.0, 1.0)), 1.0 - appearance.number("transparency", 0.0))


def _bounds(geometry: Node, X: Pose, file: Path) -> tuple[Bounds | None, list[str]]:
    """The bounding box of a shape, if known, and its mesh file if missing."""
    match geometry.type:
        case "Box":
            x, y, z = geometry.numbers("size", (0.1, 0.1, 0.1))
            return primitive_bounds(Box((x, y, z)), X), []
        case "Sphere":
            return primitive_bounds(Sphere(geometry.number("radius", 0.1)), X), []
        case "Cylinder" | "Capsule":
            kind = Cylinder if geometry.type == "Cylinder" else Capsule
            return primitive_bounds(kind(geometry.number("radius", 0.1), geometry.number("height", 0.2)), X), []
        case "Mesh":
            return mesh_file_bounds(_url(geometry), file, X)
        case _:
            return None, []


def _url(mesh: Node) -> str:
    """The file of a mesh; of several the first."""
    urls = mesh.fields.get("url", [])
    return next((str(one).strip('"') for one in (urls if isinstance(urls, list) else [urls])), "")
