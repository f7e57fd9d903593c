"""Circles and centres of symmetry of outlines, in closed form."""

from math import cos, pi, sin

import numpy as np
import pytest

from stepbot.draft.contacts.concentric import fitted_circle, symmetric_outline
from stepbot.geometry.spatial import Array, rotation_from_rpy

NORMAL = rotation_from_rpy((0.4, -0.2, 1.0)) @ np.array([0.0, 0.0, 1.0])


def placed(flat: list[tuple[float, float]]) -> Array:
    """Points of a plane in space [m]."""
    points = np.array([(x, y, 0.0) for x, y in flat])
    return np.asarray(points @ rotation_from_rpy((0.4, -0.2, 1.0)).T + (0.1, 0.2, 0.3))


def arc(count: int, angle: float, radius: float = 0.02) -> list[tuple[float, float]]:
    """Points on an arc about the origin."""
    return [(radius * cos(angle * k / count), radius * sin(angle * k / count)) for k in range(count)]


@pytest.mark.parametrize("angle", [2.0 * pi, 1.2 * pi])
def test_centre_and_radius_of_an_arc(angle: float) -> None:
    """More than half of a circle has its centre and its radius."""
    circle = fitted_circle(placed(arc(24, angle)), NORMAL, 1e-6)
    assert circle is not None
    assert circle[0] == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)
    assert circle[1] == pytest.approx(0.02)


def test_no_circle_through_less_than_half_or_through_an_ellipse() -> None:
    """A short arc, an ellipse and a polygon of few corners are no circles."""
    ellipse = [(1.01 * x, y) for x, y in arc(24, 2.0 * pi)]
    for flat in (arc(24, 0.9 * pi), ellipse, arc(8, 2.0 * pi)):
        assert fitted_circle(placed(flat), NORMAL, 1e-6) is None


def test_rectangle_has_a_centre() -> None:
    """A rectangle of 40 x 30 mm is symmetric about its middle, 15 mm from its longer sides."""
    outline = symmetric_outline(placed([(0.02, 0.015), (-0.02, 0.015), (-0.02, -0.015), (0.02, -0.015)]))
    assert outline is not None
    assert outline[0] == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)
    assert outline[1] == pytest.approx(0.015)


def test_trapezoid_and_triangle_have_none() -> None:
    """A trapezoid and a triangle are not symmetric about a point."""
    for flat in ([(0.02, 0.01), (-0.02, 0.01), (-0.03, -0.01), (0.03, -0.01)], [(0, 0), (0.01, 0), (0, 0.01)]):
        assert symmetric_outline(placed(flat)) is None
