"""Limits of drive tests: defaults, those of a robot, and files that are none."""

from typing import Any

import pytest

from stepbot.driving.limits import LIMITS, UNITS, InvalidLimits, demands
from stepbot.driving.plan import TESTS
from stepbot.engines.simulation import Cube


def test_every_limit_has_a_unit_and_a_reason() -> None:
    """Each limited quantity has a unit, each limit a reason, and each test has limits."""
    assert LIMITS.keys() == TESTS.keys()
    for bounds in LIMITS.values():
        for quantity, bound in bounds.items():
            assert quantity in UNITS
            assert bound.why
            assert bound.value > 0.0


def test_a_robot_changes_one_limit() -> None:
    """The other limits stay, and so do those of other tests."""
    own = demands({"limits": {"step": {"overshoot": [25, "an underdamped test rig"]}}, "tests": ["step"], "cube": 0.05})
    assert own.limits["step"]["overshoot"].value == 25.0
    assert own.limits["step"]["angle error"] == LIMITS["step"]["angle error"]
    assert own.limits["hold"] == LIMITS["hold"]
    assert (own.tests, own.mass) == (("step",), 0.05)


def test_objects_take_the_place_of_the_cube() -> None:
    """They have its mass."""
    sphere, cube = demands({"cube": 1.0, "objects": [["sphere", 0.05], ["cube", 0.08]]}).objects
    assert sphere == Cube(0.05, 1.0, "sphere")
    assert (str(sphere), str(cube)) == ("sphere of 50 mm", "cube of 80 mm")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([], "not an object"),
        ({"limit": {}}, "unknown key 'limit'"),
        ({"tests": ["jump"]}, "'tests' is not a list of"),
        ({"cube": -1}, "'cube' is not a mass"),
        ({"cube": True}, "'cube' is not a mass"),
        ({"objects": [["ball", 0.05]]}, "'objects' is not a list of"),
        ({"objects": "sphere"}, "'objects' is not a list of"),
        ({"limits": {"jump": {}}}, "no test 'jump'"),
        ({"limits": {"step": {"oversight": [1, "x"]}}}, "no quantity 'oversight'"),
        ({"limits": {"step": {"overshoot": 15}}}, 'expected \\[number, "reason"\\]'),
        ({"limits": {"step": {"overshoot": [15, " "]}}}, 'expected \\[number, "reason"\\]'),
        ({"limits": {"step": {"overshoot": [float("nan"), "x"]}}}, 'expected \\[number, "reason"\\]'),
    ],
)
def test_invalid_limits_are_rejected(content: Any, message: str) -> None:
    """A misspelt name or a limit without a reason is an error, never the default limit."""
    with pytest.raises(InvalidLimits, match=message):
        demands(content)
