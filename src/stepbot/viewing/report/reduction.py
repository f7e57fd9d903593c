"""Meshes that are coarse enough for a page: vertices of one cell of a grid become one.

A point of a surface moves by no more than the vertices of its triangle, so the largest motion of a vertex bounds the
distance of every point of the exact mesh from the displayed one.
"""

from dataclasses import dataclass, replace

import numpy as np

from stepbot.geometry.fixed_point import distinct_rows
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array
from stepbot.robot.model import Robot

from ..scene import STEPS

BUDGET = 2_100_000
"""Size [bytes] of all meshes in a page."""
_PER_VERTEX = _PER_FACE = 8
"""Six bytes each as base64."""
_FINEST = 2**-13
"""Smallest cell, relative to the largest mesh."""


@dataclass(frozen=True, eq=False)
class Reduced:
    """A robot to display."""

    robot: Robot
    deviation: float
    """Upper bound [m] of the distance of every point of the robot's meshes from the displayed ones."""
    faces: int
    """Number of triangles of the robot's meshes."""
    displayed: int
    """Number of displayed triangles."""


def reduced(robot: Robot, budget: int = BUDGET) -> Reduced:
    """The robot with meshes that fit a page; unchanged ones if they do."""
    meshes = [asset.mesh for asset in robot.meshes]
    faces = sum(len(mesh.faces) for mesh in meshes)
    largest = max((_diagonal(mesh) for mesh in meshes), default=0.0)
    cell, deviation, displayed = 0.0, 0.0, meshes
    while _size(displayed) > budget and cell < largest:
        cell = cell * 2**0.5 or largest * _FINEST
        pairs = [clustered(mesh, cell) for mesh in meshes]
        displayed, deviation = [mesh for mesh, _ in pairs], max(moved for _, moved in pairs)
    rounding = max((0.5 * _diagonal(mesh) / STEPS for mesh in displayed), default=0.0)
    assets = tuple(replace(asset, mesh=mesh) for asset, mesh in zip(robot.meshes, displayed, strict=True))
    shown = sum(len(mesh.faces) for mesh in displayed)
    return Reduced(replace(robot, meshes=assets), deviation + rounding, faces, shown)


def clustered(mesh: TriMesh, cell: float) -> tuple[TriMesh, float]:
    """The mesh with one vertex per cell [m] of a grid, and the largest motion [m] of a vertex."""
    if not len(mesh.faces):
        return mesh, 0.0
    keys = np.floor(mesh.vertices / cell).astype(np.int64)
    first, cluster = distinct_rows(keys)
    counts = np.bincount(cluster)
    means: Array = np.stack([np.bincount(cluster, mesh.vertices[:, i]) / counts for i in range(3)], axis=1)
    # A vertex that is alone in its cell stays where it is, to the last bit.
    vertices = np.where(counts[:, None] == 1, mesh.vertices[first], means)
    faces = cluster[mesh.faces]
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    moved = float(np.linalg.norm(vertices[cluster] - mesh.vertices, axis=1).max())
    if not kept.any():  # smaller than a cell: a triangle remains, so that the part does not disappear
        kept = np.zeros(len(faces), dtype=bool)
        kept[int(_areas(mesh).argmax())] = True
        return mesh.subset(kept), float(_diagonal(mesh))
    used, renumbered = np.unique(faces[kept], return_inverse=True)
    triangles = renumbered.reshape(-1, 3)
    unique, _ = distinct_rows(np.sort(triangles, axis=1))
    return TriMesh.of(vertices[used], triangles[np.sort(unique)]), moved


def _size(meshes: list[TriMesh]) -> int:
    vertices = sum(len(mesh.vertices) for mesh in meshes)
    faces = sum(len(mesh.faces) for mesh in meshes)
    return _PER_VERTEX * vertices + _PER_FACE * faces


def _diagonal(mesh: TriMesh) -> float:
    return float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) if len(mesh.vertices) else 0.0


def _areas(mesh: TriMesh) -> Array:
    corners = mesh.vertices[mesh.faces]
    areas: Array = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return areas
