"""Settings for simulating a robot, defaults applied.

Engines hold the closures of loops by forces, so that loops open a little while they move. A gap of a moving loop
follows from its centripetal acceleration a: it is a * timestep^2 / (2 * stiffness), where the stiffness is the share of
a gap that is closed within one step. The defaults are measured in decision 0027.
"""

from math import isfinite

from msgspec import Struct

from .model import Actuator, ActuatorKind, Joint, Robot
from .tuning import Integrator

OPEN_TIMESTEP = 0.002
"""Default time step [s] of a robot without loops and mimics: MuJoCo's own default."""
SHORT_TIMESTEP = 0.001
"""Default time step [s] of a robot with loops or mimics, whose gaps grow with its square, and with stiff wheels."""
_SPENT = 0.5
"""Share of a motor's effort that its damping takes at the velocity limit, above which little is left."""
CLOSURE_STIFFNESS = 1.0
"""Default share of a gap of a closure or mimic that is closed within one step."""


class Settings(Struct, frozen=True):
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
    """Whether a motor leaps from one side of its target speed to the other, at its effort limit, in steps of 2 ms.

    It does where its own damping leaves it little effort to speed up with, as in a DC motor, and the time constant
    inertia / kv of the speed is below half of a step: kv keeps the speed against that damping. The wheel then slips as
    it starts and stops.
    """
    return any(
        actuator.kind is ActuatorKind.VELOCITY
        and actuator.tuning is not None
        and actuator.tuning.at_least
        and actuator.kv * actuator.gear**2 * OPEN_TIMESTEP > 2.0 * actuator.tuning.inertia > 0.0
        and _has_little_effort(actuator, robot.joint_by_name[actuator.joint])
        for actuator in robot.actuators
    )


def _has_little_effort(actuator: Actuator, joint: Joint) -> bool:
    """Whether the damping of the joint takes more than a share of its effort at its velocity limit."""
    effort = min(actuator.limit.effort, joint.limit.effort)
    speed = min(actuator.limit.velocity, joint.limit.velocity)
    return isfinite(speed) and joint.dynamics.damping * speed > _SPENT * effort
