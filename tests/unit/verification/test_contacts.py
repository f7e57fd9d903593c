"""Links that overlap in one pose after the other: depths and points with a closed form."""

from math import cos, sin

import pytest

from stepbot.robot.model import Box, Sphere
from stepbot.verification.self_collision.worker import ContactSearch

from .test_self_collision import box, robot


@pytest.mark.parametrize("angle", [0.0, 1.2, -2.5])
def test_spheres_overlap_between_their_centres(angle: float) -> None:
    """Two spheres of 0.5 m, 0.9 m apart: 0.1 m deep, halfway between, in the frame of the first."""
    search = ContactSearch(robot(Sphere(0.5), Sphere(0.5), 0.9))
    try:
        (one,) = search.at({"one": angle, "two": 0.3}, 60.0)
    finally:
        search.close()
    assert (one.link_a, one.link_b) == ("a", "b")
    assert one.depth == pytest.approx(0.1, abs=1e-6)
    assert one.point == pytest.approx((0.45 * cos(angle), 0.45 * sin(angle), 0.0), abs=1e-6)


def test_each_pose_has_its_own_links() -> None:
    """A process keeps its robot: a bar that turns meets the ball in one pose and not in the next."""
    search = ContactSearch(robot(Box((0.4, 0.4, 0.4)), box(1.0, at=(0.0, 0.6, 0.0)), 0.5))
    try:
        assert search.at({"one": 0.0, "two": 0.0}, 60.0) == search.at({"one": 0.0, "two": 0.0}, 60.0) != ()
        assert search.at({"one": 0.0, "two": -1.5708}, 60.0) == ()
        (again,) = search.at({"one": 0.0, "two": 0.0}, 60.0)
    finally:
        search.close()
    # The box ends at x = 0.2 and y = 0.2; the bar begins at x = 0.0 and y = 0.1.
    assert again.depth == pytest.approx(0.1, abs=1e-6)
    assert again.point is not None
    assert again.point[1] == pytest.approx(0.15, abs=0.051)


def test_a_shape_inside_a_surface_has_no_depth_and_no_point() -> None:
    """A small ball inside a cube with a dent: the surfaces do not touch, but the links overlap."""
    hollow = box(3.0)
    dented = type(hollow).of([*hollow.vertices[:-1], hollow.vertices[-1] * 0.5], hollow.faces)
    search = ContactSearch(robot(dented, Sphere(0.1), 0.0))
    try:
        (one,) = search.at({"one": 0.0, "two": 0.0}, 60.0)
    finally:
        search.close()
    assert (one.depth, one.point) == (None, None)
