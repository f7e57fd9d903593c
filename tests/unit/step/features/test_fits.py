"""One rule for shafts in bores: `check` and `init` agree."""

import numpy as np
import pytest

from stepbot.robot.joint_table import Basis
from stepbot.step.features.axis_contacts import Spans, fits, meeting
from tests.assembled import inferred, part
from tests.solids import cylinder

CASES = [
    (5.05, 5.0, 0.1, False),  # hardly engaged
    (5.05, 5.0, 0.3, True),
    (0.5, 0.6, 2.0, False),  # a fifth too thick
    (10.0, 10.1, 5.0, True),  # pressed in
    (10.0, 9.6, 5.0, True),
    (10.0, 9.0, 5.0, False),  # too loose
]
"""Radii of bore and shaft, engaged length [mm], and whether the shaft fits."""


@pytest.mark.parametrize(("bore", "shaft", "engaged", "expected"), CASES)
def test_check_and_init_agree(bore: float, shaft: float, engaged: float, expected: bool) -> None:
    """The rule, what `check` says of the faces on a line, and the contacts that `init` collects."""
    assert bool(fits(bore * 1e-3, shaft * 1e-3, engaged * 1e-3)) is expected
    one = Spans(np.array([0.0]), np.array([0.01]), np.array([bore * 1e-3]), np.array([True]))
    two = Spans(np.array([0.01 - engaged * 1e-3]), np.array([0.03]), np.array([shaft * 1e-3]), np.array([False]))
    assert (meeting(one, two).basis is Basis.FIT) is expected
    ring = part("ring", cylinder(30, 10) - cylinder(bore, 10))
    found = inferred(ring, part("rod", cylinder(shaft, 20).at(0, 0, 10 - engaged)))
    assert any(fit.shaft >= 0 for pair in found.survey.contacts.fits.values() for fit in pair) is expected
