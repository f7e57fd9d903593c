"""Triangles of boxes and of bodies of revolution, fine enough for a picture."""

from math import pi

import numpy as np

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, Vector3
from stepbot.robot.model import Box, Capsule, Cylinder, Geometry, MeshRef, Robot, Sphere

_AROUND = 64
"""Number of vertices around an axis."""


def mesh_of(geometry: Geometry, robot: Robot) -> TriMesh:
    """The triangles of a shape of a robot."""
    match geometry:
        case MeshRef(name):
            return robot.mesh_by_name[name].mesh
        case Box(size):
            return box_mesh(size)
        case Cylinder(radius, length):
            return cylinder_mesh(radius, length)
        case Capsule(radius, length):
            return capsule_mesh(radius, length)
        case Sphere(radius):
            return capsule_mesh(radius, 0.0)


def box_mesh(size: Vector3) -> TriMesh:
    """A box of full edge lengths [m] around the origin."""
    signs = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return TriMesh.of(signs * np.array(size), [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def cylinder_mesh(radius: float, length: float) -> TriMesh:
    """A cylinder along z around the origin [m]."""
    return _revolved(np.array([(0.0, -0.5), (radius, -0.5), (radius, 0.5), (0.0, 0.5)]) * (1.0, length))


def capsule_mesh(radius: float, length: float) -> TriMesh:
    """A cylinder along z [m] with half spheres on both ends; a sphere if the length is 0."""
    angles = np.linspace(-pi / 2, pi / 2, _AROUND // 2 + 1)
    arc = radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    half = len(arc) // 2 + 1
    down, up = np.array((0.0, -length / 2)), np.array((0.0, length / 2))
    return _revolved(np.concatenate((arc[:half] + down, arc[half - 1 :] + up) if length else (arc,)))


def _revolved(profile: Array) -> TriMesh:
    """The surface of a profile, radius and z from the lowest to the highest point of the axis, shape (n, 2) [m]."""
    rings = profile[1:-1]
    angles = 2.0 * pi * np.arange(_AROUND) / _AROUND
    around = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    sides = [np.column_stack((radius * around, np.full(_AROUND, z))) for radius, z in rings]
    vertices = np.concatenate((*sides, [(0.0, 0.0, profile[0, 1]), (0.0, 0.0, profile[-1, 1])]))
    bottom, top, last = len(rings) * _AROUND, len(rings) * _AROUND + 1, (len(rings) - 1) * _AROUND
    faces = []
    for i in range(_AROUND):
        j = (i + 1) % _AROUND
        faces += [(bottom, j, i), (top, last + i, last + j)]
        for start in range(0, last, _AROUND):
            a, b, c, d = start + i, start + j, start + _AROUND + j, start + _AROUND + i
            faces += [(a, b, c), (a, c, d)]
    return TriMesh.of(vertices, faces)
