"""Joint axes in a picture: a line along the axis, an arrow about it for a turn, along it for a slide."""

from collections.abc import Iterator
from colorsys import hls_to_rgb

import numpy as np

from stepbot.geometry.spatial import Array, perpendicular_frame

from .camera import Camera
from .drawing import Color, Drawing
from .layout import Place
from .raytrace import Renderer
from .scene import Axis

COLOR: Color = (196, 64, 16)
_FAINT = 0.38
_HALF = 0.085
"""Half the length of an axis, relative to the size of the scene."""
_RADIUS = 0.032
"""Radius of the arrow about it, likewise."""
_SWEEP = np.radians(280.0)
_PIECES = 48
_WIDTH = 2.2
_SLACK = 2e-3


def draw_axis(drawing: Drawing, renderer: Renderer, camera: Camera, axis: Axis, size: float) -> None:
    """Draw the axis of a joint; what is behind a surface is faint.

    Args:
        renderer: The scene, which hides parts of the axis.
        camera: That the picture is taken with.
        size: Of the scene [m].
    """
    middle, direction = np.array(axis.point), np.array(axis.direction)
    along = np.linspace(-_HALF, _HALF, _PIECES)[:, None] * size
    _draw_curve(drawing, renderer, camera, middle + along * direction, size)
    ends = _places(camera, middle + np.array(((_HALF,), (-_HALF,))) * size * direction)
    if axis.slides:
        drawing.arrowhead(ends[0], ends[1], 12.0, COLOR)
    if axis.turns:
        arc = _arc(middle + 0.55 * _HALF * size * direction, direction, _RADIUS * size)
        _draw_curve(drawing, renderer, camera, arc, size)
        tip = _places(camera, arc[-2:])
        drawing.arrowhead(tip[1], tip[0], 10.0, COLOR)


def _draw_curve(drawing: Drawing, renderer: Renderer, camera: Camera, points: Array, size: float) -> None:
    hidden = renderer.hides((points[:-1] + points[1:]) / 2, _SLACK * size)
    places = _places(camera, points)
    for first, last, faint in _runs(hidden.tolist()):
        drawing.line(places[first : last + 1], COLOR, _WIDTH, _FAINT if faint else 1.0)


def _runs(flags: list[bool]) -> Iterator[tuple[int, int, bool]]:
    """Start, end and value of each run of equal flags."""
    first = 0
    for i in range(1, len(flags) + 1):
        if i == len(flags) or flags[i] != flags[first]:
            yield first, i, flags[first]
            first = i


def _arc(centre: Array, direction: Array, radius: float) -> Array:
    """Points of a circle about a direction, by the right-hand rule."""
    R = perpendicular_frame(direction)
    angles = np.linspace(0.0, _SWEEP, _PIECES)[:, None]
    return centre + radius * (np.cos(angles) * R[:, 0] + np.sin(angles) * R[:, 1])


def _places(camera: Camera, points: Array) -> list[Place]:
    return [(x, y) for x, y in camera.project(points).tolist()]


_GOLDEN = 0.6180339887498949
"""Multiples of the golden ratio are spread evenly over the circle of hues, however many there are."""
_FIRST = 0.58


def distinct_color(number: int) -> Array:
    """A muted colour, sRGB, shape (3,)."""
    lightness, saturation = (0.66, 0.74, 0.58)[number % 3], (0.34, 0.28, 0.36)[number % 3]
    return np.array(hls_to_rgb((_FIRST + number * _GOLDEN) % 1.0, lightness, saturation))
