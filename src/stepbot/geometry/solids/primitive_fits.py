"""The primitive that encloses a solid most closely: along the axes of its faces, with their exact radii.

A smallest circle around the vertices of a mesh has the radius of the cylinder to a few nanometres; the face has it
exactly, and the axis too.
"""

from collections.abc import Iterator, Sequence
from math import pi

import numpy as np
from msgspec import Struct

from ..enclosing_shapes import THINNEST, box_around, capsule_around, cylinder_around, sphere_around
from ..mesh import GRID_PER_METRE
from ..primitives import Box, Capsule, Cylinder, Primitive, Sphere
from ..spatial import Array, Pose, matrix_product, perpendicular_frame, rotated

_EQUAL = 1e-4
"""Difference between shares up to which the simpler primitive is preferred."""
_GRID = 2.0 / GRID_PER_METRE
"""Distance [m] by which the vertex grid may displace a point of a face."""


class RoundFace(Struct, frozen=True):
    """The axis and radius of a cylindrical face: of a shaft, or of a bore."""

    point: Array
    """Shape (3,) [m]."""
    direction: Array
    """Unit vector (3,)."""
    radius: float
    """[m]."""


class Fit(Struct, frozen=True):
    """A primitive, its pose, and the share of it that the solid fills."""

    shape: Primitive
    X_AG: Pose
    filled: float


class PrimitiveFits:
    """Finds primitives around solids, along given axes."""

    def __init__(self, axes: Array, shafts: Sequence[RoundFace], *, cylinders: bool = True) -> None:
        """Keep the axes.

        Args:
            axes: Three orthogonal unit vectors (3, 3), as rows, to align boxes with.
            shafts: Cylindrical faces to align cylinders and capsules with.
            cylinders: Whether a cylinder is a primitive.
        """
        self._axes, self._shafts, self._cylinders = axes, shafts, cylinders
        self._directions = [*axes, *(shaft.direction for shaft in shafts)]
        self._frames = [perpendicular_frame(direction) for direction in self._directions]

    def best(self, points: Array, volume: float, least: float) -> Fit | None:
        """The primitive that a solid fills most; it encloses all points.

        Args:
            points: Vertices (n, 3) [m] of the solid or of its hull.
            volume: Volume [m^3] of the solid.
            least: Share of the primitive that the solid has to fill.
        """
        best: Fit | None = None
        for shape, X_AG in self._candidates(points, volume / least):
            filled = volume / primitive_volume(shape)
            if filled >= least and (best is None or filled > best.filled + _EQUAL):
                best = Fit(shape, X_AG, filled)
        return best

    def _candidates(self, points: Array, most: float) -> Iterator[tuple[Primitive, Pose]]:
        """The simpler primitives first; only those whose volume [m^3] can be at most this, by the points' extent."""
        R = self._axes.T
        box = box_around(matrix_product(points, R))
        if box is not None:
            yield box[0], Pose.of(R, rotated(R, box[1].p))
        if self._cylinders:
            yield from self._cylinders_on_shafts(points, most)
        sizes = [_size_along(points, frame) for frame in self._frames]
        for direction, (radius, length) in zip(self._axes, sizes[:3], strict=True):
            if self._cylinders and primitive_volume(Cylinder(radius, length)) <= most:
                cylinder = cylinder_around(points, [direction])
                if cylinder is not None:
                    yield cylinder
        if primitive_volume(Sphere(max(radius for radius, _ in sizes))) <= most:
            ball = sphere_around(points)
            if ball is not None:
                yield ball
        for i, (direction, (radius, length)) in enumerate(zip(self._directions, sizes, strict=True)):
            if length > 2.0 * radius and primitive_volume(Capsule(radius, length - 2.0 * radius)) <= most:
                capsule = capsule_around(points, [direction])
                if capsule is not None:
                    yield (_exact_capsule(capsule[0], self._shafts[i - 3]) if i >= 3 else capsule[0]), capsule[1]

    def _cylinders_on_shafts(self, points: Array, most: float) -> Iterator[tuple[Cylinder, Pose]]:
        """Cylinders around the axes of faces: with their radii if these enclose the points, up to the vertex grid."""
        for shaft, R in zip(self._shafts, self._frames[3:], strict=True):
            local = matrix_product(points - shaft.point, R)
            farthest = float(np.linalg.norm(local[:, :2], axis=1).max())
            low, high = float(local[:, 2].min()), float(local[:, 2].max())
            cylinder = Cylinder(shaft.radius if farthest <= shaft.radius + _GRID else farthest, _on_grid(high - low))
            if high - low >= THINNEST and primitive_volume(cylinder) <= most:
                yield cylinder, Pose.of(R, shaft.point + rotated(R, np.array([0.0, 0.0, 0.5 * (low + high)])))


def _size_along(points: Array, R: Array) -> tuple[float, float]:
    """A lower bound of the radius across the z axis of a frame, and the length along it [m]."""
    x, y, z = np.ptp(matrix_product(points, R), axis=0).tolist()
    return 0.5 * max(x, y), z


def primitive_volume(shape: Primitive) -> float:
    """Volume [m^3] of a primitive."""
    if isinstance(shape, Box):
        return shape.size[0] * shape.size[1] * shape.size[2]
    if isinstance(shape, Sphere):
        return 4.0 / 3.0 * pi * shape.radius**3
    domes = 4.0 / 3.0 * shape.radius if isinstance(shape, Capsule) else 0.0
    return pi * shape.radius**2 * (shape.length + domes)


def _exact_capsule(capsule: Capsule, shaft: RoundFace) -> Capsule:
    if abs(capsule.radius - shaft.radius) > _GRID:
        return capsule
    return Capsule(shaft.radius, _on_grid(capsule.length + 2.0 * (capsule.radius - shaft.radius)))


def _on_grid(length: float) -> float:
    """A length between two points of the vertex grid [m]; rounding of rotated coordinates is removed."""
    return round(length, 11)
