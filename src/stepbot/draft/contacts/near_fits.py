"""Round faces of two parts that are nearly coaxial: parts that were placed by hand, or whose holes do not agree.

Such faces are no contacts: the freedom that they leave cannot be computed. Where nothing else connects two pieces,
these are moved until the faces are coaxial (``settling``); elsewhere nearly coaxial faces are evidence of last resort.
What they show is to be reviewed.
"""

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from msgspec.structs import astuple
from numpy.typing import NDArray

from stepbot.draft.contacts.contacts import Contacts, FitKind, Pair
from stepbot.draft.contacts.shafts import HALF_ROUND, HOLE_RATIO
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.parts import Part, box_gap
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.solids.box_pairs import box_pairs
from stepbot.geometry.spatial import Array, cross
from stepbot.step.features.axis_contacts import LOOSEST, SLACK_SHARE

OFFSET, ANGLE = 6e-4, 0.021
"""Distance [m] and angle [rad], 1.2 degrees, up to which lines are nearly the same."""
_BESIDE = 1e-3
"""Gap [m] between two parts, and between two holes along their axis, up to which they are compared."""
_END, _SAME_RADIUS = 3e-4, 1e-5
"""Gap [m] of two round bodies end to end, in each other or apart, and difference of their radii, up to which they were
drawn flush.
"""
_OTHER_LINE = 1e-3
"""Distance [m] from which fits of two parts are on two lines."""


class NearFit(Struct, frozen=True, eq=False):
    """Nearly coaxial cylinders of two parts."""

    a: int
    b: int
    kind: FitKind
    axis: Axis
    """That of the face of ``a``, as ``other_axis`` of ``b``."""
    other_axis: Axis
    offset: float
    """[m]."""
    angle: float
    """[rad]."""
    radius: float
    """Of the narrower face [m]."""
    shaft: int
    """The inner part; -1 for two holes, and for two ends that meet."""

    def of(self, part: int) -> Axis:
        """The axis of the face of a part."""
        return self.axis if part == self.a else self.other_axis


class _Round(Struct, frozen=True, eq=False):
    """The cylinders of a part, as arrays."""

    points: Array
    """Shape (n, 3) [m]: their middles."""
    directions: Array
    radii: Array
    halves: Array
    """Shape (n,) [m]: half of their lengths."""
    bores: NDArray[np.bool_]

    def beside(self, box: Array) -> "_Round":
        """Those that may reach a box (2, 3) [m]."""
        reach = (self.halves + _BESIDE + OFFSET)[:, None]
        rows = ((self.points > box[0] - reach) & (self.points < box[1] + reach)).all(axis=1)
        return _Round(*(column[rows] for column in astuple(self)))


def find_near_fits(
    scene: Scene, parts: Mapping[int, Part], small: set[int], contacts: Contacts
) -> dict[Pair, list[NearFit]]:
    """The nearly coaxial faces of larger parts beside each other, one for each line and pair, the closest.

    Args:
        small: Those that move with their hosts, such as screws.
        contacts: Lines with exactly coaxial faces; what has a fit on one is left out.
    """
    rounds = _rounds(small, contacts)
    ids = [i for i in rounds if parts[i].size]
    boxes = np.array([parts[i].box for i in ids]).reshape(-1, 2, 3)
    near: dict[Pair, list[NearFit]] = {}
    apart: set[bytes] = set()  # what equal parts elsewhere have shown
    rows = box_pairs(boxes[:, 0], boxes[:, 1], -_BESIDE)
    for pair, arrangement in scene.arranged([(ids[k], ids[m]) for k, m in zip(*rows, strict=True)]):
        if arrangement in apart:
            continue
        one, two = (rounds[i].beside(parts[j].box) for i, j in (pair, pair[::-1]))
        fits = _between(pair, one, two) if box_gap(parts[pair[0]].box, parts[pair[1]].box) < _BESIDE else []
        exact = contacts.fits.get(pair, ())
        fits = [fit for fit in fits if not any(fit.axis.same(one.axis, OFFSET) for one in exact)]
        if fits:
            near[pair] = fits
        else:
            apart.add(arrangement)
    return near


def _rounds(small: set[int], contacts: Contacts) -> dict[int, _Round]:
    rows: dict[int, list[tuple[Array, Array, float, float, bool]]] = defaultdict(list)
    for line in contacts.lines:
        for part, faces in line.faces.items():
            for f in faces if part not in small else ():
                if not f.cone and f.span > HALF_ROUND:
                    middle = line.axis.point + line.axis.d * (0.5 * (f.low + f.high))
                    rows[part].append((middle, line.axis.d, f.radius, 0.5 * (f.high - f.low), f.bore))
    return {i: _Round(*(np.array(column) for column in zip(*of, strict=True))) for i, of in sorted(rows.items())}


def _between(pair: Pair, one: _Round, two: _Round) -> list[NearFit]:
    sines = np.linalg.norm(cross(one.directions[:, None], two.directions[None]), axis=2)
    offsets = two.points[None] - one.points[:, None]
    along = (offsets * one.directions[:, None]).sum(axis=2)
    apart = np.linalg.norm(offsets - along[..., None] * one.directions[:, None], axis=2)
    gaps = np.abs(along) - one.halves[:, None] - two.halves[None]
    radii = np.stack(np.broadcast_arrays(one.radii[:, None], two.radii[None]))
    wide, thin = radii.max(axis=0), radii.min(axis=0)
    bores = one.bores[:, None] & two.bores[None]
    slack = np.maximum(LOOSEST, SLACK_SHARE * wide)
    shafts = (one.bores[:, None] ^ two.bores[None]) & (gaps < 0.0) & (wide - thin < slack)
    holes = bores & (gaps < _BESIDE) & (wide < HOLE_RATIO * thin)
    ends = ~(one.bores[:, None] | two.bores[None]) & (np.abs(gaps) < _END) & (wide - thin < _SAME_RADIUS)
    close = (sines < ANGLE) & (apart < OFFSET) & (shafts | holes | ends)
    best: list[NearFit] = []
    for n, m in sorted(np.argwhere(close).tolist(), key=lambda k: (round(float(apart[k[0], k[1]]), 9), k)):
        axis = Axis(one.points[n], one.directions[n])
        if all(axis.distance(fit.axis.point) > _OTHER_LINE or not axis.is_along(fit.axis.d, ANGLE) for fit in best):
            kind = FitKind.SHAFT if shafts[n, m] else FitKind.FLUSH if ends[n, m] else FitKind.HOLES
            other = Axis(two.points[m], two.directions[m])
            inner = pair[int(one.bores[n])] if kind == FitKind.SHAFT else -1
            off = float(apart[n, m]), float(sines[n, m]), float(thin[n, m])
            best.append(NearFit(*pair, kind, axis, other, *off, inner))
    return best
