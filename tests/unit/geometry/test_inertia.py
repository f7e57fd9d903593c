"""Numeric residue in computed mass properties."""

import numpy as np
import pytest

from stepbot.geometry.inertia import MassProperties, combined, without_residue
from stepbot.geometry.spatial import Pose


def _body(com: tuple[float, float, float], products: tuple[float, float, float], size: float = 1.0) -> MassProperties:
    """A body of 2 kg with radii of gyration of about ``size`` [m], whose ixy, ixz, iyz are shares of its moments."""
    xy, xz, yz = products
    inertia = 2.0 * size**2 * np.array([[1.0, xy, xz], [xy, 1.0, yz], [xz, yz, 1.0]])
    return MassProperties.of(2.0, [size * c for c in com], inertia)


@pytest.mark.parametrize("size", [1e-4, 1.0, 100.0])
def test_residue_is_relative_to_the_size_of_the_body(size: float) -> None:
    """Components below 1e-8 of the body's size become 0, larger ones are unchanged, whatever the unit."""
    body = _body((3e-9, -2e-8, 0.5), (-9e-9, 3e-8, 0.1), size)
    clean = without_residue(body)
    assert clean.com == (0.0, body.com[1], body.com[2])
    expected = np.array(body.inertia)
    expected[0, 1] = expected[1, 0] = 0.0
    assert np.array_equal(clean.inertia, expected)
    assert clean.mass == body.mass


def test_products_of_a_slender_body_are_compared_with_its_small_moment() -> None:
    """A rod of aspect 10,000 that is turned by a microradian keeps its product of inertia."""
    rod = MassProperties.of(1.0, (0, 0, 0), np.diag([1e-8, 1.0, 1.0]))
    turned = rod.moved(Pose.from_xyz_rpy((0, 0, 0), (0, 0, 1e-6)))
    assert without_residue(turned) == turned


def test_a_symmetric_arrangement_has_no_products() -> None:
    """Eight equal bodies around an axis have their com on it and no products of inertia, exactly."""
    one = MassProperties.of(0.3, (0.2, 0.01, -0.1), np.diag([1e-3, 2e-3, 2.5e-3]))
    about = [one.moved(Pose.from_xyz_rpy((0, 0, 0), (0, 0, k * np.pi / 4))) for k in range(8)]
    clean = without_residue(combined(about))
    assert clean.com[:2] == (0.0, 0.0)
    assert np.count_nonzero(clean.inertia) == 3


def test_massless_and_impossible_bodies_are_unchanged() -> None:
    """Nothing is rounded without a positive mass and positive moments."""
    for body in (MassProperties(), MassProperties.of(1.0, (1e-20, 0, 0), np.zeros((3, 3)))):
        assert without_residue(body) == body
