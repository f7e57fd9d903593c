"""Whether a part's mass is symmetric about an axis, by closed forms of plates and cylinders."""

from math import cos, sin, sqrt

import numpy as np
import pytest

from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.parts import Part
from stepbot.geometry.spatial import Array, rotation_about
from tests.unit.assemble.workshop import cylinder_inertia

UP = np.array([0.0, 0.0, 1.0])


def body(inertia: Array, size: float = 0.1) -> Part:
    """A part about the origin with an inertia, and a diagonal [m]."""
    centred = np.array([[-size, -size, -size], [size, size, size]]) / (2.0 * sqrt(3.0))
    return Part(0, "body", "body", (), None, 0, 1e-4, size, centred, np.zeros(3), inertia)


@pytest.mark.parametrize(("share", "balanced"), [(1.0, True), (0.98, True), (0.965, False), (0.5, False)])
def test_a_plate_is_balanced_if_it_is_nearly_square(share: float, *, balanced: bool) -> None:
    """A thin plate of a x b has moments m b^2 / 12 and m a^2 / 12 across its normal: within 3 % of each other."""
    plate = body(np.diag([share, 1.0, 1.0 + share]))  # b^2 = share a^2
    assert plate.is_balanced(Axis(np.zeros(3), UP)) == balanced


@pytest.mark.parametrize(("angle", "balanced"), [(0.0, True), (0.035, True), (0.045, False), (0.5, False)])
def test_a_rod_is_balanced_about_its_own_axis(angle: float, *, balanced: bool) -> None:
    """Tilted by t, a thin rod has a product of inertia of I sin t cos t across the axis, of a trace of 2 I."""
    assert (sin(angle) * cos(angle) / 2.0 < 0.02) == balanced
    rod, R = cylinder_inertia(1e-4, 0.1), rotation_about((1.0, 0.0, 0.0), angle)
    assert body(R @ rod @ R.T).is_balanced(Axis(np.zeros(3), UP)) == balanced


@pytest.mark.parametrize(("offset", "within", "balanced"), [(0.9, 1.0, True), (1.1, 1.0, False), (1.1, 2.0, True)])
def test_the_centroid_of_a_balanced_part_is_on_the_axis(offset: float, within: float, *, balanced: bool) -> None:
    """Up to a hundredth of its size."""
    wheel = body(cylinder_inertia(0.05, 0.01))
    axis = Axis(np.array([offset * 0.01 * wheel.size, 0.0, 0.03]), UP)
    assert wheel.is_balanced(axis, within) == balanced
