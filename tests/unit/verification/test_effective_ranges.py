"""Ranges of actuators within the limits of their joints: forces at the joint are `gear` times those of the actuator."""

from math import inf, nan

import pytest

from stepbot.engines.observation import Observation, ObservedActuator, ObservedJoint
from stepbot.robot.model import ActuatorKind, Limit
from stepbot.verification.source import with_effective_ranges

WIDE = (-1e3, 1e3)
LIMIT = Limit(lower=-0.5, upper=2.0, velocity=3.0, effort=12.0)
Range = tuple[float, float] | None


def effective(
    kind: str, limit: Limit | None = LIMIT, gear: float | None = 1.0, control: Range = WIDE, force: Range = WIDE
) -> tuple[Range, Range]:
    """Effective ranges of the input and of the force of an actuator."""
    joint = ObservedJoint("elbow", "revolute", "base", "arm", limit=limit)
    actuator = ObservedActuator("motor", "elbow", kind, gear=gear, control=control, force=force)
    seen = Observation("test", "1", "mjcf", joints=(joint,), actuators=(actuator,))
    (found,) = with_effective_ranges(seen).actuators or ()
    return found.control, found.force


@pytest.mark.parametrize(
    ("kind", "control", "force"),
    [
        (ActuatorKind.MOTOR, (-3.0, 3.0), (-3.0, 3.0)),
        (ActuatorKind.POSITION, (-2.0, 8.0), (-3.0, 3.0)),
        (ActuatorKind.VELOCITY, (-12.0, 12.0), (-3.0, 3.0)),
        ("muscle", WIDE, WIDE),
    ],
)
def test_limits_of_the_joint_bound_each_kind(kind: str, control: Range, force: Range) -> None:
    """With a gear of 4, positions and speeds of the motor are four times the joint's, forces a quarter of them."""
    assert effective(kind, gear=4.0) == (control, force)


def test_narrower_ranges_stay() -> None:
    """A range within the limits is effective as it is; input and force of a motor bound each other."""
    assert effective(ActuatorKind.POSITION, control=(-0.1, 0.2), force=(-1.0, 2.0)) == ((-0.1, 0.2), (-1.0, 2.0))
    assert effective(ActuatorKind.MOTOR, control=(-5.0, 4.0), force=(-1.0, 20.0)) == ((-1.0, 4.0), (-1.0, 4.0))


def test_a_negative_gear_turns_the_range_of_positions() -> None:
    """With a gear of -2, a joint from -0.5 to 2 is a motor from -4 to 1."""
    assert effective(ActuatorKind.POSITION, gear=-2.0) == ((-4.0, 1.0), (-6.0, 6.0))
    assert effective(ActuatorKind.POSITION, gear=-2.0, limit=Limit(lower=nan, upper=2.0))[0] == (-4.0, 1e3)
    assert effective(ActuatorKind.VELOCITY, gear=-2.0)[0] == (-6.0, 6.0)


def test_unknown_values_bound_nothing() -> None:
    """Ranges that are not reported stay so; limits that an engine cannot express, and missing ones, are ignored."""
    assert effective(ActuatorKind.MOTOR, control=None, force=None) == (None, None)
    assert effective(ActuatorKind.MOTOR, limit=None) == (WIDE, WIDE)
    assert effective(ActuatorKind.POSITION, limit=Limit(lower=nan, upper=1.0, effort=inf)) == ((-1e3, 1.0), WIDE)
    assert effective(ActuatorKind.POSITION, limit=Limit(lower=-1.0, upper=nan)) == ((-1.0, 1e3), WIDE)
    assert effective(ActuatorKind.POSITION, gear=None) == ((-0.5, 2.0), (-12.0, 12.0))
    nothing = Observation("test", "1", "urdf")
    assert with_effective_ranges(nothing) is nothing


def test_joints_of_one_body_have_their_own_limits() -> None:
    """An actuator of a component joint is bounded by that joint."""
    hip = ObservedJoint(
        "hip", "ball", "base", "leg", steps=(ObservedJoint("hip_x", "revolute", "base", "leg", limit=LIMIT),)
    )
    motor = ObservedActuator("motor", "hip_x", ActuatorKind.POSITION, control=WIDE)
    (found,) = with_effective_ranges(Observation("t", "1", "mjcf", joints=(hip,), actuators=(motor,))).actuators or ()
    assert found.control == (-0.5, 2.0)
