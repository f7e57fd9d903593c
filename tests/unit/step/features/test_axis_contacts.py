"""Contact of faces of two sides on a line, which determines whether it can be a joint."""

import numpy as np
import pytest

from stepbot.robot.joint_table import Basis
from stepbot.step.features.axis_contacts import Spans, meeting

MM = 1e-3
Face = tuple[str, float, float, float]
"""Bore or shaft, radius, start and end [mm]."""


def _spans(*faces: Face) -> Spans:
    kinds, radii, low, high = zip(*faces, strict=True)
    bores = np.array([kind == "bore" for kind in kinds])
    return Spans(np.array(low) * MM, np.array(high) * MM, np.array(radii) * MM, bores)


@pytest.mark.parametrize(
    ("a", "b", "basis", "overlap"),
    [
        (("shaft", 4, 0, 30), ("bore", 4.1, 10, 20), Basis.FIT, 10),
        (("bore", 4.1, 10, 20), ("shaft", 4, 0, 30), Basis.FIT, 10),
        (("shaft", 4, 0, 30), ("bore", 4.24, 10, 20), Basis.FIT, 10),  # 6 % of the bore is 0.2544 mm
        (("shaft", 4, 0, 30), ("bore", 4.26, 10, 20), Basis.TOUCH, 10),
        (("shaft", 0.1, 0, 3), ("bore", 0.109, 0, 3), Basis.FIT, 3),  # 0.01 mm of slack is always allowed
        (("shaft", 40, 0, 30), ("bore", 40.49, 10, 20), Basis.FIT, 10),
        (("shaft", 40, 0, 30), ("bore", 40.51, 10, 20), Basis.TOUCH, 10),
        (("shaft", 10.14, 0, 30), ("bore", 10, 10, 20), Basis.FIT, 10),  # a press fit
        (("shaft", 10.16, 0, 30), ("bore", 10, 10, 20), Basis.TOUCH, 10),
        (("shaft", 4, 0, 10), ("bore", 4, 10, 20), Basis.TOUCH, 0),  # not engaged
        (("bore", 4, 0, 10), ("bore", 4, 10, 20), Basis.FLANGE, 0),
        (("bore", 4, 0, 10), ("bore", 4, 10.9, 20), Basis.FLANGE, -0.9),  # chamfered edges
        (("bore", 4, 0, 10), ("bore", 4, 11.6, 20), Basis.APART, -1.6),
        (("bore", 4, 0, 10), ("bore", 4.02, 10, 20), Basis.TOUCH, 0),
        (("shaft", 4, 0, 10), ("shaft", 4, 10, 20), Basis.TOUCH, 0),
        (("bore", 4, 0, 10), ("bore", 4, 238, 250), Basis.APART, -228),
    ],
)
def test_two_faces(a: Face, b: Face, basis: Basis, overlap: float) -> None:
    """Radii that fit and overlap are a fit; equal bores face to face are a flange."""
    met = meeting(_spans(a), _spans(b))
    assert met.basis is basis
    assert met.overlap == pytest.approx(overlap * MM, abs=1e-12)


def test_the_strongest_pair_counts() -> None:
    """Of many faces the best fit decides, of several fits the widest."""
    a = _spans(("shaft", 30, 0, 5), ("shaft", 4, 5, 25), ("shaft", 6, 25, 30))
    b = _spans(("bore", 35, 0, 5), ("bore", 4.05, 10, 20), ("bore", 6.05, 28, 40))
    met = meeting(a, b)
    assert (met.basis, met.rows) == (Basis.FIT, (2, 2))
    assert met.overlap == pytest.approx(2 * MM)


def test_of_faces_apart_the_nearest_tell() -> None:
    """The reported gap is the smallest one."""
    met = meeting(_spans(("bore", 9, -50, 0), ("bore", 2, 0, 3)), _spans(("bore", 9, 300, 310), ("bore", 2, 20, 30)))
    assert (met.basis, met.rows) == (Basis.APART, (1, 1))
    assert met.overlap == pytest.approx(-17 * MM)


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines with many faces are compared in blocks with the same result."""
    random = np.random.default_rng(3)
    low = random.uniform(0, 1, (2, 60))
    sides = [Spans(z, z + 0.004, random.uniform(0.001, 0.02, 60), random.random(60) < 0.5) for z in low]
    whole = meeting(*sides)
    monkeypatch.setattr("stepbot.step.features.axis_contacts._PAIRS_AT_ONCE", 130)
    assert meeting(*sides) == whole
