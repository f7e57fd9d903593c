"""Settings for simulating a robot, defaults applied.

Engines hold the closures of loops by forces, so that loops open a little while they move. A gap of a moving loop
follows from its centripetal acceleration a: it is a * timestep^2 / (2 * stiffness), where the stiffness is the share of
a gap that is closed within one step. The defaults are measured in decision 0027.
"""

from dataclasses import dataclass

from .model import Robot
from .tuning import Integrator

OPEN_TIMESTEP = 0.002
"""Default time step [s] of a robot without loops and mimics: MuJoCo's own default."""
LOOP_TIMESTEP = 0.001
"""Default time step [s] of a robot with loops or mimics: their gaps grow with its square."""
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
        given.timestep or (LOOP_TIMESTEP if constrained else OPEN_TIMESTEP),
        given.integrator or Integrator.IMPLICITFAST,
        given.closure_stiffness or CLOSURE_STIFFNESS,
    )
