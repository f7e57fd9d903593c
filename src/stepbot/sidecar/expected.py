"""What a robot is expected to be: values that a check compares with what the CAD gives."""

from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import Field, PlainValidator, WithJsonSchema

from . import units
from .quantities import LengthVector, Mass, ToleranceValue, described, fault
from .section import ComponentPath, Reference, Section
from .units import Dimension, UnitError, read_quantity

_MOST = 1e9


def _within(dimension: Dimension) -> Callable[[Any], ToleranceValue]:
    """Parser of a tolerance: a share of the value, ``2 %``, or a quantity."""

    def parse(value: Any) -> ToleranceValue:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise fault("SB122", f"expected a share or a {dimension.name}, not {described(value)}", "example: 2 %")
        share = isinstance(value, str) and value.strip().endswith("%")
        number = _number(value, units.RATIO if share else dimension, f"2 % or {dimension.example}")
        return ToleranceValue(number, 0.0) if share else ToleranceValue(0.0, number)

    return parse


def _number(value: float | str, dimension: Dimension, example: str) -> float:
    try:
        number = float(value) if isinstance(value, int | float) else read_quantity(value, dimension).value
    except UnitError as failure:
        raise fault("SB124", str(failure), f"example: {example}") from None
    if not 0.0 < number < _MOST:
        raise fault("SB125", f"{number:g} is out of range: it must be greater than 0", f"example: {example}")
    return number


def _length(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise fault("SB122", f"expected a length, not {described(value)}", "example: 850 mm")
    return _number(value, units.LENGTH, "850 mm")


_SCHEMA = {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string", "pattern": units.QUANTITY_PATTERN}]}
Length = Annotated[float, PlainValidator(_length), WithJsonSchema(_SCHEMA)]
WithinMass = Annotated[ToleranceValue, PlainValidator(_within(units.MASS)), WithJsonSchema(_SCHEMA)]
WithinLength = Annotated[ToleranceValue, PlainValidator(_within(units.LENGTH)), WithJsonSchema(_SCHEMA)]


class ExpectedMass(Section):
    """A mass, and how far the computed one may be from it."""

    value: Mass
    """Mass [kg]."""
    within: WithinMass
    """Largest difference: a share of the value, or a mass [kg]."""


class ExpectedCom(Section):
    """A centre of mass, and how far the computed one may be from it."""

    value: LengthVector
    """Position [m]: of the robot in the frame of its root link, in the drawn pose; of a link in its own frame."""
    within: WithinLength
    """Largest distance [m]."""


class ExpectedReach(Section):
    """How far a frame or a link gets from another one, over the limits of all joints."""

    value: Length
    """Largest distance [m] of the origins."""
    within: WithinLength
    """Largest difference: a share of the value, or a length [m]."""
    to: Reference
    """The frame or link that reaches."""
    start: Reference | None = None
    """The frame or link to measure from; by default the root link."""


class ExpectedLink(Section):
    """What is expected of a link."""

    mass: ExpectedMass | None = None
    """Its mass."""
    com: ExpectedCom | None = None
    """Its centre of mass."""


class ExpectedPart(Section):
    """What is expected of the matching components."""

    mass: ExpectedMass
    """Mass of each of them; for a subassembly, of everything below it."""


class ExpectSection(Section):
    """Values that the robot must have; each that it has not is an error (SB525)."""

    mass: ExpectedMass | None = None
    """Mass of the whole robot."""
    com: ExpectedCom | None = None
    """Centre of mass of the whole robot."""
    reach: ExpectedReach | None = None
    """How far a frame gets."""
    links: dict[Reference, ExpectedLink] = Field(default_factory=dict)
    """By link: its mass and its centre of mass."""
    parts: dict[ComponentPath, ExpectedPart] = Field(default_factory=dict)
    """By path or glob of components: their mass."""
    symmetry: Literal["x", "y", "z"] | None = None
    """Normal of the plane, through the root link's origin, that the drawn robot is symmetric about: parts without a
    twin, and twins of different mass, are reported (SB526)."""
