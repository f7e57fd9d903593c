"""A possible axis of rotation; for a ball joint only its centre."""

from math import hypot

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, Pose, cross

SAME_LINE = 2e-5
"""Distance [m] up to which axes are equal: twice the tolerance of coaxial faces."""
PARALLEL = 1e-3
"""Angle [rad] up to which directions are equal."""


class Axis(Struct, frozen=True, eq=False):
    """A line given by a point and a unit direction in the assembly; the sign of the direction has no meaning."""

    point: Array
    """Shape (3,) [m]."""
    direction: Array | None
    """Shape (3,); None for a centre without a direction."""

    @property
    def d(self) -> Array:
        """The direction of an axis that has one."""
        assert self.direction is not None
        return self.direction

    def same(self, other: "Axis", distance: float = SAME_LINE) -> bool:
        """Whether both are the same line, or the same centre."""
        if self.direction is None or other.direction is None:
            both = self.direction is None and other.direction is None
            return both and float(np.linalg.norm(self.point - other.point)) < distance
        return self.is_along(other.direction) and self.distance(other.point) < distance

    def moved(self, X: Pose) -> "Axis":
        """The axis after a motion."""
        return Axis(X.apply(self.point), None if self.direction is None else X.turn(self.direction))

    def is_along(self, direction: Array, angle: float = PARALLEL) -> bool:
        """Whether a unit direction is parallel to the axis."""
        return are_parallel(self.d, direction, angle)

    def distance(self, point: Array) -> float:
        """Distance [m] of a point."""
        x, y, z = (point - self.point).tolist()
        if self.direction is None:
            return hypot(x, y, z)
        u, v, w = self.direction.tolist()
        return hypot(y * w - z * v, z * u - x * w, x * v - y * u)

    def distances(self, points: Array) -> Array:
        """Distances (n,) [m] of points (n, 3)."""
        offsets = points - self.point
        if self.direction is not None:
            offsets = cross(offsets, self.direction)
        return np.asarray(np.linalg.norm(offsets, axis=1))


def are_parallel(a: Array, b: Array, angle: float = PARALLEL) -> bool:
    """Whether two unit directions are parallel or antiparallel."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return hypot(y * w - z * v, z * u - x * w, x * v - y * u) < angle
