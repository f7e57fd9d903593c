"""The search for links that can overlap."""

from enum import StrEnum
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, WithJsonSchema

from stepbot.robot.self_collision import DEFAULT_SAMPLES, MOST_SAMPLES
from stepbot.robot.tuning import Integrator

from .devices import Count
from .quantities import StepShare, Timestep, fault, two
from .section import Reference, Section


def _sample_count(value: int) -> int:
    if value > MOST_SAMPLES:
        raise fault("SB125", f"{value} is out of range: must be at most {MOST_SAMPLES}")
    return value


SampleCount = Annotated[
    Count, AfterValidator(_sample_count), WithJsonSchema({"type": "integer", "minimum": 1, "maximum": MOST_SAMPLES})
]


LinkPair = Annotated[tuple[Reference, Reference], BeforeValidator(two)]
"""Two links."""


class ExcludedPairs(StrEnum):
    """Pairs of links by how often they overlap in sampled poses."""

    ALWAYS = "always"
    NEVER = "never"


class SelfCollisionSection(Section):
    """A search for the links that can overlap, in random poses within the limits."""

    samples: SampleCount = DEFAULT_SAMPLES
    """Number of poses, the drawn one included."""
    exclude: tuple[ExcludedPairs, ...] = (ExcludedPairs.ALWAYS,)
    """Pairs whose contacts MJCF excludes, in addition to adjacent links."""


class SimulationSection(Section):
    """Settings for simulating the robot, for formats and engines that have them."""

    timestep: Timestep | None = None
    """Time step [s]; by default 1 ms for a robot with closures or mimics, else 2 ms."""
    integrator: Integrator | None = None
    """The method of integration, in MuJoCo's terms: implicitfast, the default, implicit, euler or rk4."""
    closure_stiffness: StepShare | None = None
    """Share of a gap of a closure or mimic that is closed within one time step, above 0 and at most 1, the default."""
