"""Motors and servos: the sections of the catalogue and of a user's own motors, each figure with its source.

All figures are those of the output shaft, except ``rotor_inertia`` and ``torque_constant_motor``.
"""

import math
import re
from collections.abc import Callable
from enum import StrEnum
from functools import partial
from typing import Annotated, Any, Literal, NamedTuple, get_args

from msgspec import Struct
from pydantic import Field, PlainValidator, Tag, WithJsonSchema
from pydantic_core import CoreSchema, core_schema

from . import units
from .quantities import described, fault, quantity
from .section import WORD_OR_MAPPING, Name, Section
from .units import Dimension


class MotorKind(StrEnum):
    """The type of a motor."""

    SERVO = "servo"
    DIRECT_DRIVE = "direct_drive"
    STRAIN_WAVE = "strain_wave"
    DC_MOTOR = "dc_motor"
    BRUSHLESS = "brushless"
    STEPPER = "stepper"
    LINEAR = "linear"


class Figure(NamedTuple):
    """A number with its source."""

    value: Any
    """[SI]: a number, or numbers."""
    source: str = ""
    """Empty for the motor's own."""
    voltage: float | None = None
    """Supply [V] at which it holds, if it is not that of the motor."""


_KEYS = ("value", "source", "voltage")
_ELECTRICAL = re.compile(
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<prefix>[mk]?)(?P<unit>V|A|ohm|Ohm|Ω)\s*"
)
_PREFIXES = {"": 1.0, "m": 1e-3, "k": 1e3}
_OHM = ("ohm", "Ohm", "Ω")
"""Names of the unit of resistance."""


def _number(value: Any, *dimensions: Dimension, above: float = 0.0) -> float:
    """A finite number with a unit of one of the dimensions, and more than ``above``."""
    number = float(quantity(value, *dimensions))
    if not math.isfinite(number) or number <= above:
        raise fault("SB125", f"{number:g} is out of range: {dimensions[0].name} must be greater than {above:g}")
    return number


def _electrical(value: Any, units_: tuple[str, ...]) -> float:
    """A positive number of volts, amperes or ohms."""
    match = _ELECTRICAL.fullmatch(value) if isinstance(value, str) else None
    if match is not None and match["unit"] in units_:
        value = float(match["number"]) * _PREFIXES[match["prefix"]]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise fault("SB124", f"expected a number of {units_[0]}, not {described(value)}", f"example: 12 {units_[0]}")
    if not (math.isfinite(value) and value > 0.0):
        raise fault("SB125", f"{value:g} is out of range: must be greater than 0")
    return float(value)


def _lengths(value: Any) -> tuple[float, float, float]:
    if not isinstance(value, list) or len(value) != 3:
        raise fault("SB122", f"expected three lengths, not {described(value)}", "example: [28.5 mm, 46.5 mm, 34 mm]")
    first, second, third = (_number(one, units.LENGTH) for one in value)
    return first, second, third


def _strokes(value: Any) -> tuple[tuple[float, float], ...]:
    if not isinstance(value, list) or not all(isinstance(one, list) and len(one) == 2 for one in value):
        raise fault("SB122", f"expected pairs of a stroke and a mass, not {described(value)}", "[[50 mm, 56 g], ...]")
    return tuple((_number(stroke, units.LENGTH), _number(mass, units.MASS)) for stroke, mass in value)


def _figure(value: Any, read: Callable[[Any], Any]) -> Figure:
    """A figure: its value alone, or ``{value, source, voltage}``."""
    if not isinstance(value, dict):
        return Figure(read(value))
    if unknown := [key for key in value if key not in _KEYS]:
        raise fault("SB120", f"unknown key '{unknown[0]}'", "keys here: " + ", ".join(_KEYS))
    if "value" not in value:
        raise fault("SB121", "missing key 'value'", "write {value: ..., source: ...}")
    source, voltage = value.get("source", ""), value.get("voltage")
    if not isinstance(source, str):
        raise fault("SB122", f"source: expected a string, not {described(source)}")
    return Figure(read(value["value"]), source, None if voltage is None else _electrical(voltage, ("V",)))


