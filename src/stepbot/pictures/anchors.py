"""Where leader lines end: the place of each owner in the picture that is farthest from its outline."""

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
