"""Units of measure: the only scale factors in stepbot.

Inside, everything is SI: m, kg, s, rad. Values are converted on input, in ``step/`` and ``sidecar/``. A quantity is
written as a number in SI units, or as a number with its unit: ``45 deg``, ``1.04 g/cm^3``, ``1.5 N*m``, also in the
notations of catalogues: ``1.04 g/cm3``, ``1.5 N.m``, ``20 kg.cm``, ``80 oz-in``. Scales are exact fractions, so that
``57.2 g`` is 0.0572 kg and not 0.057200000000000004. (The table is stepbot's own because importing a units library
would cost every run more than half a second.)
"""

import math
import re
from fractions import Fraction
from typing import Any, NamedTuple

from msgspec import Struct
from pydantic import WithJsonSchema

from stepbot.diagnostics import did_you_mean

Powers = tuple[int, int, int, int]
"""Exponents of kilogram, metre, second and radian."""


class Dimension(Struct, frozen=True):
    """A physical dimension."""

    name: str
    unit: str
    """The SI unit, as printed."""
    powers: tuple[Powers, ...]
    """Accepted exponents; several if radians may be omitted."""
    example: str


LENGTH = Dimension("length", "m", ((0, 1, 0, 0),), "12 mm")
ANGLE = Dimension("angle", "rad", ((0, 0, 0, 1),), "45 deg")
MASS = Dimension("mass", "kg", ((1, 0, 0, 0),), "57 g")
DENSITY = Dimension("density", "kg/m^3", ((1, -3, 0, 0),), "1.04 g/cm^3")
INERTIA = Dimension("inertia", "kg*m^2", ((1, 2, 0, 0),), "120 g*cm^2")
SPEED = Dimension("speed", "m/s", ((0, 1, -1, 0),), "20 mm/s")
ANGULAR_SPEED = Dimension("angular speed", "rad/s", ((0, 0, -1, 1),), "60 rpm")
ACCELERATION = Dimension("acceleration", "m/s^2", ((0, 1, -2, 0),), "2 m/s^2")
ANGULAR_ACCELERATION = Dimension("angular acceleration", "rad/s^2", ((0, 0, -2, 1),), "300 deg/s^2")
JERK = Dimension("jerk", "m/s^3", ((0, 1, -3, 0),), "50 m/s^3")
ANGULAR_JERK = Dimension("angular jerk", "rad/s^3", ((0, 0, -3, 1),), "5000 deg/s^3")
FORCE = Dimension("force", "N", ((1, 1, -2, 0),), "20 N")
TORQUE = Dimension("torque", "N*m", ((1, 2, -2, 0),), "1.5 N*m")
LINEAR_DAMPING = Dimension("damping", "N*s/m", ((1, 0, -1, 0),), "10 N*s/m")
ANGULAR_DAMPING = Dimension("damping", "N*m*s/rad", ((1, 2, -1, -1), (1, 2, -1, 0)), "0.1 N*m*s/rad")
LINEAR_STIFFNESS = Dimension("stiffness", "N/m", ((1, 0, -2, 0),), "200 N/m")
ANGULAR_STIFFNESS = Dimension("stiffness", "N*m/rad", ((1, 2, -2, -1), (1, 2, -2, 0)), "5 N*m/rad")
TIME = Dimension("time", "s", ((0, 0, 1, 0),), "1 ms")
FREQUENCY = Dimension("rate", "Hz", ((0, 0, -1, 0),), "30 Hz")
PITCH = Dimension("pitch", "m/rad", ((0, 1, 0, -1),), "2 mm/rev")
TURNS = Dimension("turn per distance", "rad/m", ((0, -1, 0, 1),), "30 deg/mm")
RATIO = Dimension("ratio", "1", ((0, 0, 0, 0),), "0.2 %")


class UnitOfMeasure(NamedTuple):
    """``scale * (2 pi)**turns`` SI units."""

    scale: Fraction
    turns: int
    powers: Powers


class Quantity(NamedTuple):
    """A parsed value."""

    value: float
    """[SI]."""
    dimension: Dimension | None
    """The dimension of the given unit; None for a plain number."""
    taken_as: str = ""
    """The interpretation of a mass as a force, ``20 kgf*cm`` for ``20 kg.cm``; else empty."""


class UnitError(ValueError):
    """A string is not a quantity of the expected dimension; ``hints`` are suggestions."""

    def __init__(self, message: str, hints: tuple[str, ...] = ()) -> None:
        self.hints = hints
        super().__init__(message)


