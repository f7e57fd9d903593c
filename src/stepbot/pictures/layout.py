"""Places labels in two columns beside the picture, close to what they name, without overlaps and crossings.

Each label goes to the column on the side of its anchor while there is room. In a column, labels are in the order in
which no two leader lines cross; their heights are the least-squares solution that keeps the distance between them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import hypot

import numpy as np
from numpy.typing import NDArray

Place = tuple[float, float]
"""[px], x to the right, y down."""


def anchors(visible: NDArray[np.int32]) -> dict[int, Place]:
    """A place well inside the visible area of each owner.

    Args:
        visible: Owner of each pixel, shape (height, width); negative for none.

    Returns:
        Owners with at least one pixel, and a place in the picture.
    """
    from scipy.ndimage import distance_transform_edt, find_objects

    found: dict[int, Place] = {}
    for owner, window in enumerate(find_objects(visible + 1)):
        if window is None:
            continue
        mask = np.pad(visible[window] == owner, 1)
        depth = distance_transform_edt(mask)
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        found[owner] = (
            float(window[1].start + column - 1) + 0.5,
            float(window[0].start + row - 1) + 0.5,
        )
    return found


def extent(visible: NDArray[np.int32]) -> tuple[float, float, float, float]:
    """Left, top, right and bottom [px] of everything that is visible; the whole picture if nothing is."""
    rows, columns = np.nonzero(visible >= 0)
    if not len(rows):
        return 0.0, 0.0, float(visible.shape[1]), float(visible.shape[0])
    return float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1)


@dataclass(frozen=True)
class Wanted:
    """A label to place."""

    text: str
    anchor: Place
    """Where its leader line ends."""
    kind: str = "link"
    """``link`` or ``joint``: its colour."""
    hidden: bool = False
    """Whether what it names is behind something else."""


@dataclass(frozen=True)
class Placed:
    """A label in a column."""

    label: Wanted
    on_left: bool
    y: float
    """Middle of the text [px]."""


@dataclass(frozen=True)
class Columns:
    """Where labels may be [px]."""

    left: float
    """x of the inner edge of the left column, where its leader lines start."""
    right: float
    """x of the inner edge of the right column."""
    top: float
    bottom: float
    pitch: float
    """Smallest distance between the middles of two labels."""

    @property
    def capacity(self) -> int:
        """Number of labels that both columns hold."""
        return 2 * (int((self.bottom - self.top) / self.pitch) + 1)


def placed(labels: Sequence[Wanted], columns: Columns) -> list[Placed]:
    """The labels in two columns."""
    left, right = _sides(labels, columns)
    found = []
    for side, x, on_left in ((left, columns.left, True), (right, columns.right, False)):
        ordered = sorted(side, key=lambda label: (label.anchor[1], label.anchor[0], label.text))
        heights = _spread([label.anchor[1] for label in ordered], columns)
        found += [Placed(label, on_left, y) for label, y in zip(_untangled(ordered, heights, x), heights, strict=True)]
    return found


def _sides(labels: Sequence[Wanted], columns: Columns) -> tuple[list[Wanted], list[Wanted]]:
    """The labels of the left and of the right column; those near the middle balance the columns."""
    ordered = sorted(labels, key=lambda label: (label.anchor[0], label.anchor[1], label.text))
    middle, most = (columns.left + columns.right) / 2, columns.capacity // 2
    natural = sum(label.anchor[0] < middle for label in ordered)
    half, slack = len(ordered) / 2, max(1, len(ordered) // 8)
    count = int(min(max(natural, half - slack, len(ordered) - most), half + slack, max(most, half)))
    return ordered[:count], ordered[count:]


def _untangled(labels: list[Wanted], heights: Sequence[float], x: float) -> list[Wanted]:
    """Exchange labels while that shortens the leader lines: lines of least total length do not cross."""

    def length(label: Wanted, y: float) -> float:
        return hypot(label.anchor[0] - x, label.anchor[1] - y)

    found = list(labels)
    shortened = True
    while shortened:
        shortened = False
        for (i, a), (j, b) in combinations(enumerate(heights), 2):
            kept = length(found[i], a) + length(found[j], b)
            if length(found[j], a) + length(found[i], b) < kept - 1e-9:
                found[i], found[j] = found[j], found[i]
                shortened = True
    return found


def _spread(wanted: Sequence[float], columns: Columns) -> list[float]:
    """Heights with at least the pitch between them, as close as possible to the wanted ones (pool adjacent violators).

    If the column is too short for all of them, they share it evenly.
    """
    count, top, bottom, pitch = len(wanted), columns.top, columns.bottom, columns.pitch
    if count > 1 and (count - 1) * pitch > bottom - top:
        return [top + i * (bottom - top) / (count - 1) for i in range(count)]
    blocks: list[tuple[float, int]] = []  # mean of wanted heights less their offsets, number of labels
    for i, y in enumerate(wanted):
        mean, size = y - i * pitch, 1
        while blocks and blocks[-1][0] > mean:
            other, many = blocks.pop()
            mean, size = (mean * size + other * many) / (size + many), size + many
        blocks.append((mean, size))
    lowest, highest = top, bottom - (count - 1) * pitch
    starts = [min(max(mean, lowest), highest) for mean, size in blocks for _ in range(size)]
    return [start + i * pitch for i, start in enumerate(starts)]
