"""Scalar types of the sidecar as pydantic types: numbers in SI units, or numbers with a unit.

An invalid value raises an error with the diagnostic code as its type, and the message and remedies in its context.
:mod:`stepbot.sidecar.schema_faults` adds the position and the subject.
"""

import math
import re
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import BeforeValidator, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from stepbot.diagnostics import did_you_mean
from stepbot.geometry.spatial import Vector3, unit
from stepbot.robot.inertial_doubts import FARTHEST, GREATEST
from stepbot.robot.model import Rgba

from . import units
from .text import UnknownCodePage, code_page
from .units import CHANNELS, HEX_COLOR, NUMBERS3, Dimension, UnitError, quantity_schema, read_quantity, vector_schema

Parser = Callable[[Any], float]

LONGEST_TIMESTEP = 0.1
"""Maximum time step [s]: no engine simulates a robot with a longer one."""


class JointValue(float):
    """An SI value with the dimension of its unit, to be checked against the joint type."""

    __slots__ = ("dimension",)

    dimension: Dimension | None
    """The dimension of the given unit; None for a plain number."""

    def __new__(cls, value: float, dimension: Dimension | None = None) -> Self:
        """The number, and the dimension of the given unit."""
        self = super().__new__(cls, value)
        self.dimension = dimension
        return self

    def __getnewargs__(self) -> tuple[float, Dimension | None]:  # type: ignore[override] # two, where float has one
        return (float(self), self.dimension)

    @property
    def value(self) -> float:
        """The number alone."""
        return float(self)


class ToleranceValue(NamedTuple):
    """A mesh tolerance: a fraction of each solid's diagonal, or a length."""

    relative: float
    absolute: float
    """[m]; 0 if ``relative`` applies."""


_FINEST = 1e-7  # [m]; the kernel, which measures with finer meshes, has no tolerance below 1e-10 m


def fault(code: str, text: str, *help: str) -> PydanticCustomError:
    """An error for an invalid value."""
    return PydanticCustomError(code, "{text}", {"text": text, "help": help})


def described(value: Any) -> str:
    """A YAML value, described for messages."""
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return f"the number {value:g}"
        case str():
            return f"the string '{value if len(value) <= 40 else value[:37] + '...'}'"
        case dict():
            return "a mapping"
        case None:
            return "nothing"
        case _:
            return "a list"


def quantity(value: Any, *dimensions: Dimension) -> JointValue:
    """A number, or a number with a unit of one of the dimensions; infinity is allowed, NaN is not.

    Raises:
        PydanticCustomError: SB122 wrong type, SB124 not a quantity of these dimensions, SB125 NaN.
    """
    example = " or ".join(dict.fromkeys(d.example for d in dimensions))
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        wanted = f"a number, or a string with a unit of {units.described(*dimensions)}"
        raise fault("SB122", f"expected {wanted}, not {described(value)}", f"example: {example}")
    if isinstance(value, str):
        try:
            read = read_quantity(value, *dimensions)
        except UnitError as failure:
            raise fault("SB124", str(failure), *failure.hints) from None
        return JointValue(read.value, read.dimension)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf if value > 0 else -math.inf
    if math.isnan(number):
        raise fault("SB125", "NaN is not allowed", f"write a number [{dimensions[0].unit}]; example: {example}")
    return JointValue(number)


def finite(
    dimension: Dimension, *, low: float = -math.inf, above: float = -math.inf, high: float | None = None
) -> Parser:
    """Parser of a finite number of at least ``low``, more than ``above`` and a magnitude of at most ``high``."""
    greatest = high or (FARTHEST if dimension is units.LENGTH else GREATEST)
    unit = "" if dimension is units.RATIO else f" {dimension.unit}"

    def parse(value: Any) -> float:
        number = float(quantity(value, dimension))
        if not math.isfinite(number):
            raise fault("SB125", f"{number:g} is not finite")
        if number < low or number <= above:
            bound = f"at least {low:g}" if number < low else f"greater than {above:g}"
            raise fault("SB125", f"{number:g}{unit} is out of range: {dimension.name} must be {bound}")
        if abs(number) > greatest:
            hint = f"a number without a unit is in {dimension.unit}; example with a unit: {dimension.example}"
            hints = [hint] if unit else ["1 is 100 %"] if greatest == 1.0 else []
            raise fault("SB125", f"{number:g}{unit} exceeds the maximum of {greatest:g}{unit}", *hints)
        return number

    return parse


def _listed(value: Any, count: int, expected: str) -> Any:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise fault("SB122", f"expected {expected}, not {described(value)}")
    if len(value) != count:
        raise fault("SB122", f"expected {expected}, not {len(value)}")
    return value


def two(value: Any) -> Any:
    """The value, if it is a list of two; else SB122."""
    return _listed(value, 2, "two values [first, second]")


