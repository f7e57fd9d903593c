"""Shapes that a format or its engine does not support."""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Capsule, Collision, Cylinder, Geometry, Link, MeshRef, Robot, Sphere, Visual

FLATNESS = 1e-6
"""Ratio of thickness to extent below which a mesh counts as planar."""
DENT = 1e-4
"""Ratio of depth to extent below which a dent is ignored: hulls of tiny parts have some, from the vertex grid."""

_Shape = TypeVar("_Shape", Visual, Collision)


def geometries(link: Link) -> list[Geometry]:
    """The geometry of all visuals, then of all collisions of a link."""
    return [visual.geometry for visual in link.visuals] + [collision.geometry for collision in link.collisions]


def upright(shape: Visual | Collision) -> Pose:
    """Pose of a shape in its link; for a sphere without rotation."""
    return Pose.of(position=shape.X_LG.p) if isinstance(shape.geometry, Sphere) else shape.X_LG


def links_with_capsules(robot: Robot) -> list[str]:
    """Links with a capsule."""
    return [
        f"'{link.name}'" for link in robot.links if any(isinstance(geometry, Capsule) for geometry in geometries(link))
    ]


def split_capsules(robot: Robot) -> Robot:
    """The robot with a cylinder and two spheres for every capsule, which fill the same space."""

    def split(shapes: tuple[_Shape, ...]) -> tuple[_Shape, ...]:
        return tuple(part for shape in shapes for part in _split(shape))

    return replace(
        robot,
        links=tuple(
            replace(link, visuals=split(link.visuals), collisions=split(link.collisions)) for link in robot.links
        ),
    )


def flat_collisions(robot: Robot) -> list[str]:
    """Collision meshes that are planar."""
    return [f"'{name}'" for name in sorted(_flat_meshes(robot))]


def drop_flat_collisions(robot: Robot) -> Robot:
    """The robot without planar collision meshes."""
    flat = _flat_meshes(robot)

    def without(link: Link) -> Link:
        kept = (c for c in link.collisions if not (isinstance(c.geometry, MeshRef) and c.geometry.name in flat))
        return replace(link, collisions=tuple(kept))

    return replace(robot, links=tuple(without(link) for link in robot.links))


def concave_collisions(robot: Robot) -> list[str]:
    """Collision meshes that are not convex, or not closed."""
    return [f"'{name}'" for name in sorted(_touched(robot)) if not is_convex(robot.mesh_by_name[name].mesh)]


def _split(shape: _Shape) -> tuple[_Shape, ...]:
    capsule = shape.geometry
    if not isinstance(capsule, Capsule):
        return (shape,)
    middle = Cylinder(capsule.radius, capsule.length)
    end = Pose.of(position=(0.0, 0.0, capsule.length / 2))
    return (
        replace(shape, name=f"{shape.name}_middle", geometry=middle),
        replace(shape, name=f"{shape.name}_top", geometry=Sphere(capsule.radius), X_LG=shape.X_LG @ end),
        replace(shape, name=f"{shape.name}_bottom", geometry=Sphere(capsule.radius), X_LG=shape.X_LG @ end.inverse()),
    )


def _flat_meshes(robot: Robot) -> set[str]:
    return {name for name in _touched(robot) if is_flat(robot.mesh_by_name[name].mesh)}


def _touched(robot: Robot) -> set[str]:
    return {c.geometry.name for link in robot.links for c in link.collisions if isinstance(c.geometry, MeshRef)}


def is_flat(mesh: TriMesh) -> bool:
    """Whether all vertices are coplanar, or there are too few to span a volume."""
    if len(mesh.vertices) < 4:
        return True
    low, high = mesh.bounds
    extent = float(np.linalg.norm(np.subtract(high, low)))
    normal = _normal(mesh)
    if extent == 0.0 or normal is None:
        return True
    heights = mesh.vertices @ normal
    return float(np.ptp(heights)) <= FLATNESS * extent


def _normal(mesh: TriMesh) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Unit normal of the largest triangle; None if all are degenerate."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    largest = int(areas.argmax()) if len(areas) else 0
    if not len(areas) or areas[largest] == 0.0:
        return None
    unit: np.ndarray[tuple[int], np.dtype[np.float64]] = normals[largest] / areas[largest]
    return unit


def is_convex(mesh: TriMesh) -> bool:
    """Whether the mesh is the closed surface of one convex body.

    It is if every edge joins two faces in opposite directions, neither of which is in front of the other, and if the
    surface is one sphere (V - E + F = 2).
    """
    faces = mesh.faces
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    opposite = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    face = np.tile(np.arange(len(faces)), 3)
    n = len(mesh.vertices)
    there, back = (edges @ weights for weights in ((n, 1), (1, n)))
    order, partner = np.argsort(there), np.argsort(back)
    once = len(np.unique(there)) == len(there)
    if not len(faces) or not once or (there[order] != back[partner]).any():
        return False
    if len(np.unique(faces)) - len(there) // 2 + len(faces) != 2:
        return False
    a, b, c = (mesh.vertices[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    # The plane of a sliver is ill-defined: of the two faces of an edge, the larger one decides.
    larger = areas[face[order]] >= areas[face[partner]]
    judge = np.where(larger, face[order], face[partner])
    judged = mesh.vertices[np.where(larger, opposite[partner], opposite[order])]
    heights = np.einsum("ij,ij->i", judged - a[judge], normals[judge])
    low, high = mesh.bounds
    return bool((heights <= DENT * np.linalg.norm(np.subtract(high, low)) * areas[judge]).all())
