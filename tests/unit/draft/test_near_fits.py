"""Faces that are only nearly coaxial: parts placed by hand beside a motor."""

from typing import Any

import numpy as np
import pytest

from stepbot.draft.contacts import near_fits
from stepbot.draft.contacts.near_fits import ANGLE, OFFSET, NearFit, _between
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.geometry.spatial import Pose
from tests.assembled import Node, assembled, inferred, joints, part
from tests.solids import box, cylinder

SERVO = box(40, 20, 30).at(0, 0, -15) + cylinder(3, 5).at(10, 0, 0)
"""A case below z = 0 [mm] with its output at (10, 0), and two holes in its bottom."""
for x in (-16, 16):
    SERVO -= cylinder(1.5, 8).at(x, 0, -30)
BASE = box(60, 30, 6) - cylinder(1.6, 6).at(-16, 0, -3) - cylinder(1.6, 6).at(16, 0, -3)
ARM = box(100, 12, 4).at(40, 0, 0) - cylinder(3.1, 4).at(0, 0, -2)


def placed_by_hand(off: float, tilt: float = 0.0) -> list[Node]:
    """A servo above its base and an arm on its output, both off by so much [mm], the arm tilted [rad]; none touches."""
    return [
        part("base", BASE, off, 0, -33.2),
        part("SG90 servo", SERVO),
        part("arm", ARM, 10 + off, 0, 2.4, rpy=(tilt, 0, 0)),
    ]


@pytest.mark.parametrize("tilt", [0.0, 0.017])
def test_what_is_placed_by_hand_on_a_servo_turns_on_it(tilt: float) -> None:
    """An arm 0.3 mm off a servo's output is its joint, on the servo's own axis, marked; the base carries the servo."""
    found = inferred(*placed_by_hand(0.3, tilt))
    assert joints(found) == [("revolute", "SG90 servo", "arm")]
    (arc,) = found.arcs
    assert arc.evidence.review
    assert arc.evidence.axis.distance(np.array([0.01, 0.0, 0.0])) < 1e-9
    assert {found.survey.parts[i].path for i in found.links[found.root]} == {"base", "SG90 servo"}


def test_what_is_farther_off_is_no_joint() -> None:
    """From 0.6 mm on, nothing says that the arm belongs to the servo."""
    assert joints(inferred(*placed_by_hand(0.7))) == []


@pytest.mark.parametrize(("off", "tilt", "count"), [(0.0, 0.0, 0), (0.5, 0.0, 1), (0.7, 0.0, 0), (0.0, 0.019, 1)])
def test_near_fits_are_within_limits_and_not_exact(off: float, tilt: float, count: int) -> None:
    """A fit is near up to 0.6 mm and 1.2 degrees; an exact one is a contact and no near fit."""
    found = Survey(assembled(*placed_by_hand(off, tilt)[1:]), ALL_SOURCES).near_fits
    assert [len(fits) for fits in found.values()] == [count] * bool(count)
    assert all(fit.offset < OFFSET and fit.angle < ANGLE for fits in found.values() for fit in fits)


@pytest.mark.parametrize("copies", [2, 9])
def test_equal_groups_are_compared_once(copies: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """What does not fit in one group is not compared in its copies, turned or moved; what fits is found in each."""
    compared: list[bool] = []

    def between(*given: Any) -> list[NearFit]:
        found = _between(*given)
        compared.append(not found)
        return found

    monkeypatch.setattr(near_fits, "_between", between)
    parts = [*placed_by_hand(0.3), part("pin", cylinder(1, 4), 0, 11, -15)]
    groups = [
        Node(f"copy {n}", children=parts, X=Pose.from_xyz_rpy((0.3 * n, 0.1, 0.0), (0.1 * n, 0.0, 0.7 * n)))
        for n in range(copies)
    ]
    found = Survey(assembled(*groups), ALL_SOURCES).near_fits
    alone = Survey(assembled(*parts), ALL_SOURCES).near_fits
    assert len(found) == copies * len(alone) == copies * 2
    assert sum(compared) == 2, "the pin and the servo, in the copies and alone"
