"""Quantities with units, against the definitions of the units."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.sidecar import units
from stepbot.sidecar.units import Dimension, UnitError, read_quantity

DIMENSIONS = tuple(value for value in vars(units).values() if isinstance(value, Dimension))

# Values by definition of the units: inch 25.4 mm, pound 0.45359237 kg, g0 9.80665 m/s^2, all exact.
KNOWN = [
    ("12 mm", units.LENGTH, 0.012),
    ("12mm", units.LENGTH, 0.012),
    ("-40 mm", units.LENGTH, -0.04),
    ("+.5 in", units.LENGTH, 0.0127),
    ("3 ft", units.LENGTH, 0.9144),
    ("5 um", units.LENGTH, 5e-6),
    ("5 µm", units.LENGTH, 5e-6),
    ("45 deg", units.ANGLE, math.pi / 4),
    ("45°", units.ANGLE, math.pi / 4),
    ("180 deg", units.ANGLE, math.pi),
    ("0.5 rev", units.ANGLE, math.pi),
    ("57.2 g", units.MASS, 0.0572),
    ("1 lb", units.MASS, 0.45359237),
    ("16 oz", units.MASS, 0.45359237),
    ("1.04 g/cm^3", units.DENSITY, 1040.0),
    ("1.04 g/cm³", units.DENSITY, 1040.0),
    ("1240 kg/m**3", units.DENSITY, 1240.0),
    ("7.85 g cm^-3", units.DENSITY, 7850.0),
    ("7.85 g/cm3", units.DENSITY, 7850.0),
    ("7850 kg/m3", units.DENSITY, 7850.0),
    ("7850 kg.m-3", units.DENSITY, 7850.0),
    ("120 g.cm2", units.INERTIA, 1.2e-5),
    ("1.5 N.m", units.TORQUE, 1.5),
    ("1.5 N-m", units.TORQUE, 1.5),
    ("0.1 N.m.s/rad", units.ANGULAR_DAMPING, 0.1),
    ("1 kgf.cm", units.TORQUE, 0.0980665),
    ("1 kgf-cm", units.TORQUE, 0.0980665),
    ("1 kg.cm", units.TORQUE, 0.0980665),
    ("1 kg*cm", units.TORQUE, 0.0980665),
    ("1 oz-in", units.TORQUE, 0.45359237 / 16 * 9.80665 * 0.0254),
    ("1 oz.in", units.TORQUE, 0.45359237 / 16 * 9.80665 * 0.0254),
    ("1 lb-ft", units.TORQUE, 0.45359237 * 9.80665 * 0.3048),
    ("120 g*cm^2", units.INERTIA, 1.2e-5),
    ("60 rpm", units.ANGULAR_SPEED, 2 * math.pi),
    ("61 rpm", units.ANGULAR_SPEED, 61 * 2 * math.pi / 60),
    ("360 deg/s", units.ANGULAR_SPEED, 2 * math.pi),
    ("1 rev/min", units.ANGULAR_SPEED, 2 * math.pi / 60),
    ("20 mm/s", units.SPEED, 0.02),
    ("1.5 N*m", units.TORQUE, 1.5),
    ("1.5 N·m", units.TORQUE, 1.5),
    ("1.5 N m", units.TORQUE, 1.5),
    ("1.5 Nm", units.TORQUE, 1.5),
    ("1 kgf*cm", units.TORQUE, 0.0980665),
    ("1 kg*m^2/s^2", units.TORQUE, 1.0),
    ("1 lbf", units.FORCE, 4.4482216152605),
    ("2 mm/rev", units.PITCH, 0.001 / math.pi),
    ("0.1 N*m*s/rad", units.ANGULAR_DAMPING, 0.1),
    ("0.1 N*m*s", units.ANGULAR_DAMPING, 0.1),
    ("10 N*s/m", units.LINEAR_DAMPING, 10.0),
    ("5 N*m/rad", units.ANGULAR_STIFFNESS, 5.0),
    ("200 N/mm", units.LINEAR_STIFFNESS, 2e5),
    ("0.2 %", units.RATIO, 0.002),
    ("1_000 mm", units.LENGTH, 1.0),
    ("010 mm", units.LENGTH, 0.01),
    ("1e3 mm", units.LENGTH, 1.0),
    ("1.", units.LENGTH, 1.0),
    ("-1e-3", units.LENGTH, -0.001),
    ("inf", units.LENGTH, math.inf),
    ("-inf", units.ANGLE, -math.inf),
    (".inf", units.LENGTH, math.inf),
    ("-.inf deg", units.ANGLE, -math.inf),
    ("1e999 mm", units.LENGTH, math.inf),
    ("1e-999 mm", units.LENGTH, 0.0),
]


@pytest.mark.parametrize(("text", "dimension", "value"), KNOWN)
def test_value_is_the_closed_form(text: str, dimension: Dimension, value: float) -> None:
    """A quantity is the value by the definition of its unit, to the last bit but one."""
    assert read_quantity(text, dimension).value == pytest.approx(value, rel=2e-16)


@pytest.mark.parametrize(
    ("text", "shortest"), [("57.2 g", "0.0572"), ("0.1 mm", "0.0001"), ("12.3 cm", "0.123"), ("9.9 in", "0.25146")]
)
def test_decimal_units_add_no_digits(text: str, shortest: str) -> None:
    """A value in a decimal unit is printed as short as it was written."""
    dimension = units.MASS if text.endswith("g") else units.LENGTH
    assert repr(read_quantity(text, dimension).value) == shortest


@pytest.mark.parametrize("dimension", DIMENSIONS, ids=lambda d: f"{d.name}-{d.unit}")
def test_example_is_a_quantity(dimension: Dimension) -> None:
    """The example in messages is a quantity, and so is the SI unit that they name."""
    assert read_quantity(dimension.example, dimension).dimension == dimension
    if dimension is not units.RATIO:
        assert read_quantity(f"3 {dimension.unit}", dimension).value == 3.0


@given(value=st.floats(allow_nan=False), dimension=st.sampled_from(DIMENSIONS))
def test_plain_number_is_si(value: float, dimension: Dimension) -> None:
    """A number without a unit is returned bit for bit, for any dimension, and has no dimension."""
    assert read_quantity(repr(value), dimension) == (value, None, "")


@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_si_unit_changes_nothing(value: float) -> None:
    """A number with the SI unit is unchanged."""
    assert read_quantity(f"{value!r} m", units.LENGTH).value == value


@given(value=st.floats(min_value=1e-6, max_value=1e6), unit=st.sampled_from(["mm", "in", "ft", "km", "nm"]))
def test_ratio_of_two_quantities_is_that_of_their_numbers(value: float, unit: str) -> None:
    """Scaling is linear."""
    one = read_quantity(f"1 {unit}", units.LENGTH).value
    assert read_quantity(f"{value!r} {unit}", units.LENGTH).value == pytest.approx(value * one, rel=4e-16)


@given(degrees=st.floats(min_value=-1e4, max_value=1e4))
def test_degrees_agree_with_the_standard_library(degrees: float) -> None:
    """Degrees are converted as by ``math.radians``."""
    assert read_quantity(f"{degrees!r} deg", units.ANGLE).value == pytest.approx(
        math.radians(degrees), rel=4e-16, abs=1e-320
    )


def refusal(text: str, dimension: Dimension) -> str:
    """The reason why a text is not a quantity; empty if it is."""
    try:
        read_quantity(text, dimension)
    except UnitError as failure:
        return str(failure)
    return ""


@given(text=st.text(max_size=40))
def test_any_text_is_a_quantity_or_a_unit_error(text: str) -> None:
    """For any text the parser raises only unit errors, and never returns NaN."""
    assert refusal(text, units.LENGTH) or not math.isnan(read_quantity(text, units.LENGTH).value)


@given(text=st.from_regex(re.compile(units.QUANTITY_PATTERN, re.ASCII), fullmatch=True))
def test_schema_pattern_is_not_wider_than_needed(text: str) -> None:
    """A text that matches the schema's pattern is a number, possibly with an unknown unit."""
    why = refusal(text, units.LENGTH)
    assert not why or "unit" in why or len(text) > 100