def read_quantity(text: str, *dimensions: Dimension) -> Quantity:
    """The SI value of ``text``, and whether it has a unit of one of ``dimensions``.

    Raises:
        UnitError: No number, an unknown unit, or a unit of none of the dimensions.
    """
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise UnitError(
            f"invalid quantity {_shown(text)}: expected {_a(dimensions)}", _number_hints(text, dimensions[0])
        )
    if match["unit"] is None:
        return Quantity(_float(match["number"]), None)
    unit = _parse_unit(match["unit"])
    for dimension in dimensions:
        if unit.powers in dimension.powers:
            return Quantity(_scaled(match["number"], unit), dimension)
    if unit.powers == _MASS_TIMES_LENGTH and TORQUE in dimensions:  # the notation of torques in data sheets of servos
        weight = UnitOfMeasure(unit.scale * _G0, unit.turns, TORQUE.powers[0])
        return Quantity(_scaled(match["number"], weight), TORQUE, f"{match['number']} {_with_forces(match['unit'])}")
    message = f"wrong unit '{match['unit']}': expected {described(*dimensions)}"
    raise UnitError(message, _dimension_hints(match["number"], match["unit"], unit, dimensions))


def described(*dimensions: Dimension) -> str:
    """Names and SI units: ``angle [rad] or length [m]``, ``damping [N*m*s/rad] or [N*s/m]``."""
    units_of: dict[str, list[str]] = {}
    for dimension in dimensions:
        units_of.setdefault(dimension.name, []).append(f"[{dimension.unit}]")
    return " or ".join(f"{name} {' or '.join(units)}" for name, units in units_of.items())


_MASS_TIMES_LENGTH: Powers = (1, 1, 0, 0)

_INCH = Fraction("0.0254")
_POUND = Fraction("0.45359237")
_G0 = Fraction("9.80665")
"""Standard gravity [m/s^2], which converts a kilogram or a pound to a force."""


def _unit(scale: Fraction | str | int, dimension: Dimension, turns: int = 0) -> UnitOfMeasure:
    return UnitOfMeasure(Fraction(scale), turns, dimension.powers[0])


_DEGREE = _unit("1/360", ANGLE, 1)

UNITS: dict[str, UnitOfMeasure] = {
    "m": _unit(1, LENGTH),
    "km": _unit(1000, LENGTH),
    "dm": _unit("1e-1", LENGTH),
    "cm": _unit("1e-2", LENGTH),
    "mm": _unit("1e-3", LENGTH),
    "um": _unit("1e-6", LENGTH),
    "\N{MICRO SIGN}m": _unit("1e-6", LENGTH),
    "nm": _unit("1e-9", LENGTH),
    "in": _unit(_INCH, LENGTH),
    "inch": _unit(_INCH, LENGTH),
    "ft": _unit(12 * _INCH, LENGTH),
    "t": _unit(1000, MASS),
    "kg": _unit(1, MASS),
    "g": _unit("1e-3", MASS),
    "mg": _unit("1e-6", MASS),
    "lb": _unit(_POUND, MASS),
    "oz": _unit(_POUND / 16, MASS),
    "s": _unit(1, TIME),
    "ms": _unit("1e-3", TIME),
    "min": _unit(60, TIME),
    "rad": _unit(1, ANGLE),
    "mrad": _unit("1e-3", ANGLE),
    "deg": _DEGREE,
    "\N{DEGREE SIGN}": _DEGREE,
    "rev": _unit(1, ANGLE, 1),
    "rpm": _unit("1/60", ANGULAR_SPEED, 1),
    "Hz": _unit(1, FREQUENCY),
    "kHz": _unit(1000, FREQUENCY),
    "N": _unit(1, FORCE),
    "kN": _unit(1000, FORCE),
    "mN": _unit("1e-3", FORCE),
    "lbf": _unit(_POUND * _G0, FORCE),
    "ozf": _unit(_POUND / 16 * _G0, FORCE),
    "kgf": _unit(_G0, FORCE),
    "gf": _unit(_G0 / 1000, FORCE),
    "Nm": _unit(1, TORQUE),
    "mNm": _unit("1e-3", TORQUE),
    "%": _unit("1e-2", RATIO),
}
"""Every unit by its symbol."""

