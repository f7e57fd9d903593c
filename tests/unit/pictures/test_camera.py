"""Where points are in a picture, against the closed form of a pinhole camera."""

from itertools import product
from math import cos, radians, sin

import numpy as np
import pytest

from stepbot.pictures.camera import MARGIN, TANGENT, VIEWS, View, camera_of

CUBE = np.array(list(product((-0.5, 0.5), repeat=3)))
WIDTH, HEIGHT = 400, 300
AXES = {
    "front": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "back": ((-1, 0, 0), (0, -1, 0), (0, 0, 1)),
    "left": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "right": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "top": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "bottom": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
}
"""Towards the camera, to the right, and up in the picture, of the views along an axis."""


@pytest.mark.parametrize("name", AXES)
def test_corners_of_a_cube_are_where_a_pinhole_camera_sees_them(name: str) -> None:
    """The camera stands where the near face fills the height less the margin; far corners are nearer to the middle."""
    toward, right, up = (np.array(axis, dtype=float) for axis in AXES[name])
    distance = 0.5 + MARGIN * 0.5 / TANGENT  # of the middle of the cube: the near face fills the height
    expected = []
    for corner in CUBE:
        scale = HEIGHT / 2 / TANGENT / (distance - corner @ toward)
        expected.append((WIDTH / 2 + scale * (corner @ right), HEIGHT / 2 - scale * (corner @ up)))
    camera = camera_of(CUBE, VIEWS[name], WIDTH, HEIGHT)
    np.testing.assert_allclose(camera.project(CUBE), expected, atol=1e-9)


def test_the_isometric_view_foreshortens_the_axes_equally() -> None:
    """Unit vectors along the edges of the near corner have projections of equal length, 120 degrees apart."""
    far = 1e-6 * np.diag((1.0, -1.0, 1.0))
    camera = camera_of(CUBE, VIEWS["iso"], WIDTH, HEIGHT)
    middle = camera.project(np.zeros(3))
    arms = camera.project(far) - middle
    np.testing.assert_allclose(np.linalg.norm(arms, axis=1), np.linalg.norm(arms[0]), rtol=1e-5)
    cosines = [arms[i] @ arms[j] / (np.linalg.norm(arms[i]) * np.linalg.norm(arms[j])) for i, j in ((0, 1), (1, 2))]
    np.testing.assert_allclose(cosines, -0.5, atol=1e-5)


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (35, 20), (-130, 60), (180, -30), (77, 90)])
def test_the_camera_is_in_the_given_direction(azimuth: float, elevation: float) -> None:
    """From the front, +x, clockwise from above, then up; all of the scene is in the picture, up to the margin."""
    camera = camera_of(CUBE, View(azimuth, elevation), WIDTH, HEIGHT)
    a, e = radians(azimuth), radians(elevation)
    toward = camera.position - camera.target
    np.testing.assert_allclose(toward / np.linalg.norm(toward), (cos(a) * cos(e), -sin(a) * cos(e), sin(e)), atol=1e-12)
    x, y = camera.project(CUBE).T
    reach = max(np.abs(2 * x / WIDTH - 1).max(), np.abs(2 * y / HEIGHT - 1).max())
    assert reach == pytest.approx(1 / MARGIN, rel=1e-9)


def test_a_direction_through_a_pixel_meets_the_point_that_is_projected_there() -> None:
    """Rays and projection are inverse to each other."""
    camera = camera_of(CUBE, View(20.0, 10.0), WIDTH, HEIGHT)
    directions = camera.directions(100, 102, np.array((0.25, 0.75)))
    points = camera.position + 3.0 * directions[:: WIDTH // 2]
    expected = [(0.25, 100.75), (200.25, 100.75), (0.25, 101.75), (200.25, 101.75)]
    np.testing.assert_allclose(camera.project(points), expected, atol=1e-9)
