"""Stand-ins for a missing mass, and numbers that only resemble them."""

import numpy as np
import pytest

from stepbot.engines.observation import Observation, ObservedLink, Quantity
from stepbot.formats.lowering.masses import LEAST_MASS, LEAST_MOMENT, STAND_IN_MASS, STAND_IN_MOMENT
from stepbot.geometry.spatial import ZERO3, matrix3
from stepbot.verification.bounds import without_stand_ins
from stepbot.verification.compare import compare
from stepbot.verification.normalized import normalized

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