_LONGEST = 100
"""Maximum length of a quantity; longer texts are rejected without parsing, to bound the time."""
_NUMBER = r"[+-]?(?:(?:\d[\d_]*(?:\.[\d_]*)?|\.\d[\d_]*)(?:[eE][+-]?\d+)?|\.?inf)"
_QUANTITY = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>[^\s\d_.,+*/^-].*?)?\s*", re.ASCII)
_FACTOR = re.compile(
    r"\s*(?P<operator>[*/.\N{MIDDLE DOT}\N{DOT OPERATOR}-])?\s*(?P<symbol>[A-Za-z\N{MICRO SIGN}]+|[%\N{DEGREE SIGN}])"
    r"(?:\s*(?:\^|\*\*)\s*(?P<power>[+-]?\d)(?!\d)"
    r"|(?P<raised>-[1-3]|[23\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}])(?!\d))?",
    re.ASCII,
)
_SUPERSCRIPTS = {"\N{SUPERSCRIPT TWO}": 2, "\N{SUPERSCRIPT THREE}": 3}

QUANTITY_PATTERN = rf"^\s*{_NUMBER.replace('(?:', '(')}(\s*[^\s\d_.,+*/^-].*)?\s*$"
"""For JSON Schema (ECMA 262): a number and an optional unit; the dimension is checked by :func:`read_quantity`."""


def _float(number: str) -> float:
    return float(number.replace("_", "").replace(".inf", "inf"))


def _scaled(number: str, unit: UnitOfMeasure) -> float:
    """The number times the unit, rounded once unless it involves turns."""
    plain = _float(number)
    if not math.isfinite(plain) or plain == 0.0:
        return plain
    exact = Fraction(number.replace("_", "")) * unit.scale
    try:
        value = float(exact)
    except OverflowError:
        value = math.copysign(math.inf, plain)
    return value * math.tau**unit.turns if unit.turns else value


def _parse_unit(text: str) -> UnitOfMeasure:
    """The product of factors such as ``N*m*s/rad``, ``g/cm^3``, ``g/cm3``, ``N m`` or ``N.m``, from left to right."""
    scale, turns, powers, end = Fraction(1), 0, (0, 0, 0, 0), 0
    while end < len(text.rstrip()):
        match = _FACTOR.match(text, end)
        if match is None or match["symbol"] not in UNITS or (match["operator"] and not end):
            symbol = match["symbol"] if match else text
            raise UnitError(f"unknown unit '{text}'", _spelling_hints(text, symbol))
        written = match["power"] or match["raised"] or "1"
        power = _SUPERSCRIPTS[written] if written in _SUPERSCRIPTS else int(written)
        power = -power if match["operator"] == "/" else power
        factor = UNITS[match["symbol"]]
        scale *= factor.scale**power
        turns += factor.turns * power
        powers = _multiplied(powers, factor.powers, power)
        end = match.end()
    return UnitOfMeasure(scale, turns, powers)


_FORCE_OF = {"kg": "kgf", "g": "gf", "lb": "lbf", "oz": "ozf"}
"""The force that a unit of mass stands for, if a data sheet omits its `f`."""


def _with_forces(text: str) -> str:
    """A unit with forces in place of masses: ``kgf*cm`` for ``kg.cm``."""
    symbols = re.findall(r"[A-Za-z\N{MICRO SIGN}]+", text)
    return "*".join(_FORCE_OF.get(symbol, symbol) for symbol in symbols)


def _multiplied(a: Powers, b: Powers, power: int) -> Powers:
    kilogram, metre, second, radian = (x + power * y for x, y in zip(a, b, strict=True))
    return (kilogram, metre, second, radian)


_SPELLED_OUT = {
    "degree": "deg",
    "degrees": "deg",
    "radian": "rad",
    "radians": "rad",
    "turn": "rev",
    "turns": "rev",
    "meter": "m",
    "metre": "m",
    "meters": "m",
    "metres": "m",
    "millimeter": "mm",
    "millimetre": "mm",
    "inches": "in",
    "gram": "g",
    "grams": "g",
    "kilogram": "kg",
    "kilograms": "kg",
    "kilo": "kg",
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "newton": "N",
    "nm": "N*m",
    "gr": "g",
    "lbs": "lb",
    "kgcm": "kgf*cm",
    "kgfcm": "kgf*cm",
    "ozin": "ozf*in",
    "cc": "cm^3",
    "\N{MASCULINE ORDINAL INDICATOR}": "\N{DEGREE SIGN}",
}


def _spelling_hints(text: str, symbol: str) -> tuple[str, ...]:
    """Help for an unknown symbol in the text of a unit."""
    if symbol.lower() in _SPELLED_OUT:
        return (f"did you mean '{text.strip().replace(symbol, _SPELLED_OUT[symbol.lower()])}'?",)
    return did_you_mean(symbol, UNITS) or ("known units: " + ", ".join(UNITS),)