def _three(value: Any) -> Any:
    return _listed(value, 3, "three values [x, y, z]")


_AXES: dict[str, Vector3] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}


def _axis(value: Any) -> Vector3:
    """A unit vector from one of six letters or three numbers."""
    if isinstance(value, str):
        if value not in _AXES:
            near = did_you_mean(value, _AXES) if len(value) <= 2 else ()
            raise fault("SB123", f"invalid axis '{value}'", *near, "write x, y, z, -x, -y, -z or [x, y, z]")
        return _AXES[value]
    numbers = [finite(units.RATIO, high=math.inf)(v) for v in _three(value)]
    try:
        x, y, z = unit(numbers).tolist()
    except ValueError:
        raise fault("SB125", f"axis {numbers} has zero length", "an axis must have a non-zero length") from None
    return (x, y, z)


_COLOR_HELP = 'write "#rrggbb" or "#rrggbbaa" in quotes, or [red, green, blue] with numbers from 0 to 1'


def _color(value: Any) -> Rgba:
    """``#rgb``, ``#rrggbb``, ``#rrggbbaa``, or three or four numbers from 0 to 1."""
    if isinstance(value, str):
        digits = value.removeprefix("#")
        if len(digits) in (3, 4):
            digits = "".join(2 * digit for digit in digits)
        if not value.startswith("#") or re.fullmatch(r"[0-9a-fA-F]{6}([0-9a-fA-F]{2})?", digits) is None:
            raise fault("SB123", f"invalid colour '{value}'", _COLOR_HELP)
        channels = [int(digits[i : i + 2], 16) / 255 for i in range(0, len(digits), 2)]
    elif isinstance(value, Sequence) and len(value) in (3, 4):
        channels = [finite(units.RATIO, low=0.0, high=1.0)(v) for v in value]
    else:
        raise fault("SB122", f"expected a colour, not {described(value)}", _COLOR_HELP)
    red, green, blue, alpha = [*channels, 1.0][:4]
    return (red, green, blue, alpha)


def _code_page(value: Any) -> str:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise fault("SB122", f"expected the name of a code page, not {described(value)}", "example: cp1251")
    try:
        return code_page(str(value))
    except UnknownCodePage as failure:
        raise fault("SB123", str(failure), *failure.hints) from None


def _tolerance(value: Any) -> ToleranceValue:
    if isinstance(value, str) and value.strip().endswith("%"):
        return ToleranceValue(finite(units.RATIO, above=0.0, high=1.0)(value), 0.0)
    return ToleranceValue(0.0, finite(units.LENGTH, low=_FINEST)(value))


def _distance(value: Any) -> float:
    """A length that is not negative; may be infinite."""
    number = float(quantity(value, units.LENGTH))
    if number < 0.0:
        raise fault("SB125", f"{number:g} m is out of range: length must be at least 0")
    if FARTHEST < number < math.inf:
        raise fault("SB125", f"{number:g} m exceeds the maximum of {FARTHEST:g} m", "write .inf for no end")
    return number


def bounded(
    dimension: Dimension, *, low: float = -math.inf, above: float = -math.inf, high: float = math.inf
) -> tuple[BeforeValidator, WithJsonSchema]:
    """What pydantic needs for a number of a dimension, with the bounds of :func:`finite`."""
    parser = finite(dimension, low=low, above=above, high=high if high < math.inf else None)
    return BeforeValidator(parser), quantity_schema(dimension, low=low, above=above, high=high)


def _joint_quantity(
    *dimensions: Dimension, finite: bool = True, low: float = -math.inf, above: float = -math.inf
) -> tuple[PlainValidator, WithJsonSchema]:
    """What pydantic needs for a number with one of several dimensions, stored for the check against the joint's type.

    ``above`` excludes limits of 0, which formats and engines interpret as unlimited.
    """
    name = dimensions[0].name

    def parse(value: Any) -> JointValue:
        number = quantity(value, *dimensions)
        if finite and not math.isfinite(number):
            raise fault("SB125", f"{number:g} is not finite")
        if math.isfinite(number) and abs(number) > GREATEST:
            raise fault("SB125", f"{number:g} exceeds the maximum of {GREATEST:g}")
        if number < low:
            raise fault("SB125", f"{number:g} is out of range: {name} must be at least {low:g}")
        if number <= above and math.isfinite(above):
            message = f"{number:g} is out of range: {name} must be greater than {above:g}"
            raise fault("SB125", message, "remove the key for an unlimited value")
        return number

    return PlainValidator(parse), quantity_schema(*dimensions, low=low, above=above)


