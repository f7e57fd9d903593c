"""How two sides meet on a line with faces of both: distinguishes an axis from a coincidence.

Parts of an arm that is drawn straight share many lines, for example with a bracket at the other end. A joint can turn
where a shaft is in a matching bore, or where two bores meet face to face. Faces that merely overlap or touch are weak
evidence; faces apart from each other are not evidence.
"""

from collections.abc import Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array
from stepbot.robot.joint_table import Basis

TIGHTEST = 1e-5
"""Clearance [m] that every fit may have, and difference of radii that count as equal."""
LOOSEST = 5e-4
"""Maximum clearance [m] of a fit."""
SLACK_SHARE = 0.06
"""Maximum clearance of a fit, as a share of the bore's radius."""
INTERFERENCE = 1.5e-4
"""Maximum interference [m] of a shaft drawn wider than its bore, for a press fit; never more than its clearance might
be."""
ENGAGED = 2e-4
"""Minimum engaged length [m] of a shaft in its bore: less is a chamfer or a centring edge."""
BESIDE = 1.5e-3
"""Gap [m] along the line up to which faces count as touching: a washer, or two edges chamfered by 0.75 mm."""


def fits(bore: Array | float, shaft: Array | float, engaged: Array | float, fineness: float = 1.0) -> Array:
    """Whether shafts fit bores, by their radii and engaged lengths [m]; arrays are broadcast."""
    bores = np.asarray(bore)
    slack, widest = bores - shaft, np.maximum(fineness * TIGHTEST, np.minimum(LOOSEST, SLACK_SHARE * bores))
    is_engaged = np.asarray(engaged) >= fineness * ENGAGED
    return np.asarray(is_engaged & (slack <= widest) & (slack >= -np.minimum(widest, INTERFERENCE)))


_RANKS = (Basis.FIT, Basis.FLANGE, Basis.TOUCH, Basis.APART)
_PAIRS_AT_ONCE = 1 << 20


class Spans(Struct, frozen=True, eq=False):
    """Cylindrical faces on one line, one per row."""

    low: Array
    """Shape (n,) [m]: start of each face along the line."""
    high: Array
    """Shape (n,) [m]: its end."""
    radii: Array
    """Shape (n,) [m]."""
    bores: NDArray[np.bool_]
    """Shape (n,): whether material is outside."""

    def rows(self, rows: slice) -> "Spans":
        """Some of the faces."""
        return Spans(self.low[rows], self.high[rows], self.radii[rows], self.bores[rows])


class Meeting(Struct, frozen=True):
    """The two decisive faces, one of each side."""

    basis: Basis
    """Fit, flange, touch or apart."""
    rows: tuple[int, int]
    """The face of each side."""
    overlap: float
    """Length [m] along the line that both cover; negative for a gap between them."""


def meeting(a: Spans, b: Spans, fineness: float = 1.0) -> Meeting:
    """How the faces of two sides, at least one of each, meet: the pair with the strongest evidence.

    Ties are broken by the widest pair, then the longest overlap; for faces apart, by the nearest pair.

    Args:
        fineness: Of the assembly, by which distances that decide are smaller.
    """
    return min(_best_of_blocks(a, b, fineness), key=lambda best: best[0])[1]


def _best_of_blocks(a: Spans, b: Spans, fineness: float) -> Iterator[tuple[tuple[float, ...], Meeting]]:
    """The best pair of each block of rows of ``a``, the first of equal ones, with its sort key."""
    block = max(1, _PAIRS_AT_ONCE // len(b.radii))
    for start in range(0, len(a.radii), block):
        ranks, widths, overlaps = _pairs(a.rows(slice(start, start + block)), b, fineness)
        apart = ranks == _RANKS.index(Basis.APART)
        first = np.where(apart, -overlaps, -widths).ravel()
        second = np.where(apart, -widths, -overlaps).ravel()
        best = int(np.lexsort((second, first, ranks.ravel()))[0])
        i, j = divmod(best, len(b.radii))
        meeting = Meeting(_RANKS[int(ranks[i, j])], (start + i, j), float(overlaps[i, j]))
        yield (float(ranks[i, j]), float(first[best]), float(second[best])), meeting


def _pairs(a: Spans, b: Spans, fineness: float) -> tuple[NDArray[np.intp], Array, Array]:
    """For every pair of faces (n, m), its rank, the smaller radius [m] and the overlap [m]."""
    radii_a, radii_b = a.radii[:, None], b.radii[None, :]
    overlaps = np.minimum(a.high[:, None], b.high) - np.maximum(a.low[:, None], b.low)
    beside = overlaps >= -fineness * BESIDE
    facing = a.bores[:, None] != b.bores
    bore = np.where(a.bores[:, None], radii_a, radii_b)
    are_fits = facing & fits(bore, np.where(a.bores[:, None], radii_b, radii_a), overlaps, fineness)
    flanges = a.bores[:, None] & b.bores & beside & (np.abs(radii_a - radii_b) <= fineness * TIGHTEST)
    ranks = np.select([are_fits, flanges, beside], [0, 1, 2], 3)
    return ranks.astype(np.intp), np.minimum(radii_a, radii_b), overlaps
