"""Rows of differences of two robots, from what was compared."""

from math import inf, nan

import pytest
from msgspec.structs import asdict

from stepbot.engines.observation import Quantity
from stepbot.report.document import indented
from stepbot.revisions.differences import robot_differences
from stepbot.verification.compare import QuantityComparison
from stepbot.verification.deviation import Deviation, Deviations, tolerance


@pytest.mark.parametrize("distance", [0.25, inf, nan])
@pytest.mark.parametrize("angle", [0.5, inf, nan])
def test_poses_without_a_finite_difference(distance: float, angle: float) -> None:
    """A distance and an angle are one difference if both are finite; what is not has no amount, and all is JSON."""
    where = "link 'arm' at configuration 2"
    failures = [Deviation(distance, 1e-9, "m", where), Deviation(angle, 1e-9, "rad", where)]
    compared = QuantityComparison(Quantity.POSES, Deviations(tolerance(("mujoco",), Quantity.POSES), failures))
    rows = robot_differences([compared])
    amounts = {row.amount for row in rows} | {row.angle for row in rows}
    assert amounts - {None} == {one for one in (distance, angle) if 0.0 < one < inf}
    assert all(where in row.name for row in rows)
    assert indented([asdict(row) for row in rows])