def _dimension_hints(number: str, text: str, unit: UnitOfMeasure, dimensions: tuple[Dimension, ...]) -> tuple[str, ...]:
    if text == "nm":  # nm is a nanometre, not a torque
        return ("did you mean 'N*m'?",)
    hints = []
    if unit.powers == MASS.powers[0] and text in _FORCE_OF:
        force, arm = _FORCE_OF[text], "in" if text in ("oz", "lb") else "cm"
        if TORQUE in dimensions:
            hints.append(
                f"torque is force times length: `{number} {force}*{arm}`, if that is the unit of the data sheet"
            )
        if FORCE in dimensions:
            hints.append(f"{text} is a unit of mass; for a force write `{number} {force}`")
        if DENSITY in dimensions:
            hints.append("density is mass per volume: g/cm^3 or kg/m^3")
    as_force = _multiplied(unit.powers, (0, 1, -2, 0), 1)
    if not hints and any(as_force in dimension.powers for dimension in dimensions):
        hints.append("units of force are N, kgf, lbf and ozf; kg, lb and oz are units of mass")
    return (*hints, f"example: {' or '.join(d.example for d in dimensions)}")


_DECIMAL_COMMA = re.compile(r"(?P<whole>\s*[+-]?\d+),(?P<decimals>\d+)(?P<rest>[^,]*)", re.ASCII)


def _number_hints(text: str, dimension: Dimension) -> tuple[str, ...]:
    if match := _DECIMAL_COMMA.fullmatch(text) if len(text) <= _LONGEST else None:
        corrected = (match["whole"] + "." + match["decimals"] + match["rest"]).strip()
        hint = f"use a decimal point: `{corrected}`"
        if len(match["decimals"]) == 3 and match["whole"].strip(" +-0"):  # 1,000 may be a thousand
            thousand = (match["whole"] + match["decimals"] + match["rest"]).strip()
            hint += f"; if the comma is a thousands separator: `{thousand}`"
        return (hint,)
    return (f"write a number [{dimension.unit}], or a number with a unit, such as {dimension.example}",)


def _a(dimensions: tuple[Dimension, ...]) -> str:
    names = " or ".join(dict.fromkeys(dimension.name for dimension in dimensions))
    return f"an {names}" if names[0] in "aeiou" else f"a {names}"


def _shown(text: str) -> str:
    return f"'{text}'" if len(text) <= _LONGEST else f"'{text[:40]}...'"


NUMBERS3 = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
CHANNELS = {"type": "array", "items": {"type": "number", "minimum": 0, "maximum": 1}, "minItems": 3, "maxItems": 4}
HEX_COLOR = {"type": "string", "pattern": "^#([0-9a-fA-F]{3,4}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})$"}


def quantity_schema(
    *dimensions: Dimension, word: str = "", low: float = -math.inf, above: float = -math.inf, high: float = math.inf
) -> WithJsonSchema:
    """A quantity: a number in SI units, within finite bounds, or a string with the unit; or one word, if given."""
    examples = [dimension.example for dimension in dimensions]
    quoted = ", ".join(dict.fromkeys(f"`{example}`" for example in examples))
    text = f"{described(*dimensions)}: a number without a unit is SI; with a unit: {quoted}."
    bounds = {"minimum": low, "exclusiveMinimum": above, "maximum": high}
    forms = _number_or_text(**{name: _plain(bound) for name, bound in bounds.items() if math.isfinite(bound)})
    if word:
        forms["anyOf"].append({"const": word})
    return WithJsonSchema({**forms, "description": text, "examples": examples})


def _plain(number: float) -> float:
    return int(number) if number == int(number) else number


def vector_schema(dimension: Dimension) -> WithJsonSchema:
    """Three quantities of one dimension."""
    of_each = f"each a {dimension.name} [{dimension.unit}] or with a unit: `{dimension.example}`"
    return WithJsonSchema(
        {
            "type": "array",
            "items": _number_or_text(),
            "minItems": 3,
            "maxItems": 3,
            "description": f"`[x, y, z]`, {of_each}.",
            "examples": [[0, 0, dimension.example]],
        }
    )


def _number_or_text(**bounds: float) -> dict[str, Any]:
    return {"anyOf": [{"type": "number", **bounds}, {"type": "string", "pattern": QUANTITY_PATTERN}]}
