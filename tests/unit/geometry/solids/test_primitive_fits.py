"""Which primitive is fitted where several are as good."""

from math import pi

import numpy as np
import pytest

from stepbot.geometry.primitives import Cylinder
from stepbot.geometry.solids.primitive_fits import PrimitiveFits, RoundFace


@pytest.mark.parametrize("shortfall", [0.0, 1e-9, 2e-7])
def test_radius_of_the_face_wins_over_a_rounding(shortfall: float) -> None:
    """A cylinder gets the radius of its face, although vertices on a grid lie in a slightly smaller one."""
    radius, length, angles = 0.02, 0.05, np.linspace(0.0, 2.0 * pi, 64, endpoint=False)
    ring = (radius - shortfall) * np.column_stack([np.cos(angles), np.sin(angles)])
    points = np.vstack([np.column_stack([ring, np.full(64, z)]) for z in (0.0, length)])
    fits = PrimitiveFits(np.eye(3), [RoundFace(np.zeros(3), np.array([0.0, 0.0, 1.0]), radius)])
    found = fits.best(points, pi * radius**2 * length * 0.99, 0.5)
    assert found is not None
    assert found.shape == Cylinder(radius, length)