Length = Annotated[float, *bounded(units.LENGTH, above=0.0)]
Angle = Annotated[float, *bounded(units.ANGLE, above=0.0, high=math.pi)]
FieldOfView = Annotated[float, *bounded(units.ANGLE, low=0.0, high=math.tau)]
Frequency = Annotated[float, *bounded(units.FREQUENCY, low=0.0)]
Bandwidth = Annotated[float, *bounded(units.FREQUENCY, above=0.0)]
DampingRatio = Annotated[float, *bounded(units.RATIO, above=0.0)]
Timestep = Annotated[float, *bounded(units.TIME, above=0.0, high=LONGEST_TIMESTEP)]
StepShare = Annotated[float, *bounded(units.RATIO, above=0.0, high=1.0)]
_Distance = Annotated[float, PlainValidator(_distance), quantity_schema(units.LENGTH, low=0.0)]
DistanceRange = Annotated[tuple[_Distance, _Distance], BeforeValidator(two)]
Mass = Annotated[float, *bounded(units.MASS, above=0.0)]
Density = Annotated[float, *bounded(units.DENSITY, above=0.0)]
DensityOrTodo = Annotated[
    float | Literal["todo"],
    BeforeValidator(lambda value: value if value == "todo" else finite(units.DENSITY, above=0.0)(value)),
    quantity_schema(units.DENSITY, word="todo", above=0.0),
]
Inertia = Annotated[float, *bounded(units.INERTIA)]
Pitch = Annotated[float, *bounded(units.PITCH)]

_Coordinate = Annotated[float, BeforeValidator(finite(units.LENGTH))]
_Extent = Annotated[float, BeforeValidator(finite(units.LENGTH, above=0.0))]
_Turn = Annotated[float, BeforeValidator(finite(units.ANGLE))]
LengthVector = Annotated[
    tuple[_Coordinate, _Coordinate, _Coordinate], BeforeValidator(_three), vector_schema(units.LENGTH)
]
SizeVector = Annotated[tuple[_Extent, _Extent, _Extent], BeforeValidator(_three), vector_schema(units.LENGTH)]
RotationVector = Annotated[tuple[_Turn, _Turn, _Turn], BeforeValidator(_three), vector_schema(units.ANGLE)]
AxisVector = Annotated[
    Vector3,
    BeforeValidator(_axis),
    WithJsonSchema(
        {
            "anyOf": [{"enum": list(_AXES)}, NUMBERS3],
            "description": "`x`, `y`, `z`, `-x`, `-y`, `-z`, or `[x, y, z]` of non-zero length.",
        }
    ),
]
Color = Annotated[
    Rgba,
    BeforeValidator(_color),
    WithJsonSchema(
        {
            "anyOf": [HEX_COLOR, CHANNELS],
            "description": 'Colour: `"#rrggbb"` or `"#rrggbbaa"` in quotes, or `[red, green, blue, opacity]`, 0 to 1.',
            "examples": ["#e0e0e0"],
        }
    ),
]
CodePage = Annotated[
    str,
    PlainValidator(_code_page),
    WithJsonSchema({"type": "string", "minLength": 1, "examples": ["cp1251", "gbk", "cp932"]}),
]
RelativeOrLength = Annotated[
    ToleranceValue,
    PlainValidator(_tolerance),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number", "minimum": _FINEST}, {"type": "string", "pattern": units.QUANTITY_PATTERN}],
            "description": "A fraction of each solid's diagonal, `0.2 %`, or a length [m], `0.1 mm`.",
            "examples": ["0.2 %", "0.1 mm"],
        }
    ),
]
Gear = Annotated[JointValue, *_joint_quantity(units.RATIO, units.TURNS)]
Multiplier = Annotated[JointValue, *_joint_quantity(units.RATIO, units.PITCH, units.TURNS)]
JointPosition = Annotated[JointValue, *_joint_quantity(units.ANGLE, units.LENGTH)]
JointBound = Annotated[JointValue, *_joint_quantity(units.ANGLE, units.LENGTH, finite=False)]
JointSpeed = Annotated[JointValue, *_joint_quantity(units.ANGULAR_SPEED, units.SPEED, finite=False, above=0.0)]
JointAcceleration = Annotated[
    JointValue, *_joint_quantity(units.ANGULAR_ACCELERATION, units.ACCELERATION, finite=False, above=0.0)
]
JointJerk = Annotated[JointValue, *_joint_quantity(units.ANGULAR_JERK, units.JERK, finite=False, above=0.0)]
JointEffort = Annotated[JointValue, *_joint_quantity(units.TORQUE, units.FORCE, finite=False, above=0.0)]
JointFriction = Annotated[JointValue, *_joint_quantity(units.TORQUE, units.FORCE, low=0.0)]
JointDamping = Annotated[JointValue, *_joint_quantity(units.ANGULAR_DAMPING, units.LINEAR_DAMPING, low=0.0)]
JointStiffness = Annotated[JointValue, *_joint_quantity(units.ANGULAR_STIFFNESS, units.LINEAR_STIFFNESS, low=0.0)]
JointInertia = Annotated[JointValue, *_joint_quantity(units.INERTIA, units.MASS, low=0.0)]
