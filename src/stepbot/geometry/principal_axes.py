"""Principal moments and axes of an inertia, alike on every machine.

Eigenvectors of LAPACK differ in sign and in their last digits between builds. Jacobi's rotations need only sums,
products, quotients and square roots, which IEEE 754 rounds alike everywhere.
"""

import math
from typing import Literal, get_args

import numpy as np

from .spatial import Array, Matrix3, Vector3, matrix3

_MOST_SWEEPS = 20
"""Jacobi's method converges quadratically; four to six sweeps are usual."""


def principal_axes(inertia: Matrix3) -> tuple[Vector3, Matrix3]:
    """Principal moments [kg m^2] of a symmetric matrix, and the rotation (columns) whose axes they are about.

    The axes stay near the given ones: a diagonal matrix has its own diagonal and the identity.
    """
    A = [list(row) for row in inertia]
    R = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for _ in range(_MOST_SWEEPS):
        turned = [_rotate(A, R, p, q) for p, q in ((0, 1), (0, 2), (1, 2))]
        if not any(turned):
            break
    return (A[0][0], A[1][1], A[2][2]), matrix3(R)


def _rotate(A: list[list[float]], R: list[list[float]], p: int, q: int) -> bool:
    """Annihilate A[p][q] by a rotation of at most 45 degrees; False if it is 0 to rounding already."""
    off = A[p][q]
    if abs(off) <= 1e-17 * math.sqrt(abs(A[p][p] * A[q][q])):
        A[p][q] = A[q][p] = 0.0
        return False
    half = (A[q][q] - A[p][p]) / (2.0 * off)
    t = math.copysign(1.0, half) / (abs(half) + math.sqrt(half * half + 1.0))
    c = 1.0 / math.sqrt(t * t + 1.0)
    s = t * c
    A[p][p] -= t * off
    A[q][q] += t * off
    A[p][q] = A[q][p] = 0.0
    r = 3 - p - q
    A[r][p], A[r][q] = c * A[r][p] - s * A[r][q], s * A[r][p] + c * A[r][q]
    A[p][r], A[q][r] = A[r][p], A[r][q]
    for row in R:
        row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
    return True


Direction = Literal["z", "-z", "y", "-y", "x", "-x"]
"""An axis of a frame, or its opposite."""
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)


def vector(direction: Direction) -> Array:
    """Unit vector of a direction, shape (3,)."""
    unit = np.zeros(3)
    unit["xyz".index(direction[-1])] = -1.0 if direction.startswith("-") else 1.0
    return unit


def rotation_of(up: Direction, forward: Direction) -> Array:
    """Rotation R_WL (3, 3) of a frame L whose z points up in W and whose x points forward."""
    z, x = vector(up), vector(forward)
    return np.column_stack([x, np.cross(z, x), z]) + 0.0
