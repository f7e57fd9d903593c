"""Computed gains of an actuator: what was asked for, and what they were computed from."""

from enum import StrEnum

from msgspec import Struct

BANDWIDTH = 25.0
"""Default bandwidth [Hz]: a sine of 0.5 Hz is followed within 4 % of its amplitude."""
DAMPING_RATIO = 1.0
"""Default damping ratio: critical, the fastest response that does not overshoot."""


class Tuning(Struct, frozen=True):
    """How the gains of an actuator are computed, by :mod:`.gains`."""

    bandwidth: float = BANDWIDTH
    """Natural frequency [Hz] of the joint with a position actuator; corner frequency with a velocity actuator."""
    damping_ratio: float = DAMPING_RATIO
    """Damping ratio of a position actuator."""
    at_least: bool = False
    """Whether a position actuator is stiffer than the bandwidth where its joint would sag, or be slower."""
    assumed: bool = False
    """Whether nothing asks for them: the description of the actuator has no gains."""
    inertia: float = 0.0
    """Inertia [kg m^2] or mass [kg] that the actuator moves, at the joint, armatures included: in the drawn pose, or if
    ``at_least`` the largest over postures in the range of the robot."""
    weight: float = 0.0
    """Effort [N m] or [N] that holds the joint in the drawn pose, at the joint."""
    stiffened: bool = False
    """Whether it is: because of the joint's weight or passive damping."""
    braked: bool = False
    """Whether damping is above the ratio, because the effort limit could not brake a step in time."""


class Integrator(StrEnum):
    """The method of numerical integration."""

    IMPLICITFAST = "implicitfast"
    IMPLICIT = "implicit"
    EULER = "euler"
    RK4 = "rk4"


class Simulation(Struct, frozen=True):
    """Settings of a simulation; None for a default."""

    timestep: float | None = None
    """Time step [s]."""
    integrator: Integrator | None = None
    closure_stiffness: float | None = None
    """Share of a gap of a closure or mimic that is closed within one step, above 0 and at most 1."""


DEFAULTS = Simulation()
"""No setting is given."""
