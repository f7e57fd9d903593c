"""Equal rows, compared with numpy.unique."""

import numpy as np
import pytest

from stepbot.geometry.fixed_point import distinct_rows


@pytest.mark.parametrize("shape", [(0, 3), (1, 3), (7, 1), (500, 3), (500, 4)])
@pytest.mark.parametrize("kind", [np.float64, np.int64])
def test_rows_are_grouped_as_numpy_groups_them(shape: tuple[int, int], kind: type) -> None:
    """The first of each kind and the kind of each row are numpy's; zeros of both signs are equal."""
    rows = np.random.default_rng(1).integers(-2, 3, shape).astype(kind)
    rows = -(rows * rows) if kind is np.float64 else rows
    first, kinds = distinct_rows(rows)
    _, expected_first, expected_kinds = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    assert np.array_equal(first, expected_first)
    assert np.array_equal(kinds, expected_kinds.reshape(-1))
