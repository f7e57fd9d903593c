"""How far a simulated loop may turn its following joints: by its own gaps, counted once."""

import pytest

from stepbot.engines import engines
from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Observation, ObservedClosure
from stepbot.verification.deviation import Deviations
from stepbot.verification.motion import compare_closures

DRIVEN_ANGLE = {one.name: one.driven_angle for one in engines() if one.driven_angle is not None}
SENSITIVITY, GAP = 20.0, 1e-3


def judged(engine: str, angle_error: float, gap: float) -> list[str]:
    """What fails if a loop closes up to a gap [m] and its joints are off by an angle [rad]."""
    ours = ObservedClosure("loop", "revolute", "a", "b", sensitivity=SENSITIVITY)
    found = ObservedClosure("loop", "revolute", "a", "b", angle_error=angle_error, residual=gap)
    deviations = Deviations(Tolerance(1e-2))
    observations = (Observation(name, "1", "mjcf", closures=(one,)) for name, one in (("ours", ours), (engine, found)))
    compare_closures(deviations, *observations)
    return [failure.where for failure in deviations.failures]


@pytest.mark.parametrize("engine", sorted(DRIVEN_ANGLE))
@pytest.mark.parametrize("gap", [0.0, GAP])
def test_gap_turns_joints_as_far_as_the_loop_lets_it(engine: str, gap: float) -> None:
    """The allowed angle is that of the engine plus the gap times the motion per gap, and no more."""
    allowed = DRIVEN_ANGLE[engine] + gap * SENSITIVITY
    assert judged(engine, 0.99 * allowed, gap) == []
    assert judged(engine, 1.01 * allowed, gap) == ["following joints of closure 'loop'"]
