"""Mass, centre of mass and inertia of rigid bodies, moved, scaled and combined."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .spatial import ZERO3, ZERO33, Array, Matrix3, Pose, Vector3, matrix3, shift_inertia, turn_inertia, vector3
from .sums import exact_sum

RESIDUE = 1e-8
"""Share of a body's size below which a component of its com or inertia is numeric residue: integrals over faces are
accurate to 1e-9, and sums over parts lose another digit."""


@dataclass(frozen=True)
class MassProperties:
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


def combined(bodies: Iterable[MassProperties]) -> MassProperties:
    """Mass properties of several bodies as one; all in the same frame, as is the result.

    A single body is returned unchanged, bit for bit.
    """
    parts = [body for body in bodies if body.mass != 0.0]
    if len(parts) == 1:
        return parts[0]
    mass = exact_sum(body.mass for body in parts)
    if mass == 0.0:
        return MassProperties()
    com = sum((body.mass * np.array(body.com) for body in parts), np.zeros(3)) / mass
    inertia = sum(
        (shift_inertia(body.inertia, body.mass, np.array(body.com) - com) for body in parts), np.zeros((3, 3))
    )
    return MassProperties.of(mass, com.tolist(), inertia)