class _Reads(Struct, frozen=True, eq=False):
    """How a figure is read, and its JSON Schema."""

    read: Callable[[Any], Any]
    unit: str
    example: Any

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        del source, handler
        return core_schema.no_info_plain_validator_function(partial(_figure, read=self.read))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        del schema, handler
        plain = {"type": "array"} if isinstance(self.example, list) else {"type": ["number", "string"]}
        whole = {
            "type": "object",
            "properties": {"value": plain, "source": {"type": "string"}, "voltage": {"type": ["number", "string"]}},
            "required": ["value"],
            "additionalProperties": False,
        }
        about = f"[{self.unit}], or `{{value, source}}`."
        return {"anyOf": [plain, whole], "description": about, "examples": [self.example]}


def _quantity(*dimensions: Dimension, above: float = 0.0) -> _Reads:
    unit = " or ".join(dimension.unit for dimension in dimensions)
    return _Reads(lambda value: _number(value, *dimensions, above=above), unit, dimensions[0].example)


Torque = Annotated[Figure, _quantity(units.TORQUE)]
Force = Annotated[Figure, _quantity(units.FORCE)]
Speed = Annotated[Figure, _quantity(units.ANGULAR_SPEED)]
LinearSpeed = Annotated[Figure, _quantity(units.SPEED)]
Ratio = Annotated[Figure, _quantity(units.RATIO)]
Inertia = Annotated[Figure, _quantity(units.INERTIA)]
Friction = Annotated[Figure, _quantity(units.TORQUE, above=-1e-300)]
Damping = Annotated[Figure, _quantity(units.ANGULAR_DAMPING, above=-1e-300)]
Stiffness = Annotated[Figure, _quantity(units.ANGULAR_STIFFNESS)]
Play = Annotated[Figure, _quantity(units.ANGLE, units.LENGTH)]
MotorMass = Annotated[Figure, _quantity(units.MASS)]
MotorLength = Annotated[Figure, _quantity(units.LENGTH)]
Volts = Annotated[Figure, _Reads(lambda value: _electrical(value, ("V",)), "V", "12 V")]
Amperes = Annotated[Figure, _Reads(lambda value: _electrical(value, ("A",)), "A", "1.4 A")]
Ohms = Annotated[Figure, _Reads(lambda value: _electrical(value, _OHM), "ohm", "2.7 ohm")]
TorqueConstant = Annotated[Figure, _Reads(lambda value: _number(value, units.RATIO), "N*m/A", 1.8)]
Size = Annotated[Figure, _Reads(_lengths, "m", ["28.5 mm", "46.5 mm", "34 mm"])]
Strokes = Annotated[Figure, _Reads(_strokes, "m, kg", [["50 mm", "56 g"]])]
Text = Annotated[str, Field(min_length=1, max_length=1000)]
MotorName = Annotated[str, Field(min_length=1, max_length=200)]
SupplyVoltage = Annotated[
    float,
    PlainValidator(lambda value: _electrical(value, ("V",))),
    WithJsonSchema({"type": ["number", "string"], "examples": ["12 V"]}),
]


class AtVoltage(Section):
    """Figures at another supply."""

    voltage: SupplyVoltage
    """The supply [V]."""
    stall_torque: Torque | None = None
    """Torque [N m] at zero speed."""
    no_load_speed: Speed | None = None
    """Speed [rad/s] without a load."""
    rated_speed: Speed | None = None
    """Speed [rad/s] at the rated torque."""
    stall_current: Amperes | None = None
    """Current [A] at zero speed."""
    source: Text | None = None
    """Where the figures come from."""


class PublishedAlternative(Section):
    """A figure that another source gives; it is shown, and never filled in."""

    field: Text
    """The key of the figure."""
    value: Annotated[Any, WithJsonSchema({"type": ["number", "string", "array"]})]
    """The figure [SI]."""
    source: Text
    """Where it comes from."""


