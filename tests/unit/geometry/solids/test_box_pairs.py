"""Overlapping pairs of boxes, against comparing each with each."""

import numpy as np
import pytest

from stepbot.geometry.solids import box_pairs as module
from stepbot.geometry.solids.box_pairs import box_pairs, moved_boxes
from stepbot.geometry.spatial import rotation_from_rpy


@pytest.mark.parametrize("at_once", [1, 7, 1 << 18])
@pytest.mark.parametrize("depth", [0.0, 0.1])
def test_every_pair_is_found_once(depth: float, at_once: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pairs are those of comparing each with each, in order, however many are compared at once."""
    monkeypatch.setattr(module, "_AT_ONCE", at_once)
    rng = np.random.default_rng(1)
    low = rng.uniform(0, 4, (80, 3))
    high = low + rng.uniform(0, 1.5, (80, 3))
    wanted = [
        (i, j)
        for i in range(80)
        for j in range(i + 1, 80)
        if (low[i] + depth < high[j]).all() and (low[j] + depth < high[i]).all()
    ]
    assert len(wanted) > 50
    assert list(zip(*map(np.ndarray.tolist, box_pairs(low, high, depth)), strict=True)) == wanted


def test_boxes_that_touch_are_no_pair() -> None:
    """Boxes with coplanar faces do not overlap; a box and its copy do."""
    low = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0]], dtype=float)
    first, second = box_pairs(low, low + 1)
    assert (first.tolist(), second.tolist()) == ([1], [2])


def test_nothing_gives_no_pair() -> None:
    """Zero boxes, or one, have no pairs."""
    for n in (0, 1):
        assert not len(box_pairs(np.zeros((n, 3)), np.ones((n, 3)))[0])


def test_moved_boxes_are_those_of_their_corners() -> None:
    """The box around a moved box is the one around its eight corners."""
    R, p = rotation_from_rpy((0.3, -0.7, 1.9)), np.array([1.0, 2.0, 3.0])
    corners = np.array([[x, y, z] for x in (-1, 2) for y in (0, 5) for z in (3, 4)]) @ R.T + p
    low, high = moved_boxes(np.array([[-1, 0, 3]]), np.array([[2, 5, 4]]), R[None], p[None])
    np.testing.assert_allclose(low[0], corners.min(axis=0), atol=1e-12)
    np.testing.assert_allclose(high[0], corners.max(axis=0), atol=1e-12)
