"""Scalars of the sidecar: accepted values, results, error messages."""

import copy
import math
import pickle
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError

from stepbot.sidecar import quantities
from stepbot.sidecar.quantities import JointValue, ToleranceValue
from stepbot.sidecar.units import ANGLE, FORCE, LENGTH


def value_of(kind: Any, value: Any) -> Any:
    """The result of a value."""
    return TypeAdapter(kind).validate_python(value)


def refusal_of(kind: Any, value: Any) -> tuple[str, str]:
    """Code and message of the only error of a value."""
    with pytest.raises(ValidationError) as caught:
        value_of(kind, value)
    (error,) = caught.value.errors()
    return error["type"], error["msg"]


@pytest.mark.parametrize(
    ("kind", "value", "result"),
    [
        (quantities.Length, "12 mm", 0.012),
        (quantities.Length, 2, 2.0),
        (quantities.Mass, "57.2 g", 0.0572),
        (quantities.Density, "1.04 g/cm^3", 1040.0),
        (quantities.Inertia, -1e-5, -1e-5),
        (quantities.LengthVector, [0, "-40 mm", "1 in"], (0.0, -0.04, 0.0254)),
        (quantities.RotationVector, [0, "90 deg", "0.5 rev"], (0.0, math.pi / 2, math.pi)),
        (quantities.AxisVector, "-y", (0.0, -1.0, 0.0)),
        (quantities.AxisVector, [0, 3, 4], (0.0, 0.6, 0.8)),
        (quantities.Color, "#ff000080", (1.0, 0.0, 0.0, 128 / 255)),
        (quantities.Color, "#0F0", (0.0, 1.0, 0.0, 1.0)),
        (quantities.Color, [0, 0.5, 1], (0.0, 0.5, 1.0, 1.0)),
        (quantities.RelativeOrLength, "0.2 %", ToleranceValue(0.002, 0.0)),
        (quantities.RelativeOrLength, "0.1 mm", ToleranceValue(0.0, 0.0001)),
        (quantities.RelativeOrLength, 0.001, ToleranceValue(0.0, 0.001)),
        (quantities.RelativeOrLength, "1e-4 mm", ToleranceValue(0.0, 1e-7)),
        (quantities.JointBound, "-inf", -math.inf),
        (quantities.JointBound, math.inf, math.inf),
        (quantities.JointEffort, "20 N", 20.0),
        (quantities.Gear, -1, -1.0),
        (quantities.Gear, "36 deg/mm", 200.0 * math.pi),
    ],
)
def test_value(kind: Any, value: Any, result: Any) -> None:
    """Each form of a scalar becomes one number, or several, in SI."""
    assert value_of(kind, value) == result


@pytest.mark.parametrize(
    ("kind", "value", "code", "message"),
    [
        (quantities.Length, True, "SB122", "not true"),
        (quantities.Length, [1], "SB122", "not a list"),
        (quantities.Length, {}, "SB122", "not a mapping"),
        (quantities.Length, 0, "SB125", "greater than 0"),
        (quantities.Length, "3 kg", "SB124", "expected length [m]"),
        (quantities.Length, math.nan, "SB125", "NaN"),
        (quantities.Length, math.inf, "SB125", "not finite"),
        pytest.param(quantities.Length, -(10**400), "SB125", "-inf is not finite", id="huge"),
        (quantities.Length, "2e9 mm", "SB125", "2e+06 m exceeds the maximum of 1e+06 m"),
        (quantities.LengthVector, [0, -1e300, 0], "SB125", "-1e+300 m exceeds the maximum of 1e+06 m"),
        (quantities.Mass, 1e39, "SB125", "exceeds the maximum of 1e+30 kg"),
        (quantities.JointEffort, 1e39, "SB125", "exceeds the maximum of 1e+30"),
        (quantities.DistanceRange, [0, 1e9], "SB125", "exceeds the maximum of 1e+06 m"),
        (quantities.Mass, "-3 g", "SB125", "-0.003 kg is out of range: mass must be greater than 0"),
        (quantities.Angle, 15, "SB125", "exceeds the maximum of 3.14159 rad"),
        (quantities.LengthVector, [0, 0], "SB122", "expected three values [x, y, z], not 2"),
        (quantities.LengthVector, "0 0 0", "SB122", "expected three values"),
        (quantities.LengthVector, [0, 0, "1 deg"], "SB124", "expected length [m]"),
        (quantities.SizeVector, [1, 1, 0], "SB125", "greater than 0"),
        (quantities.AxisVector, [0, 0, 0], "SB125", "zero length"),
        (quantities.AxisVector, "up", "SB123", "invalid axis 'up'"),
        (quantities.AxisVector, [1, 0], "SB122", "three values"),
        (quantities.Color, "red", "SB123", "invalid colour 'red'"),
        (quantities.Color, [0, 0, 2], "SB125", "exceeds the maximum of 1"),
        (quantities.Color, [0, 0], "SB122", "not a list"),
        (quantities.JointBound, "fast", "SB124", "invalid quantity 'fast': expected an angle or length"),
        (quantities.JointPosition, "inf", "SB125", "not finite"),
        (quantities.JointEffort, -1, "SB125", "greater than 0"),
        (quantities.JointEffort, "0 N", "SB125", "greater than 0"),
        (quantities.JointSpeed, 0, "SB125", "greater than 0"),
        (quantities.JointFriction, -1, "SB125", "at least 0"),
        (quantities.JointSpeed, "3 kg", "SB124", "angular speed [rad/s] or speed [m/s]"),
        (quantities.RelativeOrLength, "0 %", "SB125", "greater than 0"),
        (quantities.RelativeOrLength, "1e-9 mm", "SB125", "at least 1e-07"),
        (quantities.StepShare, 1.5, "SB125", "1.5 exceeds the maximum of 1"),
        (quantities.StepShare, 0, "SB125", "0 is out of range: ratio must be greater than 0"),
    ],
)
def test_refusal(kind: Any, value: Any, code: str, message: str) -> None:
    """An invalid scalar is rejected with the code and the reason."""
    found = refusal_of(kind, value)
    assert found[0] == code
    assert message in found[1]


def test_joint_values_remember_their_unit() -> None:
    """A joint's number is a float with the dimension of its unit, if it has one."""
    angle = value_of(quantities.JointBound, "90 deg")
    assert isinstance(angle, float)
    assert type(angle.value) is float
    assert angle.value == math.pi / 2
    assert angle.dimension == ANGLE
    assert value_of(quantities.JointBound, "3 mm").dimension == LENGTH
    assert value_of(quantities.JointBound, 3).dimension is None
    assert value_of(quantities.JointBound, "-inf").dimension is None
    assert value_of(quantities.JointEffort, "3 N").dimension == FORCE


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda v: pickle.loads(pickle.dumps(v))])
def test_joint_values_survive_copies(duplicate: Any) -> None:
    """Copies and pickles keep number and dimension."""
    made = duplicate(JointValue(1.5, ANGLE))
    assert (made, made.dimension) == (1.5, ANGLE)