@pytest.mark.parametrize("text", [text for text, _, _ in KNOWN])
def test_schema_pattern_accepts_every_quantity(text: str) -> None:
    """The schema's pattern accepts every quantity that the parser accepts."""
    assert re.search(units.QUANTITY_PATTERN, text)


@pytest.mark.parametrize(
    ("text", "dimension", "message", "hint"),
    [
        ("90 degs", units.ANGLE, "unknown unit 'degs'", "did you mean 'deg'?"),
        ("90 degrees", units.ANGLE, "unknown unit 'degrees'", "did you mean 'deg'?"),
        ("3 kg", units.LENGTH, "wrong unit 'kg': expected length [m]", "example: 12 mm"),
        ("5 kg", units.TORQUE, "wrong unit 'kg': expected torque [N*m]", "`5 kgf*cm`"),
        ("80 oz", units.TORQUE, "wrong unit 'oz': expected torque [N*m]", "`80 ozf*in`"),
        ("5 kg", units.FORCE, "wrong unit 'kg': expected force [N]", "for a force write `5 kgf`"),
        (
            "20 kg/mm",
            units.LINEAR_STIFFNESS,
            "wrong unit 'kg/mm': expected stiffness",
            "kg, lb and oz are units of mass",
        ),
        ("20 kg.cm", units.FORCE, "wrong unit 'kg.cm': expected force [N]", "example: 20 N"),
        ("2700 g", units.DENSITY, "wrong unit 'g': expected density", "mass per volume"),
        ("1.2 g/cc", units.DENSITY, "unknown unit 'g/cc'", "did you mean 'g/cm^3'?"),
        ("5 kgcm", units.TORQUE, "unknown unit 'kgcm'", "did you mean 'kgf*cm'?"),
        ("2 nm", units.TORQUE, "wrong unit 'nm': expected torque [N*m]", "did you mean 'N*m'?"),
        ("1,5 m", units.LENGTH, "invalid quantity '1,5 m': expected a length", "use a decimal point: `1.5 m`"),
        ("-1,57", units.ANGLE, "invalid quantity '-1,57': expected an angle", "use a decimal point: `-1.57`"),
        (
            "1,000 mm",
            units.LENGTH,
            "invalid quantity '1,000 mm'",
            "`1.000 mm`; if the comma is a thousands separator: `1000 mm`",
        ),
        ("five", units.LENGTH, "invalid quantity 'five': expected a length", "such as 12 mm"),
        ("", units.ANGLE, "invalid quantity '': expected an angle", "such as 45 deg"),
        ("5 m s", units.LENGTH, "wrong unit 'm s'", "12 mm"),
        ("5 mm^99", units.LENGTH, "unknown unit 'mm^99'", ""),
        ("5 /s", units.LENGTH, "expected a length", ""),
        ("5 mm *", units.LENGTH, "unknown unit", "did you mean"),
        ("٣ mm", units.LENGTH, "expected a length", ""),
        ("nan", units.LENGTH, "expected a length", ""),
        ("1" * 200, units.LENGTH, "...': expected a length", ""),
    ],
)
def test_message_and_hint_of_an_invalid_quantity(text: str, dimension: Dimension, message: str, hint: str) -> None:
    """A message contains the text; a hint suggests a correction."""
    with pytest.raises(UnitError) as caught:
        read_quantity(text, dimension)
    assert message in str(caught.value)
    assert hint in "\n".join(caught.value.hints)


