"""Merges identical meshes: assets with the same vertices and faces are replaced by the first of them.

Some CAD programs write a separate definition for each occurrence of a part; forty equal screws would become forty equal
files. The first name in the robot's order is kept, and unused assets are removed.
"""

from dataclasses import replace

from .model import Geometry, Link, MeshAsset, MeshRef, Robot


def share_meshes(robot: Robot) -> Robot:
    """The same robot without duplicate meshes."""
    first: dict[tuple[bytes, bytes], str] = {}
    kept = {asset.name: first.setdefault(_content(asset), asset.name) for asset in robot.meshes}

    def shared(geometry: Geometry) -> Geometry:
        return MeshRef(kept[geometry.name]) if isinstance(geometry, MeshRef) else geometry

    links = tuple(
        replace(
            link,
            visuals=tuple(replace(visual, geometry=shared(visual.geometry)) for visual in link.visuals),
            collisions=tuple(replace(shape, geometry=shared(shape.geometry)) for shape in link.collisions),
        )
        for link in robot.links
    )
    used = {geometry.name for link in links for geometry in _geometries(link) if isinstance(geometry, MeshRef)}
    return replace(robot, links=links, meshes=tuple(asset for asset in robot.meshes if asset.name in used))


def _geometries(link: Link) -> tuple[Geometry, ...]:
    return (*(visual.geometry for visual in link.visuals), *(shape.geometry for shape in link.collisions))


def _content(asset: MeshAsset) -> tuple[bytes, bytes]:
    return asset.mesh.vertices.tobytes(), asset.mesh.faces.tobytes()
