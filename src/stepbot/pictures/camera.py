"""Where a picture is taken from, and where in it a point is.

Perspective through a long lens, as in catalogues. The camera stands level: the vertical of the world is vertical in the
picture, unless it looks straight up or down; then +x, the front of the robot, is at the bottom.
"""

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike

from stepbot.geometry.spatial import Array

TANGENT = 0.16
"""Tangent of half the angle of the picture's height."""
MARGIN = 1.12
"""The picture's size relative to the size of the scene in it, of its narrower side."""


class View(Struct, frozen=True):
    """The direction that a picture is taken from."""

    azimuth: float = 35.0
    """Degrees from the robot's front, which is +x, clockwise when seen from above."""
    elevation: float = 20.0
    """Degrees above the horizon."""
    zoom: float = 1.0
    """Above 1 the robot is larger."""
    floor: bool = True
    """Whether a floor is drawn at the lowest point; a gripper floats."""


VIEWS: Mapping[str, View] = {
    "corner": View(),
    "iso": View(45.0, 35.264389682754654),
    "front": View(0.0, 0.0),
    "left": View(-90.0, 0.0),
    "back": View(180.0, 0.0),
    "right": View(90.0, 0.0),
    "top": View(0.0, 90.0),
    "bottom": View(0.0, -90.0),
}
"""Views by name; the left is the robot's own, +y."""


class Camera(Struct, frozen=True, eq=False, dict=True):
    """A camera with a picture of a given size."""

    position: Array
    """[m]."""
    target: Array
    """[m]; in the middle of the picture."""
    right: Array
    """Unit vector, towards the right of the picture."""
    width: int
    """[px]."""
    height: int
    """[px]."""

    @cached_property
    def axes(self) -> tuple[Array, Array, Array]:
        """Unit vectors to the right, up, and forward."""
        forward = unit_vectors(self.target - self.position)
        return self.right, np.cross(self.right, forward), forward

    def directions(self, first: int, last: int, within: Array) -> Array:
        """Directions through one place within each pixel of the rows from ``first`` to ``last``.

        Args:
            first: The first row.
            last: The row after the last one.
            within: Place in the pixel, shape (2,), between 0 and 1.

        Returns:
            Unit vectors, shape ((last - first) * width, 3).
        """
        x = np.arange(self.width)[None, :] + within[0]
        y = np.arange(first, last)[:, None] + within[1]
        right, up, forward = self.axes
        u = (2 * x - self.width) / self.height * TANGENT
        v = (self.height - 2 * y) / self.height * TANGENT
        return unit_vectors(forward + u[..., None] * right + v[..., None] * up).reshape(-1, 3)

    def project(self, points: ArrayLike) -> Array:
        """Places in the picture [px] of points (n, 3) [m], shape (n, 2): x to the right, y down."""
        right, up, forward = self.axes
        away = np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.position
        depth = (away @ forward) * TANGENT
        x, y = away @ right / depth, away @ up / depth
        return np.stack(((x * self.height + self.width) / 2, (1.0 - y) * self.height / 2), axis=1)


def camera_of(points: Array, view: View, width: int, height: int, room: float = 1.0) -> Camera:
    """A camera that has all points in the picture, with a margin.

    Args:
        points: Shape (n, 3) [m].
        width: Of the picture [px].
        height: Of the picture [px].
        room: Share of the width that the points may take; the rest is for labels.
    """
    azimuth, elevation = np.radians(view.azimuth), np.radians(view.elevation)
    toward = np.array((np.cos(azimuth) * np.cos(elevation), -np.sin(azimuth) * np.cos(elevation), np.sin(elevation)))
    right = np.array((np.sin(azimuth), np.cos(azimuth), 0.0))
    up = np.cross(toward, right)
    across, along, depth = points @ right, points @ up, points @ toward
    middle = (across.max() + across.min()) / 2, (along.max() + along.min()) / 2
    target = middle[0] * right + middle[1] * up + depth.mean() * toward
    half = np.maximum(np.abs(across - middle[0]) * height / (width * room), np.abs(along - middle[1]))
    distance = float(np.max(MARGIN / view.zoom * half / TANGENT + depth - depth.mean()))
    return Camera(target + distance * toward, target, right, width, height)


def unit_vectors(vectors: Array) -> Array:
    """Vectors (..., 3) scaled to length 1; zero stays zero."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))