class MotorSection(Section):
    """A motor, a servo or a linear drive: figures of its output shaft, each with a source."""

    kind: MotorKind
    """The type: servo, direct_drive, strain_wave, dc_motor, brushless, stepper or linear."""
    maker: Text | None = None
    """Its maker."""
    control: Literal["voltage", "current"] | None = None
    """What its firmware sets; the back-EMF of a motor at a set voltage brakes it: `back_emf_damping`."""
    names: tuple[Text, ...] = ()
    """Other names, as in CAD files."""
    family: tuple[Text, ...] = ()
    """Names that it shares with other motors; `motor:` with such a name is an error that lists them."""
    source: Text | None = None
    """Source of the figures without their own; it begins with its kind: data sheet, maker page, measured, ..."""
    voltage: Volts | None = None
    """Supply [V] at which the figures hold."""
    stall_torque: Torque | None = None
    """Torque [N m] at zero speed, for a short time."""
    peak_torque: Torque | None = None
    """Torque [N m] at the current limit of its drive, for a short time."""
    holding_torque: Torque | None = None
    """Torque [N m] of a stepper at rated current."""
    rated_torque: Torque | None = None
    """Continuous torque [N m]."""
    max_force: Force | None = None
    """Force [N] of a linear drive."""
    no_load_speed: Speed | None = None
    """Speed [rad/s] without a load."""
    rated_speed: Speed | None = None
    """Speed [rad/s] at the rated torque."""
    no_load_linear_speed: LinearSpeed | None = None
    """Speed [m/s] of a linear drive without a load."""
    gear_ratio: Ratio | None = None
    """Turns of the rotor per turn of the output shaft."""
    armature: Inertia | None = None
    """Inertia [kg m^2] of the rotor, reflected to the output shaft."""
    rotor_inertia: Inertia | None = None
    """Inertia [kg m^2] of the rotor, at the rotor."""
    coulomb_friction: Friction | None = None
    """Dry friction [N m]."""
    viscous_damping: Damping | None = None
    """Damping [N m s/rad] without back-EMF."""
    back_emf_damping: Damping | None = None
    """torque_constant^2 / winding_resistance [N m s/rad]: added to the damping if `control` is voltage."""
    detent_torque: Torque | None = None
    """Torque [N m] of an unpowered stepper; it depends on the position."""
    backdrive_force: Force | None = None
    """Force [N] that moves an unpowered linear drive."""
    backlash: Play | None = None
    """Full play [rad], or [m] of a linear drive."""
    position_gain: Stiffness | None = None
    """Stiffness [N m/rad] of the firmware's position control."""
    torque_constant: TorqueConstant | None = None
    """Torque per current [N m/A] at the output shaft."""
    torque_constant_motor: TorqueConstant | None = None
    """Torque per current [N m/A] at the rotor."""
    winding_resistance: Ohms | None = None
    """Resistance [ohm] of the winding."""
    stall_current: Amperes | None = None
    """Current [A] at zero speed."""
    mass: MotorMass | None = None
    """Mass [kg]."""
    size: Size | None = None
    """Edges [m] of its bounding box, in any order."""
    diameter: MotorLength | None = None
    """Diameter [m] of a round body."""
    length: MotorLength | None = None
    """Length [m] of a round body."""
    mass_by_stroke: Strokes | None = None
    """Strokes [m] of a linear drive, each with its mass [kg]."""
    at_other_voltages: tuple[AtVoltage, ...] = ()
    """Figures at other supplies."""
    alternatives: tuple[PublishedAlternative, ...] = ()
    """Figures of other sources, which are shown and never filled in."""
    doubts: dict[Name, Text] = Field(default_factory=dict)
    """Why a figure may be wrong, by its key; shown where the motor is used."""
    note: Text | None = None
    """A remark."""

    def figures(self) -> dict[str, Figure]:
        """Each figure that is given, with its source."""
        given = ((name, getattr(self, name)) for name in type(self).model_fields)
        return {
            name: value._replace(source=value.source or self.source or "")
            for name, value in given
            if isinstance(value, Figure)
        }

    def unit_of(self, key: str) -> str:
        """The unit of the figure at a key, ``N m``; empty for a ratio, and for a key without a figure."""
        field = type(self).model_fields.get(key)
        members = get_args(field.annotation) if field is not None else ()  # of the figure, or None
        unit = next((one.unit for member in members for one in get_args(member) if isinstance(one, _Reads)), "1")
        turning, _, sliding = unit.partition(" or ")
        unit = sliding or turning if self.kind is MotorKind.LINEAR else turning
        return "" if unit == "1" else unit.replace("*", " ")


MotorFile = Annotated[str, Field(min_length=1, max_length=4000, pattern=r"\.(yaml|yml|json)$")]
Motors = Annotated[
    Annotated[MotorFile, Tag("<word>")] | Annotated[dict[Name, MotorSection], Tag("<mapping>")], WORD_OR_MAPPING
]
"""The path of a file of motors, relative to the sidecar, or motors by name."""


class OwnMotors(Section):
    """A file of motors."""

    motors: dict[Name, MotorSection]
    """The motors by name."""
