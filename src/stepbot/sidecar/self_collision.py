"""The search for links that can overlap."""

from enum import StrEnum
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, WithJsonSchema

from stepbot.robot.self_collision import DEFAULT_SAMPLES, MOST_SAMPLES

from .counts import Count
from .quantities import fault, two
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
