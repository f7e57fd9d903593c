"""Doubts about given mass properties: values that no mass within the geometry of a body has.

Let S be the second moment of the mass about its centre c, S = integral of (p - c)(p - c)^T dm, so that the inertia is
I = tr(S) 1 - S. Along a unit direction n, let the geometry extend from ``low`` to ``high``. A distribution on
[low, high] with mean n.c has at most the variance (high - n.c)(n.c - low) (Bhatia and Davis, "A better bound on the
variance", 2000), which two point masses at the ends reach. Hence n^T S n <= m (high - n.c)(n.c - low): the sharp bound,
which any mass distribution within the geometry satisfies. With it the inertia about z is at most the sum of the bounds
along x and y; eight point masses in the corners of the bounding box reach all three at once.

Below, the trace of the inertia is bounded by density: of all bodies of mass m with no more than a given density, the
ball has the smallest, 6/5 m r^2.
"""

from collections.abc import Iterator
from itertools import product
from math import inf, pi

import numpy as np
from msgspec import Struct

from stepbot.diagnostics import Finding
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Array, Vector3, corners, dot, matrix_product, vector3

OSMIUM = 22_590.0
"""Density [kg/m^3] of the densest element."""
SPREAD_SLACK = 0.02
"""Excess over a bound, as a share of tr(S), that is not reported: published inertias are rounded to two or three
digits, and meshes are inscribed in curved faces."""
OUTSIDE_SLACK = 0.01
"""Distance of a centre of mass from the geometry, as a share of its diagonal, that is not reported."""


class SpreadExcess(Struct, frozen=True):
    """A direction in which a mass is spread further than its geometry reaches."""

    direction: Vector3
    given: float
    """Root mean square distance [m] of the mass from its centre along it."""
    largest: float
    """Largest possible one [m] within the geometry."""


def outside_by(points: Array, com: Vector3) -> float:
    """Distance [m] of a point from the convex hull of points (n, 3): a lower bound, by 13 directions."""
    low, high = _extents(points, _DIRECTIONS)
    at = dot(_DIRECTIONS, np.array(com))
    return max(0.0, float(np.maximum(low - at, at - high).max()))


def spread_excess(points: Array, properties: MassProperties) -> SpreadExcess | None:
    """The largest excess of spread over its bound, along the axes and the principal axes; None within the slack.

    Args:
        points: Points (n, 3) [m] whose convex hull contains the mass.
        properties: Mass properties in the same frame, with a positive mass.
    """
    # Second moment (3, 3) [m^2] about the centre of mass, divided by the mass.
    I = np.array(properties.inertia)  # noqa: E741 - the field's letter
    second = 0.5 * np.trace(I) * np.eye(3) - I
    with np.errstate(over="ignore"):
        S = np.asarray(second / properties.mass)
    if not np.isfinite(S).all():  # next to no mass
        return SpreadExcess(vector3(np.eye(3)[int(np.argmax(np.diag(second)))]), inf, 0.0)
    directions = np.vstack([np.eye(3), np.linalg.eigh(S)[1].T])
    given = np.einsum("ni,ij,nj->n", directions, S, directions)
    bounds = _variance_bounds(points, properties.com, directions)
    worst = int(np.argmax(given - bounds))
    if given[worst] - bounds[worst] <= SPREAD_SLACK * np.trace(S):
        return None
    return SpreadExcess(vector3(directions[worst]), float(given[worst]) ** 0.5, float(bounds[worst]) ** 0.5)


def largest_moments(points: Array, properties: MassProperties) -> Vector3:
    """Largest ixx, iyy, izz [kg m^2] about the centre of mass within the hull of points (n, 3)."""
    x, y, z = (properties.mass * _variance_bounds(points, properties.com, np.eye(3))).tolist()
    return y + z, x + z, x + y


