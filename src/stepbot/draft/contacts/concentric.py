"""The common axis of all contacts of two bodies, if there is one: only such bodies can turn.

Fits are on the axis or evenly spaced on a circle around it; faces normal to it are centred on it or bounded by arcs
around it. Also circles in outlines, and centres of symmetry of others.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np

from stepbot.draft.contacts.contacts import CoaxialLine, Fit, FitKind, Patch
from stepbot.draft.parts.axis import SAME_LINE, Axis, are_parallel
from stepbot.geometry.fixed_point import distinct
from stepbot.geometry.spatial import Array, perpendicular_frame

_ROUND = 0.5
"""Share of the outline of contacts that are arcs about an axis, from which they are centred on it."""
_OFF_CENTRE = 0.12
"""Distance of a contact's centroid from the axis, as a share of the contact's radius, up to which it is on the axis."""
_GUIDED = 1.0
"""Engaged length of a shaft, in radii, from which it guides."""
_CIRCLE = 2e-5
"""Distance [m] up to which an outline is on a circle."""
_SMALLEST_ARC = 5e-4
_LONGEST_CHORD = 0.7
"""Share of the radius up to which a chord is a segment of an arc."""
_FLANGE = 4
"""Number of holes in a circle from which they are those of a flange."""
_ORDER = {FitKind.SHAFT: 0, FitKind.FLUSH: 1, FitKind.HOLES: 2}


def concentric_axis(fits: Sequence[Fit], patches: Sequence[Patch], others: Iterable[Axis]) -> Axis | None:
    """The common axis of all fits and patches.

    Args:
        others: Axis lines of the two bodies, tried if only plane faces touch.
    """
    for axis in _candidates(fits, patches, others):
        if not _fits_lie_about(axis, fits):
            continue
        # A pin that is guided turns on any face normal to it: an arm lies on the plate that its pin is in.
        guided = any(f.kind == FitKind.SHAFT and f.full and f.length >= _GUIDED * f.radius for f in fits)
        if all(patch_lies_about(axis, p) or (guided and axis.is_along(p.normal)) for p in patches):
            return axis
    return None


def _candidates(fits: Sequence[Fit], patches: Sequence[Patch], others: Iterable[Axis]) -> Iterator[Axis]:
    yield from _axes_of_fits(fits)
    if not fits and patches:
        discs = ((c[0], p.normal) for p in patches if (c := fitted_circle(p.hull, p.normal, _CIRCLE)) is not None)
        if (disc := next(discs, None)) is not None:
            yield Axis(*disc)
        else:
            yield from (axis for axis in others if round_share(patches, axis) >= _ROUND)


def _axes_of_fits(fits: Sequence[Fit]) -> list[Axis]:
    axes: list[Axis] = []
    for fit in sorted(fits, key=lambda f: (_ORDER[f.kind], -f.radius)):
        if not any(fit.axis.same(axis) for axis in axes):
            axes.append(fit.axis)
    ring = _ring_axis(fits)
    if ring is not None:
        axes.insert(0, ring)
    return axes


def _ring_axis(fits: Sequence[Fit]) -> Axis | None:
    """The axis of at least three parallel holes that are evenly spaced on a circle."""
    holes = [fit for fit in fits if fit.kind == FitKind.HOLES]
    if len(holes) < 3 or not all(holes[0].axis.is_along(fit.axis.d) for fit in holes):
        return None
    d = holes[0].axis.d
    feet: list[Array] = []
    for fit in holes:
        foot = fit.axis.point - d * float(fit.axis.point @ d)
        if all(np.linalg.norm(foot - other) > SAME_LINE for other in feet):
            feet.append(foot)
    if len(feet) < 3:
        return None
    middle = np.mean(feet, axis=0)
    radii = np.linalg.norm(np.array(feet) - middle, axis=1)
    if np.ptp(radii) > 2.0 * SAME_LINE:
        return None
    return Axis(middle + d * float(holes[0].axis.point @ d), d)


def _fits_lie_about(axis: Axis, fits: Sequence[Fit]) -> bool:
    if not all(axis.is_along(fit.axis.d) for fit in fits):
        return False
    off = [fit for fit in fits if axis.distance(fit.axis.point) > SAME_LINE]
    if any(fit.kind != FitKind.HOLES for fit in off):
        return False
    if not off:
        return True
    points = np.array([fit.axis.point for fit in off]) - axis.point
    feet = points - np.outer(points @ axis.d, axis.d)
    radii = np.linalg.norm(feet, axis=1)
    for radius in distinct(np.round(radii, 5)):
        ring = feet[np.abs(radii - radius) < 2.0 * SAME_LINE]
        if len(ring) < 2 or np.linalg.norm(ring.mean(axis=0)) > 0.1 * radius:
            return False
    return True


def patch_lies_about(axis: Axis, patch: Patch) -> bool:
    """Whether a contact is normal to an axis and centred on it, or bounded by arcs around it."""
    if not axis.is_along(patch.normal):
        return False
    reach = float(axis.distances(patch.hull).max())
    if axis.distance(patch.point) <= max(1e-4, _OFF_CENTRE * reach):
        return True
    circle = fitted_circle(patch.hull, patch.normal, _CIRCLE)
    on_axis = circle is not None and axis.distance(circle[0]) < 2.0 * SAME_LINE
    return on_axis or round_share([patch], axis) >= _ROUND


def round_share(patches: Sequence[Patch], axis: Axis) -> float:
    """Share of the outlines of patches that are arcs about an axis."""
    if not all(are_parallel(axis.d, patch.normal) for patch in patches):
        return 0.0
    total = about = 0.0
    for ring in (ring for patch in patches for ring in patch.rings):
        radii = axis.distances(ring)
        chords = np.linalg.norm(np.diff(ring, axis=0), axis=1)
        even = np.abs(np.diff(radii)) < _CIRCLE
        even &= (radii[1:] > _SMALLEST_ARC) & (chords < _LONGEST_CHORD * radii[1:])
        # A lone chord is an edge across from the axis.
        arcs = even & (np.roll(even, 1) | np.roll(even, -1))
        total += float(chords.sum())
        about += float(chords[arcs].sum())
    return about / total if total else 0.0


def has_free_circle(lines: Iterable[CoaxialLine], parts: Collection[int], axis: Axis) -> bool:
    """Whether some parts have four equal holes in a circle about an axis, with nothing else on their lines."""
    holes = [
        (axis.distance(line.axis.point), round(min(face.radius for face in line.faces[i]), 6))
        for line in lines
        for i in line.faces
        if i in parts and len(line.faces) == 1 and line.axis.is_along(axis.d)
    ]
    away = [(far, radius) for far, radius in holes if far > 2.0 * radius]
    return any(sum(abs(far - r) < SAME_LINE and radius == s for r, s in away) >= _FLANGE for far, radius in away)


_FEWEST = 12
"""Minimum number of points of a circle, below which an outline is a polygon."""
_SYMMETRIC = 2e-6
"""Distance [m] up to which opposite points are symmetric."""


def fitted_circle(points: Array, normal: Array, tolerance: float) -> tuple[Array, float] | None:
    """Centre (3,) and radius of the circle through coplanar points (n, 3); None if they are not on a circle.

    An arc counts if no gap in it is larger than half of the circle.
    """
    if len(points) < _FEWEST:
        return None
    frame = perpendicular_frame(normal)[:, :2]
    middle = points.mean(axis=0)
    flat = (points - middle) @ frame
    A = np.column_stack([2.0 * flat, np.ones(len(flat))])
    x, y, rest = np.linalg.lstsq(A, (flat**2).sum(axis=1), rcond=None)[0].tolist()
    centre = np.array([x, y])
    radius = float(np.sqrt(max(0.0, rest + x * x + y * y)))
    spokes = flat - centre
    if np.abs(np.linalg.norm(spokes, axis=1) - radius).max() > max(tolerance, 1e-3 * radius * (tolerance > 1e-5)):
        return None
    angles = np.sort(np.arctan2(spokes[:, 0], spokes[:, 1]))
    if np.diff(np.append(angles, angles[0] + 2.0 * np.pi)).max() > np.pi:
        return None
    return middle + frame @ centre, radius


def symmetric_outline(points: Array) -> tuple[Array, float] | None:
    """Centre (3,) and inner radius of an outline (n, 3) with a centre of symmetry, such as a rectangle, else None."""
    if not len(points) or len(points) % 2:
        return None
    half = len(points) // 2
    # Opposite points of a symmetric outline are half of its length apart.
    sums = points[:half] + points[half:]
    if float(np.abs(sums - sums[0]).max()) > _SYMMETRIC:
        return None
    middle = points.mean(axis=0)
    starts, edges = points - middle, np.roll(points, -1, axis=0) - points
    squares = np.maximum((edges**2).sum(axis=1), 1e-24)
    feet = starts + edges * np.clip(-(starts * edges).sum(axis=1) / squares, 0.0, 1.0)[:, None]
    return middle, float(np.linalg.norm(feet, axis=1).min())
