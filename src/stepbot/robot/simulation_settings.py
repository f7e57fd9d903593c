"""Settings for simulating a robot, defaults applied.

Engines hold the closures of loops by forces, so that loops open a little while they move. A gap of a moving loop
follows from its centripetal acceleration a: it is a * timestep^2 / (2 * stiffness), where the stiffness is the share of
a gap that is closed within one step. The defaults are measured in decision 0027.
"""

from dataclasses import dataclass

from .model import ActuatorKind, Robot
from .tuning import Integrator

OPEN_TIMESTEP = 0.002
"""Default time step [s] of a robot without loops and mimics: MuJoCo's own default."""
SHORT_TIMESTEP = 0.001
"""Default time step [s] of a robot with loops or mimics, whose gaps grow with its square, and with stiff wheels."""
CLOSURE_STIFFNESS = 1.0
"""Default share of a gap of a closure or mimic that is closed within one step."""


@dataclass(frozen=True)
class Settings:
    """Settings of a simulation, defaults applied."""

    timestep: float
    """Time step [s]."""
    integrator: Integrator
    closure_stiffness: float


def settings_of(robot: Robot) -> Settings:
    """The settings to simulate a robot with.

    The implicit integrator remains stable with the damping of joints and actuators that an explicit one cannot
    integrate.
    """
    given = robot.simulation
    constrained = bool(robot.closures) or any(joint.mimic is not None for joint in robot.joints)
    return Settings(
        given.timestep or (SHORT_TIMESTEP if constrained or _has_stiff_wheels(robot) else OPEN_TIMESTEP),
        given.integrator or Integrator.IMPLICITFAST,
        given.closure_stiffness or CLOSURE_STIFFNESS,
    )


def _has_stiff_wheels(robot: Robot) -> bool:
    """Whether a motor at its effort limit leaps from one side of its target speed to the other in a step of 2 ms.

    It does where the speed has a time constant inertia / kv below half of a step: kv keeps a wheel at its speed against
    the damping of its motor, which is strong where the rotor has no inertia. The wheel then slips as it starts and
    stops.
    """
    return any(
        one.kind is ActuatorKind.VELOCITY
        and one.tuning is not None
        and one.tuning.at_least
        and one.kv * one.gear**2 * OPEN_TIMESTEP > 2.0 * one.tuning.inertia > 0.0
        for one in robot.actuators
    )