def smallest_trace(mass: float) -> float:
    """Sum of the principal moments [kg m^2] of a ball of osmium: no body of this mass [kg] has less."""
    radius: float = (3.0 * mass / (4.0 * pi * OSMIUM)) ** (1.0 / 3.0)
    return 1.2 * mass * radius**2


def _variance_bounds(points: Array, com: Vector3, directions: Array) -> Array:
    """Largest variance [m^2] along each direction (k, 3); of a centre outside, the square of the farthest distance."""
    low, high = _extents(points, directions)
    at = dot(directions, np.array(com))
    inside = (low <= at) & (at <= high)
    return np.asarray(np.where(inside, (high - at) * (at - low), np.maximum(high - at, at - low) ** 2))


def _extents(points: Array, directions: Array) -> tuple[Array, Array]:
    along = matrix_product(points, directions.T)
    return along.min(axis=0), along.max(axis=0)


def _half_of_cube_directions() -> Array:
    """Unit directions (13, 3) to faces, edges and corners of a cube, one of each opposite pair."""
    every = [v for v in product((-1.0, 0.0, 1.0), repeat=3) if v > (0.0, 0.0, 0.0)]
    return np.array([np.array(v) / np.linalg.norm(v) for v in every])


_DIRECTIONS = _half_of_cube_directions()


GREATEST = 1e30
"""In SI units: OpenUSD and several engines store single precision."""
FARTHEST = 1e6
"""Distance [m]: the squares of farther ones overflow."""
DENSEST = 25_000.0
"""Density [kg/m^3]; osmium, the densest element, has 22590."""


_MOMENTS = ("ixx", "iyy", "izz")


def density_doubt(mass: float, volume: float, has_unit: bool) -> Finding | None:
    """The doubt about a mass [kg] that no material has in a volume [m^3]: often grams, if it has no unit."""
    if volume <= 0.0 or mass <= DENSEST * volume:
        return None
    message = f"{mass:.6g} kg in {1e6 * volume:.3g} cm^3 is {mass / volume:.3g} kg/m^3, more than any material has"
    grams = f"if the unit is g, write `{mass:.6g} g`; numbers without a unit are kilograms"
    return Finding("SB521", message, (grams,) if not has_unit and 1e-3 * mass <= DENSEST * volume else ())


def inertial_doubts(properties: MassProperties, points: Array) -> Iterator[Finding]:
    """Doubts about a given com and inertia.

    Args:
        properties: Mass properties with a positive mass and a possible inertia.
        points: Points (n, 3) [m] in the same frame whose convex hull contains the mass; may be empty.
    """
    trace, smallest = float(np.trace(np.array(properties.inertia))), smallest_trace(properties.mass)
    if 0.0 < trace < smallest:  # a point mass has none
        yield Finding(
            "SB518:small-inertia",
            f"ixx + iyy + izz = {trace:.3g} kg m^2; a ball of osmium ({OSMIUM:g} kg/m^3) of its {properties.mass:.4g} "
            f"kg has {smallest:.3g}",
            ("check the unit: 1 kg mm^2 is 1e-6 kg m^2",),
        )
    if not len(points):
        return
    outside = outside_by(points, properties.com)
    if outside > OUTSIDE_SLACK * float(np.linalg.norm(np.ptp(points, axis=0))):
        com = ", ".join(f"{1e3 * c:.1f}" for c in properties.com)
        message = f"com ({com}) mm is {1e3 * outside:.1f} mm outside its geometry, {_extent(points)}"
        yield Finding("SB518:com", message, ("give the com in the link's frame",))
    excess = spread_excess(points, properties)
    if excess is not None:
        remedy = "give the inertia about the com, along the link's axes, in kg m^2; without `inertia` it is computed"
        yield Finding("SB518:large-inertia", _excess_text(properties, points, excess), (remedy,))


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
    low, high = (1e3 * corner for corner in corners(points))
    ranges = (f"{axis} {a:.0f} to {b:.0f}" for axis, a, b in zip("xyz", low + 0.0, high + 0.0, strict=True))
    return ", ".join(ranges) + " mm"