@pytest.mark.parametrize(
    ("text", "meant"),
    [("20 kg.cm", "20 kgf*cm"), ("80 oz-in", "80 ozf*in"), ("20 kgf.cm", ""), ("1.5 N.m", ""), ("1 kg*m^2/s^2", "")],
)
def test_mass_for_a_weight_is_known(text: str, meant: str) -> None:
    """A torque with a unit of mass is reported with its interpretation; one in force units is accepted."""
    assert read_quantity(text, units.TORQUE, units.FORCE).taken_as == meant


def test_one_of_several_dimensions_is_returned() -> None:
    """The dimension of the unit is returned; a text of another dimension is rejected with the accepted ones."""
    assert read_quantity("45 deg", units.ANGLE, units.LENGTH).dimension is units.ANGLE
    assert read_quantity("45 mm", units.ANGLE, units.LENGTH) == (0.045, units.LENGTH, "")
    assert read_quantity("inf", units.ANGLE, units.LENGTH).dimension is None
    with pytest.raises(UnitError, match=re.escape("angle [rad] or length [m]")):
        read_quantity("45 kg", units.ANGLE, units.LENGTH)


@pytest.mark.parametrize(
    ("text", "outcome"),
    [
        ("1e99999999 mm", math.inf),
        ("1e-99999999 mm", 0.0),
        ("9" * 99 + "e99", "expected a length"),
        ("1 " + "mm*" * 33, "expected a length"),
    ],
)
def test_hostile_numbers_take_no_time(text: str, outcome: float | str) -> None:
    """Huge exponents and long products are read or rejected in no time."""
    if isinstance(outcome, str):
        assert outcome in refusal(text, units.LENGTH)
    else:
        assert read_quantity(text, units.LENGTH).value == outcome
