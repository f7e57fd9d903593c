"""Areas in the plane by their outlines, and their intersections: Clipper2, through manifold3d."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from ..spatial import Array

_SCALE = 1e3
"""The library keeps six decimals: millimetres instead of metres."""


class Shared(Struct, frozen=True, eq=False):
    """The intersection of two areas."""

    area: float
    """[m^2]."""
    centroid: Array
    """Shape (2,) [m]."""
    hull: Array
    """Shape (n, 2) [m]: convex outline, anticlockwise."""
    rings: tuple[Array, ...]
    """Outlines, each (n, 2) [m]: anticlockwise, holes clockwise."""


class Region:
    """An area bounded by closed rings (n, 2) [m], by the even-odd rule."""

    def __init__(self, rings: Sequence[Array]) -> None:
        import manifold3d

        contours = [np.ascontiguousarray(ring * _SCALE) for ring in rings if len(ring) >= 3]
        self._section: Any = manifold3d.CrossSection(contours, manifold3d.FillRule.EvenOdd)

    @property
    def area(self) -> float:
        """[m^2]."""
        return float(self._section.area()) / _SCALE**2

    def shared(self, other: "Region", least: float) -> Shared | None:
        """The intersection of this area and another one; None if it is less than ``least`` [m^2]."""
        common = self._section ^ other._section
        area = float(common.area()) / _SCALE**2
        if area < least:
            return None
        rings = tuple(np.asarray(ring, dtype=np.float64) / _SCALE for ring in common.to_polygons())
        (hull,) = common.hull().to_polygons()
        return Shared(area, _centroid(rings), np.asarray(hull, dtype=np.float64) / _SCALE, rings)


def _centroid(rings: Sequence[Array]) -> Array:
    """Centroid of the area bounded by rings, where the orientation distinguishes holes."""
    total, moment = 0.0, np.zeros(2)
    origin = rings[0][0]
    for ring in rings:
        x, y = (ring - origin).T
        nx, ny = np.append(x[1:], x[0]), np.append(y[1:], y[0])
        twice = x * ny - nx * y
        total += float(twice.sum())
        moment += [float(((x + nx) * twice).sum()), float(((y + ny) * twice).sum())]
    return np.asarray(origin + moment / (3.0 * total))
