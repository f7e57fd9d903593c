"""What a sidecar may set for simulations: time step, integrator, stiffness of closures and mimics."""

from dataclasses import dataclass
from enum import StrEnum


class Integrator(StrEnum):
    """The method of numerical integration."""

    IMPLICITFAST = "implicitfast"
    IMPLICIT = "implicit"
    EULER = "euler"
    RK4 = "rk4"


@dataclass(frozen=True)
class Simulation:
    """Settings of a simulation; None for a default."""

    timestep: float | None = None
    """Time step [s]."""
    integrator: Integrator | None = None
    closure_stiffness: float | None = None
    """Share of a gap of a closure or mimic that is closed within one step, above 0 and at most 1."""


DEFAULTS = Simulation()
"""No setting is given."""
