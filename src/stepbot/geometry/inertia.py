"""Mass, centre of mass and inertia of rigid bodies, moved, scaled and combined.

Principal axes are alike on every machine. Eigenvectors of LAPACK differ in sign and in their last digits between
builds. Jacobi's rotations need only sums, products, quotients and square roots, which IEEE 754 rounds alike
everywhere.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Literal, get_args

import numpy as np
from msgspec import Struct

from .fixed_point import exact_sum
from .poses import Poses
from .spatial import ZERO3, ZERO33, Array, Matrix3, Pose, Vector3, dot, matrix3, matrix_product, turn_inertia, vector3

RESIDUE = 1e-8
"""Share of a body's size below which a component of its com or inertia is numeric residue: integrals over faces are
accurate to 1e-9, and sums over parts lose another digit."""


class MassProperties(Struct, frozen=True):
    """Mass, centre of mass and inertia of a rigid body."""

    mass: float = 0.0
    """Mass [kg]."""
    com: Vector3 = ZERO3
    """Centre of mass [m], in the body's frame."""
    inertia: Matrix3 = ZERO33
    """Inertia [kg m^2] about the centre of mass, along the axes of the body's frame."""

    @staticmethod
    def of(mass: float, com: Iterable[float], inertia: Array) -> "MassProperties":
        """From mass [kg], com (3,) [m] and inertia (3, 3) [kg m^2] about the com, which is symmetrized."""
        I = np.asarray(inertia, dtype=np.float64)  # noqa: E741 - the field's letter
        return MassProperties(float(mass), vector3(tuple(com)), matrix3(0.5 * (I + I.T)))

    def moved(self, X_AB: Pose) -> "MassProperties":
        """The same body, given in B, expressed in A; ``X_AB`` in [m]."""
        return MassProperties.of(self.mass, X_AB.apply(self.com).tolist(), turn_inertia(X_AB.R, np.array(self.inertia)))

    def scaled(self, factor: float) -> "MassProperties":
        """The same shape with its density multiplied by ``factor``."""
        return MassProperties.of(self.mass * factor, self.com, np.array(self.inertia) * factor)


def without_residue(computed: MassProperties) -> MassProperties:
    """Computed mass properties with 0 in place of numeric residue (decision 0025).

    Set to 0 are components of the com below ``RESIDUE`` times the largest radius of gyration, and products of inertia
    below ``RESIDUE`` times the geometric mean of the two moments. Moments are unchanged, and so is whether the inertia
    is possible, to ``RESIDUE``.
    """
    I = np.array(computed.inertia)  # noqa: E741 - the field's letter
    moments = np.diag(I)
    if not computed.mass > 0.0 or not np.all(moments > 0.0):
        return computed
    com = np.array(computed.com)
    com[np.abs(com) < RESIDUE * np.sqrt(moments.max() / computed.mass)] = 0.0
    I[np.abs(I) < RESIDUE * np.sqrt(np.outer(moments, moments))] = 0.0
    return MassProperties.of(computed.mass, com.tolist(), I)


class Bodies(Struct, frozen=True, eq=False):
    """Mass properties of several bodies as arrays: those of an assembly may be thousands."""

    mass: Array
    """Shape (n,) [kg]."""
    com: Array
    """Shape (n, 3) [m], each in its body's frame."""
    inertia: Array
    """Shape (n, 3, 3) [kg m^2], about the centre of mass, along the axes of the body's frame."""

    @staticmethod
    def of(bodies: Sequence[MassProperties], indices: Sequence[int] | None = None) -> "Bodies":
        """Bodies as arrays; with ``indices``, one for each index."""
        mass = np.array([body.mass for body in bodies], dtype=np.float64)
        com = np.array([body.com for body in bodies], dtype=np.float64).reshape(-1, 3)
        inertia = np.array([body.inertia for body in bodies], dtype=np.float64).reshape(-1, 3, 3)
        chosen = slice(None) if indices is None else np.array(indices, dtype=np.intp)
        return Bodies(mass[chosen], com[chosen], inertia[chosen])

    def scaled(self, factors: Array) -> "Bodies":
        """The same shapes with their densities multiplied by ``factors`` (n,)."""
        return Bodies(self.mass * factors, self.com, self.inertia * factors[:, None, None])

    def moved(self, X_AB: Poses) -> "Bodies":
        """The same bodies, each given in its B, expressed in A."""
        turned = matrix_product(matrix_product(X_AB.R, self.inertia), X_AB.R.transpose(0, 2, 1))
        return Bodies(self.mass, X_AB.apply(self.com), 0.5 * (turned + turned.transpose(0, 2, 1)))

    def combined(self) -> MassProperties:
        """Mass properties of all as one; all in the same frame, as is the result.

        A single body is returned unchanged, bit for bit.
        """
        heavy = self.mass != 0.0
        m, p, I = self.mass[heavy], self.com[heavy], self.inertia[heavy]  # noqa: E741 - the field's letter
        if len(m) == 1:
            return MassProperties.of(m[0], p[0].tolist(), I[0])
        mass = exact_sum(m.tolist())
        if mass == 0.0:
            return MassProperties()
        com = (m[:, None] * p).sum(axis=0) / mass
        d = p - com
        squares = dot(d, d)[:, None, None] * np.eye(3) - d[:, :, None] * d[:, None, :]
        return MassProperties.of(mass, com.tolist(), (I + m[:, None, None] * squares).sum(axis=0))


def combined(bodies: Iterable[MassProperties]) -> MassProperties:
    """Mass properties of several bodies as one; see :meth:`Bodies.combined`."""
    return Bodies.of(list(bodies)).combined()


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
