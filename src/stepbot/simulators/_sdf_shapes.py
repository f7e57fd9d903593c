"""The boxes around the shapes of an SDFormat link."""

from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..model import Box, Capsule, Cylinder, Sphere
from ..spatial import Array, Pose, join_bounds
from ._bounds import Bounds, mesh_bounds, primitive_bounds
from ._resources import resolve
from ._sdf_frames import numbers, read_pose

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


def shapes_of(shapes: Iterable[Element], file: Path) -> tuple[Bounds | None, list[str]]:
    """Box [m] around all shapes in the link's frame, and the mesh files that are not there.

    The box is None where there is no shape, or one whose extent this reader does not know.
    """
    boxes: list[Bounds | None] = []
    missing: list[str] = []
    for shape in shapes:
        geometry, X_LG = shape.find("geometry"), read_pose(shape)
        mesh = None if geometry is None else geometry.find("mesh")
        if geometry is None:
            boxes.append(None)
        elif mesh is None:
            boxes.append(_primitive_bounds(geometry, X_LG))
        else:
            uri = (mesh.findtext("uri") or "").strip()
            path = resolve(uri, file)
            if path is None:
                missing.append(uri)
            vertices = None if path is None or path.suffix.lower() != ".obj" else _vertices(path.read_bytes())
            scale = np.array(numbers(mesh.findtext("scale") or "1 1 1"))
            boxes.append(None if vertices is None else mesh_bounds(vertices * scale, X_LG))
    known = [box for box in boxes if box is not None]
    return (join_bounds(known) if known and len(known) == len(boxes) else None), missing


def _primitive_bounds(geometry: Element, X_LG: Pose) -> Bounds | None:
    def number(path: str) -> float:
        return numbers(geometry.findtext(path))[0]

    if geometry.find("box") is not None:
        x, y, z = numbers(geometry.findtext("box/size"))
        return primitive_bounds(Box((x, y, z)), X_LG)
    if geometry.find("sphere") is not None:
        return primitive_bounds(Sphere(number("sphere/radius")), X_LG)
    if geometry.find("cylinder") is not None:
        return primitive_bounds(Cylinder(number("cylinder/radius"), number("cylinder/length")), X_LG)
    if geometry.find("capsule") is not None:
        return primitive_bounds(Capsule(number("capsule/radius"), number("capsule/length")), X_LG)
    return None


@lru_cache(maxsize=1024)
def _vertices(obj: bytes) -> Array:
    """Vertices (n, 3) of a Wavefront OBJ; parsed once, since visuals and collisions share meshes."""
    words = [line.split()[1:4] for line in obj.splitlines() if line.startswith(b"v ")]
    vertices = np.array(words, dtype="S").astype(np.float64).reshape(-1, 3)
    vertices.setflags(write=False)
    return vertices
