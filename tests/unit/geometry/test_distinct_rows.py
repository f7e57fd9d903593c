"""Equal rows, compared with numpy.unique."""

import numpy as np
import pytest

from stepbot.geometry.fixed_point import distinct, distinct_rows


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


@pytest.mark.parametrize("shape", [(0,), (1,), (60,), (40, 3)])
@pytest.mark.parametrize("kind", [np.float64, np.int32])
def test_numbers_are_those_that_numpy_finds(shape: tuple[int, ...], kind: type) -> None:
    """Each once, ascending, of an array of any shape; zeros of both signs are equal."""
    values = np.random.default_rng(2).integers(-9, 9, shape).astype(kind) * -1
    found = distinct(values)
    assert found.dtype == values.dtype
    assert np.array_equal(found, np.unique(values))
