"""Mass, centre of mass and inertia of bodies made of primitives, in closed form.

The robots of this folder and the drawn test parts are sums and differences of the bodies below, so their mass
properties are known without a geometry kernel. A body is stored as its integrals of 1, x and x x^T, which add up: a
hole is a subtraction, and no parallel-axis term is needed.

Lengths are in any one unit u; with density 1 a mass is a volume [u^3]. :meth:`Moments.in_metres` converts millimetres
to SI. Poses X_AB are homogeneous arrays of shape (4, 4): coordinates in B to coordinates in A.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def pose(position: ArrayLike = (0.0, 0.0, 0.0), rotation: ArrayLike | None = None) -> Array:
    """X_AB, shape (4, 4), from p_AB [u], shape (3,), and R_AB, shape (3, 3)."""
    X = np.eye(4)
    X[:3, 3] = position
    if rotation is not None:
        X[:3, :3] = rotation
    return X


def inverse(X_AB: Array) -> Array:
    """X_BA of a rigid X_AB."""
    R_BA = X_AB[:3, :3].T
    return pose(-R_BA @ X_AB[:3, 3], R_BA)


def turn(axis: str, angle: float) -> Array:
    """Rotation, shape (3, 3), about the axis ``x``, ``y`` or ``z`` by ``angle`` [rad]; quarter turns are exact."""
    quarters = round(angle / (pi / 2))
    if abs(angle - quarters * pi / 2) < 1e-15:
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarters % 4]
    else:
        c, s = cos(angle), sin(angle)
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    R = np.eye(3)
    R[j, j] = R[k, k] = c
    R[j, k], R[k, j] = -s, s
    return R


def mirror(axis: str) -> Array:
    """Reflection, shape (3, 3), through the plane whose normal is the axis ``x``, ``y`` or ``z``."""
    R = np.eye(3)
    R["xyz".index(axis), "xyz".index(axis)] = -1.0
    return R


@dataclass(frozen=True, eq=False)
class Moments:
    """The integrals of 1, x and x x^T over the mass of a body, in one frame."""

    mass: float
    """[kg], or the volume [u^3] at density 1."""
    first: Array
    """Integral of x, shape (3,) [kg u]."""
    second: Array
    """Integral of x x^T, shape (3, 3) [kg u^2]."""

    @property
    def com(self) -> Array:
        """Centre of mass, shape (3,) [u]."""
        com: Array = self.first / self.mass
        return com

    @property
    def inertia(self) -> Array:
        """Inertia about the centre of mass, shape (3, 3) [kg u^2], with -(integral of x y) off the diagonal."""
        central = (self.second + self.second.T) / 2 - np.outer(self.first, self.first) / self.mass
        inertia: Array = np.trace(central) * np.eye(3) - central
        return inertia

    def __add__(self, other: "Moments") -> "Moments":
        """Both bodies together; they must not overlap."""
        return Moments(self.mass + other.mass, self.first + other.first, self.second + other.second)

    def __sub__(self, other: "Moments") -> "Moments":
        """The body without ``other``, which must be inside it."""
        return Moments(self.mass - other.mass, self.first - other.first, self.second - other.second)

    def weighing(self, factor: float) -> "Moments":
        """The same body with ``factor`` times the density."""
        return Moments(factor * self.mass, factor * self.first, factor * self.second)

    def moved(self, X_AB: Array) -> "Moments":
        """This body, given in B, expressed in A; X_AB may be a reflection."""
        R, p = X_AB[:3, :3], X_AB[:3, 3]
        turned = R @ self.first
        cross = np.outer(turned, p)
        second = R @ self.second @ R.T + cross + cross.T + self.mass * np.outer(p, p)
        return Moments(self.mass, turned + self.mass * p, second)

    def at(self, x: float, y: float, z: float) -> "Moments":
        """This body, shifted [u]."""
        return self.moved(pose((x, y, z)))

    def in_metres(self) -> "Moments":
        """A body of density 1 kg/m^3 whose integrals were taken in millimetres, in SI."""
        return Moments(self.mass * 1e-9, self.first * 1e-12, self.second * 1e-15)


NOTHING = Moments(0.0, np.zeros(3), np.zeros((3, 3)))
"""The empty body: the start of a sum."""


def total(*bodies: Moments) -> Moments:
    """All bodies together; they must not overlap."""
    return sum(bodies, NOTHING)


def _moments(mass: float, com: ArrayLike, about_com: ArrayLike) -> Moments:
    """From mass, com and the diagonal, shape (3,), of the integral of (x - com)(x - com)^T."""
    centre = np.asarray(com, dtype=np.float64)
    return Moments(
        mass, mass * centre, np.diag(np.asarray(about_com, dtype=np.float64)) + mass * np.outer(centre, centre)
    )


def box(x: float, y: float, z: float) -> Moments:
    """A box with these edges around the origin."""
    volume = x * y * z
    return _moments(volume, (0, 0, 0), (volume * x * x / 12, volume * y * y / 12, volume * z * z / 12))


def cylinder(radius: float, height: float) -> Moments:
    """A cylinder along +z; the centre of its lower face is the origin."""
    volume = pi * radius**2 * height
    across = volume * radius**2 / 4
    return _moments(volume, (0, 0, height / 2), (across, across, volume * height**2 / 12))


def frustum(lower: float, upper: float, height: float) -> Moments:
    """A truncated cone along +z with these radii; the centre of its lower face is the origin."""
    a, b = lower, upper
    volume = pi * height / 3 * (a * a + a * b + b * b)
    first = pi * height**2 / 12 * (a * a + 2 * a * b + 3 * b * b)
    across = pi * height / 20 * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4)
    along = pi * height**3 / 30 * (a * a + 3 * a * b + 6 * b * b)
    return Moments(volume, np.array((0.0, 0.0, first)), np.diag((across, across, along)))


def half_cylinder(radius: float, height: float) -> Moments:
    """The half x >= 0 of :func:`cylinder`."""
    volume = pi * radius**2 * height / 2
    x = 4 * radius / (3 * pi)
    across = volume * radius**2 / 4
    return _moments(volume, (x, 0, height / 2), (across - volume * x * x, across, volume * height**2 / 12))


def sphere(radius: float) -> Moments:
    """A ball around the origin."""
    volume = 4 / 3 * pi * radius**3
    return _moments(volume, (0, 0, 0), 3 * (volume * radius**2 / 5,))


def stadium(length: float, radius: float, height: float) -> Moments:
    """A bar with round ends: end centres at the origin and at (length, 0, 0), lower face at z = 0."""
    end = half_cylinder(radius, height)
    return total(
        box(length, 2 * radius, height).at(length / 2, 0, height / 2),
        end.at(length, 0, 0),
        end.moved(pose(rotation=turn("z", pi))),
    )
