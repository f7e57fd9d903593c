"""Labels beside a picture do not overlap, and their leader lines do not cross."""

from itertools import combinations, pairwise

import numpy as np
import pytest

from stepbot.pictures.layout import Columns, LabelRequest, PlacedLabel, placed

COLUMNS = Columns(left=200.0, right=1000.0, top=20.0, bottom=880.0, pitch=25.0)


def random_labels(count: int, seed: int) -> list[LabelRequest]:
    """Labels with anchors anywhere between the columns."""
    x, y = np.random.default_rng(seed).uniform((220, 40), (980, 860), (count, 2)).T
    return [LabelRequest(f"label {i}", (float(a), float(b))) for i, (a, b) in enumerate(zip(x, y, strict=True))]


def crossing(a: PlacedLabel, b: PlacedLabel) -> bool:
    """Whether the leader lines of two labels of one column cross: both ends of each are on two sides of the other."""
    x = COLUMNS.left if a.on_left else COLUMNS.right

    def side(p: PlacedLabel, q: tuple[float, float]) -> float:
        (ax, ay), (bx, by) = (x, p.y), p.label.anchor
        return (bx - ax) * (q[1] - ay) - (by - ay) * (q[0] - ax)

    return side(a, (x, b.y)) * side(a, b.label.anchor) < 0.0 and side(b, (x, a.y)) * side(b, a.label.anchor) < 0.0


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("count", [1, 2, 7, 30, 60])
def test_labels_neither_overlap_nor_cross(count: int, seed: int) -> None:
    """Every label has a place of its own within its column; no two leader lines of a column cross."""
    found = placed(random_labels(count, seed), COLUMNS)
    assert sorted(one.label.text for one in found) == sorted(f"label {i}" for i in range(count))
    for column in (True, False):
        side = [one for one in found if one.on_left is column]
        heights = sorted(one.y for one in side)
        assert all(COLUMNS.top <= y <= COLUMNS.bottom for y in heights)
        assert all(b - a >= COLUMNS.pitch - 1e-9 for a, b in pairwise(heights))
        assert not [(a, b) for a, b in combinations(side, 2) if crossing(a, b)]


def test_a_label_with_room_is_level_with_its_anchor() -> None:
    """Leader lines are horizontal unless labels are in each other's way."""
    labels = [LabelRequest("a", (300.0, 100.0)), LabelRequest("b", (400.0, 400.0)), LabelRequest("c", (900.0, 300.0))]
    assert {one.label.text: (one.on_left, one.y) for one in placed(labels, COLUMNS)} == {
        "a": (True, 100.0),
        "b": (True, 400.0),
        "c": (False, 300.0),
    }


def test_labels_that_collide_share_the_displacement() -> None:
    """Two anchors of equal height: one label goes up, one goes down, by half the pitch."""
    found = placed(
        [LabelRequest("a", (300.0, 100.0)), LabelRequest("b", (310.0, 100.0))], Columns(200, 9000, 20, 880, 25)
    )
    assert sorted(one.y for one in found) == [87.5, 112.5]


def test_a_column_holds_as_many_labels_as_it_says() -> None:
    """With its capacity used up, labels are one pitch apart or farther; with more they would overlap."""
    found = placed(random_labels(COLUMNS.capacity, 3), COLUMNS)
    assert len(found) == COLUMNS.capacity
    assert COLUMNS.capacity == 70
