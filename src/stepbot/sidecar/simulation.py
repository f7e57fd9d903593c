"""Settings of a simulation."""

from stepbot.robot.tuning import Integrator

from .quantities import StepShare, Timestep
from .section import Section


class SimulationSection(Section):
    """Settings for simulating the robot, for formats and engines that have them."""

    timestep: Timestep | None = None
    """Time step [s]; by default 1 ms for a robot with closures or mimics, else 2 ms."""
    integrator: Integrator | None = None
    """The method of integration, in MuJoCo's terms: implicitfast, the default, implicit, euler or rk4."""
    closure_stiffness: StepShare | None = None
    """Share of a gap of a closure or mimic that is closed within one time step, above 0 and at most 1, the default."""
