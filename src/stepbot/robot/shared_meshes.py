"""Merges identical meshes: assets with the same vertices and faces are replaced by the first of them.

Some CAD programs write a separate definition for each occurrence of a part; forty equal screws would become forty equal
files. The first name in the robot's order is kept, and unused assets are removed.
"""

from dataclasses import replace
from typing import TypeVar

from .model import Collision, Geometry, MeshAsset, MeshRef, Robot, Visual

_Shape = TypeVar("_Shape", Visual, Collision)


def share_meshes(robot: Robot) -> Robot:
    """The same robot without duplicate meshes."""
    first: dict[tuple[bytes, bytes], str] = {}
    kept = {asset.name: first.setdefault(_content(asset), asset.name) for asset in robot.meshes}
    instead: dict[Geometry, Geometry] = {MeshRef(own): MeshRef(name) for own, name in kept.items() if own != name}

    def shared(shapes: tuple[_Shape, ...]) -> tuple[_Shape, ...]:
        return tuple(
            replace(shape, geometry=instead[shape.geometry]) if shape.geometry in instead else shape for shape in shapes
        )

    if instead:
        links = (replace(one, visuals=shared(one.visuals), collisions=shared(one.collisions)) for one in robot.links)
        robot = replace(robot, links=tuple(links))
    used = {shape.geometry for shape in robot.distinct_shapes}
    return replace(robot, meshes=tuple(asset for asset in robot.meshes if MeshRef(asset.name) in used))


def _content(asset: MeshAsset) -> tuple[bytes, bytes]:
    return asset.mesh.vertices.tobytes(), asset.mesh.faces.tobytes()
