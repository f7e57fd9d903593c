"""Doubts about given mass properties: values that no mass within the geometry of a body has."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.inertia_bounds import (
    OSMIUM,
    OUTSIDE_SLACK,
    SpreadExcess,
    largest_moments,
    outside_by,
    smallest_trace,
    spread_excess,
)
from stepbot.geometry.spatial import Array

GREATEST = 1e30
"""In SI units: OpenUSD and several engines store single precision."""
FARTHEST = 1e6
"""Distance [m]: the squares of farther ones overflow."""
DENSEST = 25_000.0
"""Density [kg/m^3]; osmium, the densest element, has 22590."""


_MOMENTS = ("ixx", "iyy", "izz")


@dataclass(frozen=True)
class Doubt:
    """A value that is hardly that of a body."""

    code: str
    """SB518 or SB521, with the feature."""
    message: str
    remedy: str
    """Empty if there is none."""


def density_doubt(mass: float, volume: float) -> Doubt | None:
    """The doubt about a mass [kg] that no material has in a volume [m^3]: often grams without a unit."""
    if volume <= 0.0 or mass <= DENSEST * volume:
        return None
    message = f"{mass:.6g} kg in {1e6 * volume:.3g} cm^3 is {mass / volume:.3g} kg/m^3, more than any material has"
    grams = f"if the unit is g, write `{mass:.6g} g`; numbers without a unit are kilograms"
    return Doubt("SB521", message, grams if 1e-3 * mass <= DENSEST * volume else "")


def inertial_doubts(properties: MassProperties, points: Array) -> Iterator[Doubt]:
    """Doubts about a given com and inertia.

    Args:
        properties: Mass properties with a positive mass and a possible inertia.
        points: Points (n, 3) [m] in the same frame whose convex hull contains the mass; may be empty.
    """
    trace, smallest = float(np.trace(np.array(properties.inertia))), smallest_trace(properties.mass)
    if trace < smallest:
        yield Doubt(
            "SB518:small-inertia",
            f"ixx + iyy + izz = {trace:.3g} kg m^2; a ball of osmium ({OSMIUM:g} kg/m^3) of its {properties.mass:.4g} "
            f"kg has {smallest:.3g}",
            "check the unit: 1 kg mm^2 is 1e-6 kg m^2",
        )
    if not len(points):
        return
    outside = outside_by(points, properties.com)
    if outside > OUTSIDE_SLACK * float(np.linalg.norm(np.ptp(points, axis=0))):
        com = ", ".join(f"{1e3 * c:.1f}" for c in properties.com)
        message = f"com ({com}) mm is {1e3 * outside:.1f} mm outside its geometry, {_extent(points)}"
        yield Doubt("SB518:com", message, "give the com in the link's frame")
    excess = spread_excess(points, properties)
    if excess is not None:
        remedy = "give the inertia about the com, along the link's axes, in kg m^2; without `inertia` it is computed"
        yield Doubt("SB518:large-inertia", _excess_text(properties, points, excess), remedy)


def _excess_text(properties: MassProperties, points: Array, excess: SpreadExcess) -> str:
    """The moment of inertia that exceeds its bound most; if none does, the direction of the spread that does."""
    moments, largest = np.diag(np.array(properties.inertia)), np.array(largest_moments(points, properties))
    worst = int(np.argmax(moments - largest))
    if moments[worst] > largest[worst]:
        return (
            f"{_MOMENTS[worst]} = {moments[worst]:.3g} kg m^2, but {properties.mass:.4g} kg with this com have at most "
            f"{largest[worst]:.3g} within the geometry, {_extent(points)}"
        )
    direction = ", ".join(f"{c + 0.0:.2f}" for c in np.round(excess.direction, 2))
    return (
        f"the inertia spreads the mass by {1e3 * excess.given:.1f} mm (root mean square) along ({direction}), the "
        f"geometry, {_extent(points)}, by at most {1e3 * excess.largest:.1f} mm"
    )


def _extent(points: Array) -> str:
    low, high = 1e3 * points.min(axis=0), 1e3 * points.max(axis=0)
    ranges = (f"{axis} {a:.0f} to {b:.0f}" for axis, a, b in zip("xyz", low + 0.0, high + 0.0, strict=True))
    return ", ".join(ranges) + " mm"
