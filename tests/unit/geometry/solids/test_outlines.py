"""Areas of regions by their outlines, against closed forms."""

import numpy as np
import pytest

from stepbot.geometry.solids.outlines import Region
from stepbot.geometry.spatial import Array


def rectangle(x: float, y: float, width: float, height: float) -> Array:
    """A clockwise rectangle by its lower left corner [m]; the orientation does not matter."""
    return np.array([[x, y], [x, y + height], [x + width, y + height], [x + width, y]])


def test_shared_area_of_a_plate_with_a_hole() -> None:
    """Half of a plate of 40 x 30 mm with a hole of 10 x 10 mm shares half of the plate and of the hole."""
    plate = Region([rectangle(0.0, 0.0, 0.04, 0.03), rectangle(0.015, 0.01, 0.01, 0.01)])
    shared = plate.shared(Region([rectangle(0.02, -0.01, 0.1, 0.1)]), 1e-9)
    assert plate.area == pytest.approx(1.1e-3, rel=1e-9)
    assert shared is not None
    assert shared.area == pytest.approx(0.55e-3, rel=1e-9)
    expected = (0.02 * 0.03 * np.array([0.03, 0.015]) - 0.005 * 0.01 * np.array([0.0225, 0.015])) / 0.55e-3
    assert shared.centroid == pytest.approx(expected, abs=1e-9)
    assert np.ptp(shared.hull, axis=0) == pytest.approx([0.02, 0.03], abs=1e-9)


def test_areas_that_share_too_little() -> None:
    """Neighbours with a common edge share nothing."""
    assert Region([rectangle(0.0, 0.0, 1.0, 1.0)]).shared(Region([rectangle(1.0, 0.0, 1.0, 1.0)]), 1e-9) is None
