"""Stand-ins for a missing mass, and numbers that only resemble them."""

from math import inf

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, Quantity
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.formats.lowering.masses import LEAST_MASS, LEAST_MOMENT, STAND_IN_MASS, STAND_IN_MOMENT
from stepbot.geometry.spatial import ZERO3, matrix3
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.model import Limit
from stepbot.verification.compare import compare
from stepbot.verification.normalized import normalized
from stepbot.verification.stand_ins import without_stand_ins

STAND_INS = [(STAND_IN_MASS, STAND_IN_MOMENT), (LEAST_MASS, LEAST_MOMENT)]


def seen(mass: float, moment: float | None) -> Observation:
    """A file with one link."""
    inertia = None if moment is None else matrix3(moment * np.eye(3))
    return Observation("mujoco", "1", "mjcf", links=(ObservedLink("dust", mass, ZERO3, inertia),))


@pytest.mark.parametrize("precision", [np.float32, np.float64])
@pytest.mark.parametrize(("mass", "moment"), STAND_INS)
def test_stand_ins_are_no_mass(mass: float, moment: float, precision: type[np.floating]) -> None:
    """A link with mass and moments of a stand-in is massless, also in single precision, or without known moments."""
    for one in (seen(float(precision(mass)), float(precision(moment))), seen(mass, None)):
        (link,) = without_stand_ins(one).links
        assert link.mass == 0.0


@pytest.mark.parametrize(("mass", "moment"), STAND_INS)
def test_other_inertia_of_the_same_mass_is_compared(mass: float, moment: float) -> None:
    """A link of another program that only has the mass of a stand-in keeps it: a different inertia is a difference."""
    pair = normalized(seen(mass, 5.0 * moment), seen(mass, 7.0 * moment))
    failed = {one.quantity for one in compare(*pair) if one.deviations.failures}
    assert failed == {Quantity.INERTIA}


def test_unreachable_limits_are_none() -> None:
    """Limits from 1e9 mean none, in each direction and for each joint of one body; lower ones stay as they are."""
    least = Limit(lower=-NO_BOUND, upper=NO_BOUND, velocity=UNLIMITED, effort=UNLIMITED)
    kept = Limit(lower=-0.999 * NO_BOUND, upper=0.999 * NO_BOUND, velocity=0.999 * UNLIMITED, effort=0.999 * UNLIMITED)
    step = ObservedJoint("x", "revolute", "base", "dust", limit=least)
    joints = (
        ObservedJoint("free", "ball", "base", "dust", limit=kept, steps=(step,)),
        ObservedJoint("a", "b", "c", "d"),
    )
    free, other = without_stand_ins(replace(seen(1.0, None), joints=joints)).joints
    assert free.limit == kept
    assert free.steps[0].limit == Limit(-inf, inf, inf, inf)
    assert other.limit is None


def test_a_link_with_the_moment_of_a_stand_in_keeps_it() -> None:
    """The moment alone shows no stand-in: 10 g with 1e-9 kg m^2 are not 10 g without inertia."""
    one = seen(0.01, 1e-9)
    (link,) = without_stand_ins(one).links
    assert np.array_equal(np.array(link.inertia), 1e-9 * np.eye(3))
