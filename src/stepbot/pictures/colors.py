"""Colours for what has none: as different as possible one after the other."""

from colorsys import hls_to_rgb

import numpy as np

from stepbot.geometry.spatial import Array

_GOLDEN = 0.6180339887498949
"""Multiples of the golden ratio are spread evenly over the circle of hues, however many there are."""
_FIRST = 0.58


def distinct_color(number: int) -> Array:
    """A muted colour, sRGB, shape (3,)."""
    lightness, saturation = (0.66, 0.74, 0.58)[number % 3], (0.34, 0.28, 0.36)[number % 3]
    return np.array(hls_to_rgb((_FIRST + number * _GOLDEN) % 1.0, lightness, saturation))
