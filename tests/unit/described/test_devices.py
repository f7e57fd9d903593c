"""Ranges of actuators in an existing description."""

import pytest

from stepbot.described.devices import _symmetric
from stepbot.described.finding import Finding


@pytest.mark.parametrize(
    ("low", "high", "bound"), [(-3.0, 3.0, 3.0), (-1.0, 3.0, 1.0), (-3.0, 1.0, 1.0), (0.0, 3.0, 3.0), (-2.0, 0.0, 2.0)]
)
def test_narrower_side_of_a_range(low: float, high: float, bound: float) -> None:
    """The narrower side holds for both, unless it is 0; the finding has the same number."""
    found: list[Finding] = []
    assert _symmetric(low, high, "motor", found) == bound
    assert [f"not symmetric, {bound:g} taken" in one.text for one in found] == [True] * (-low != high)
