"""Bounds on inertia and centre of mass, against bodies that reach them and bodies within them, in closed form."""

from collections.abc import Sequence
from math import inf

import numpy as np
import pytest

from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.inertial_doubts import largest_moments, outside_by, smallest_trace, spread_excess

CUBE = np.array([[x, y, z] for x in (-0.3, 0.3) for y in (-0.2, 0.2) for z in (-0.1, 0.1)])
"""Corners [m] of a box of 0.6 x 0.4 x 0.2."""
TURNED = Pose.from_xyz_rpy((0.4, -0.7, 1.1), (0.3, -1.1, 2.0))


def _points(masses: Sequence[float], places: Array) -> MassProperties:
    """Point masses [kg] at places (n, 3) [m]."""
    return combined(MassProperties.of(m, p, np.zeros((3, 3))) for m, p in zip(masses, places.tolist(), strict=True))


def _scaled_inertia(body: MassProperties, factor: float) -> MassProperties:
    return MassProperties.of(body.mass, body.com, factor * np.array(body.inertia))


@pytest.mark.parametrize("pose", [Pose(), TURNED], ids=["aligned", "turned"])
@pytest.mark.parametrize("share", [0.5, 0.1])
def test_dumbbell_at_the_ends_reaches_the_bound(share: float, pose: Pose) -> None:
    """Two point masses at the ends of a segment reach the bound; 5 % more inertia exceeds it."""
    ends = pose.apply([[0.0, 0.0, -0.25], [0.0, 0.0, 0.25]])
    body = _points([2.0 * share, 2.0 * (1.0 - share)], ends)
    assert spread_excess(ends, body) is None
    excess = spread_excess(ends, _scaled_inertia(body, 1.05))
    assert excess is not None
    variance = share * (1.0 - share) * 0.5**2
    assert excess.largest == pytest.approx(variance**0.5)
    assert excess.given == pytest.approx((1.05 * variance) ** 0.5)
    np.testing.assert_allclose(np.abs(excess.direction), np.abs(pose.turn([0.0, 0.0, 1.0])), atol=1e-9)


def test_masses_in_the_corners_of_a_box_reach_all_three_bounds() -> None:
    """Point masses in the corners have exactly the largest moments, also with an uneven distribution."""
    weights = np.array([p * q * r for p in (0.2, 0.8) for q in (0.7, 0.3) for r in (0.5, 0.5)])
    body = _points((3.0 * weights).tolist(), CUBE)
    np.testing.assert_allclose(largest_moments(CUBE, body), np.diag(body.inertia), rtol=1e-12)
    assert spread_excess(CUBE, body) is None
    assert spread_excess(CUBE, _scaled_inertia(body, 1.05)) is not None


@pytest.mark.parametrize("pose", [Pose(), TURNED], ids=["aligned", "turned"])
def test_bodies_within_their_geometry_are_within_the_bounds(pose: Pose) -> None:
    """A rod, a shell, a plate and a hoop are possible within their own bounding points, wherever they are."""
    m, length, radius = 2.0, 0.8, 0.3
    angles = np.linspace(0.0, 2 * np.pi, 64, endpoint=False)
    ring = radius * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    golden = np.arange(500) * np.pi * (3 - 5**0.5)
    height = np.linspace(-1, 1, 500)
    flat = (1 - height**2) ** 0.5
    sphere = radius * np.column_stack([flat * np.cos(golden), flat * np.sin(golden), height])
    bodies = {
        "rod": (np.array([[0, 0, -length / 2], [0, 0, length / 2]]), m * length**2 / 12 * np.diag([1, 1, 0])),
        "shell": (sphere, 2 / 3 * m * radius**2 * np.eye(3)),
        "hoop": (ring, m * radius**2 * np.diag([0.5, 0.5, 1])),
        "plate": (CUBE * [1, 1, 0], m / 12 * np.diag([0.4**2, 0.6**2, 0.4**2 + 0.6**2])),
    }
    for name, (points, inertia) in bodies.items():
        body = MassProperties.of(m, (0, 0, 0), inertia).moved(pose)
        placed = pose.apply(points)
        assert spread_excess(placed, body) is None, name
        assert outside_by(placed, body.com) < 1e-12, name


def test_inertia_about_the_joint_instead_of_the_centre_is_found() -> None:
    """The inertia of a rod about its end is four times that about its centre: three times the mass has to be there."""
    m, length = 1.0, 0.5
    ends = np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]])
    about_end = MassProperties.of(m, (length / 2, 0, 0), m * length**2 / 3 * np.diag([0, 1, 1]))
    excess = spread_excess(ends, about_end)
    assert excess is not None
    assert (excess.given, excess.largest) == pytest.approx((length / 3**0.5, length / 2))


def test_moments_within_their_bounds_with_an_impossible_spread() -> None:
    """A plate in the xy plane whose ixx + iyy exceeds izz has mass outside the plane, though no moment is too large."""
    plate = CUBE * [1, 1, 0]
    body = MassProperties.of(1.0, (0, 0, 0), np.diag([0.02, 0.02, 0.02]))
    assert np.all(np.diag(body.inertia) < largest_moments(plate, body))
    excess = spread_excess(plate, body)
    assert excess is not None
    assert excess.direction == (0.0, 0.0, 1.0)
    assert (excess.given, excess.largest) == pytest.approx((0.1, 0.0))


def test_a_principal_axis_oblique_to_the_link_is_checked() -> None:
    """A dumbbell along the diagonal of a bar that lies along the other diagonal is found."""
    bar = np.array([[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]])
    body = _points([0.5, 0.5], np.array([[0.9, -0.9, 0.0], [-0.9, 0.9, 0.0]]))
    excess = spread_excess(bar, body)
    assert excess is not None
    np.testing.assert_allclose(np.abs(excess.direction), [0.5**0.5, 0.5**0.5, 0.0], atol=1e-12)


def test_distance_of_a_centre_from_the_hull() -> None:
    """A centre inside or on the surface is not outside; one outside has its distance from the next face or edge."""
    assert outside_by(CUBE, (0.3, 0.2, -0.1)) < 1e-12
    assert outside_by(CUBE, (0.0, 0.0, 0.15)) == pytest.approx(0.05)
    tetrahedron = np.array([[0.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]])
    assert outside_by(tetrahedron, (0.5, 0.5, 0.5)) == pytest.approx(0.5 / 3**0.5)


def test_ball_of_osmium_reaches_the_lower_bound() -> None:
    """A ball of osmium has exactly the smallest trace."""
    radius = 0.05
    mass = 22_590 * 4 / 3 * np.pi * radius**3
    assert smallest_trace(mass) == pytest.approx(3 * 2 / 5 * mass * radius**2)


def test_next_to_no_mass_is_spread_without_end() -> None:
    """The quotient of inertia and mass overflows."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    light = MassProperties(1e-310, (0.5, 0.5, 0.5), ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    excess = spread_excess(points, light)
    assert excess is not None
    assert (excess.direction, excess.given) == ((1.0, 0.0, 0.0), inf)
