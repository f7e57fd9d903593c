"""The shapes of a solid: colours and bounding boxes."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from stepbot.geometry.spatial import Array, Pose, join_bounds, rotation_about
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere

from ..observation import ObservedShape
from ..resources import resolve
from .vrml import Node

_GROUPS = ("Pose", "Transform", "Group")


def visuals_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid that are seen, in its frame, and the missing mesh files."""
    return _observed([one for child in solid.nodes("children") for one in _shapes(child, Pose())], file)


def collisions_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid's bounding object, in its frame, and the missing mesh files."""
    bounding = solid.node("boundingObject")
    return _observed([] if bounding is None else list(_shapes(bounding, Pose(), geometries=True)), file)


def box_around(shapes: Sequence[ObservedShape]) -> Bounds | None:
    """Bounding box [m] of all shapes; None without shapes, or if the box of one is unknown."""
    known = [shape.bounds for shape in shapes if shape.bounds is not None]
    return join_bounds(known) if known and len(known) == len(shapes) else None


def _shapes(node: Node, X: Pose, *, geometries: bool = False) -> Iterator[tuple[Node, Node | None, Pose]]:
    """Geometry, appearance and pose of the shapes in a node; solids and joints have shapes of their own."""
    if node.type in _GROUPS:
        x, y, z, angle = node.numbers("rotation", (0.0, 0.0, 1.0, 0.0))
        moved = X @ Pose.of(rotation_about((x, y, z), angle), node.numbers("translation", (0.0, 0.0, 0.0)))
        for child in node.nodes("children"):
            yield from _shapes(child, moved, geometries=geometries)
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
            return _mesh_bounds(geometry, X, file)
        case _:
            return None, []


def _mesh_bounds(geometry: Node, X: Pose, file: Path) -> tuple[Bounds | None, list[str]]:
    urls = geometry.fields.get("url", [])
    (url, *_) = [str(one).strip('"') for one in (urls if isinstance(urls, list) else [urls])] or [""]
    path = resolve(url, file)
    if path is None:
        return None, [url]
    return (mesh_bounds(_vertices(path.read_bytes()), X) if path.suffix.lower() == ".obj" else None), []


@lru_cache(maxsize=1024)
def _vertices(obj: bytes) -> Array:
    """Vertices (n, 3) of a Wavefront OBJ; parsed once, since visuals and collisions share meshes."""
    words = [line.split()[1:4] for line in obj.splitlines() if line.startswith(b"v ")]
    vertices = np.array(words, dtype="S").astype(np.float64).reshape(-1, 3)
    vertices.setflags(write=False)
    return vertices
