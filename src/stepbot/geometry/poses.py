"""Many poses at once, in numpy's time instead of Python's: an assembly may have a part at thousands of places.

Every result is bit for bit that of :class:`.Pose` for each pose alone.
"""

from collections.abc import Iterable, Sequence
from math import atan2, hypot

import numpy as np
from msgspec import Struct

from .fixed_point import distinct_rows
from .spatial import Array, Pose, corners, matrix_product, rotated, tidy_arrays


class Poses(Struct, frozen=True, eq=False):
    """X_AB of several frames B in A."""

    R: Array
    """Rotations R_AB, shape (n, 3, 3)."""
    p: Array
    """Positions p_AB [m], shape (n, 3)."""

    @staticmethod
    def of(poses: Iterable[Pose]) -> "Poses":
        """The poses as arrays."""
        listed = list(poses)
        R = np.array([pose.rotation for pose in listed], dtype=np.float64).reshape(-1, 3, 3)
        return Poses(R, np.array([pose.position for pose in listed], dtype=np.float64).reshape(-1, 3))

    @staticmethod
    def joined(several: "Sequence[Poses]") -> "Poses":
        """The poses of several, one after the other."""
        return Poses(np.concatenate([poses.R for poses in several]), np.concatenate([poses.p for poses in several]))

    def __len__(self) -> int:
        return len(self.p)

    def seen_from(self, X_CA: Pose) -> "Poses":
        """X_CB = X_CA @ X_AB of each."""
        return Poses(matrix_product(X_CA.R, self.R), X_CA.apply(self.p))

    def tidy(self) -> "Poses":
        """What :func:`.tidy` makes of each."""
        return Poses(*tidy_arrays(self.R, self.p))

    def apply(self, points: Array) -> Array:
        """Points (3,) or (n, 3) [m] of each B, expressed in A: shape (n, 3)."""
        return rotated(self.R, np.broadcast_to(points, self.p.shape)) + self.p

    def distances_to(self, others: "Poses") -> list[tuple[float, float]]:
        """Distance [m] and angle [rad] of each to the other one at its place, as :meth:`.Pose.distance_to`."""
        R = matrix_product(np.swapaxes(self.R, 1, 2), others.R)
        turns = R[:, (2, 0, 1), (1, 2, 0)] - R[:, (1, 2, 0), (2, 0, 1)]
        whole = np.trace(R, axis1=1, axis2=2) - 1.0
        rows = zip((self.p - others.p).tolist(), turns.tolist(), whole.tolist(), strict=True)
        return [(hypot(*apart), atan2(hypot(*turn), cosine)) for apart, turn, cosine in rows]

    def listed(self) -> list[Pose]:
        """Each as a :class:`.Pose`; equal rotations are one object, in memory and when they are pickled."""
        first, kinds = distinct_rows(self.R.reshape(-1, 9))
        rotations = [(tuple(a), tuple(b), tuple(c)) for a, b, c in self.R[first].tolist()]
        return [Pose(rotations[kind], tuple(p)) for kind, p in zip(kinds.tolist(), self.p.tolist(), strict=True)]


def bounds_at(points: Array, poses: Poses) -> tuple[Array, Array]:
    """Lowest and highest corners (n, 3) [m] of points (m, 3) at each of n poses; they are turned once per rotation."""
    low, high = np.empty_like(poses.p), np.empty_like(poses.p)
    first, kinds = distinct_rows(poses.R.reshape(-1, 9))
    for kind, row in enumerate(first.tolist()):
        (lowest, highest), at = corners(rotated(poses.R[row], points)), kinds == kind
        low[at], high[at] = lowest + poses.p[at], highest + poses.p[at]
    return low, high
