"""Triangles of parts that can meet, found for all parts together, against all triangles one by one."""

from itertools import product

import numpy as np
import pytest

from stepbot.draft.parts import scene
from stepbot.draft.stops import sweeps
from stepbot.draft.stops.sweeps import PlacedMeshes, Sides, meeting


def scattered(seed: int, parts: int, *, slides: bool) -> Sides:
    """Parts of random triangles within a cube of 1 m, of sizes that differ, those that look along the motion."""
    random = np.random.default_rng(seed)
    sizes = random.integers(1, 12, parts).tolist()
    corners = [random.uniform(-0.5, 0.5, (size, 1, 3)) + random.uniform(-0.1, 0.1, (size, 3, 3)) for size in sizes]
    faces = [np.arange(3 * size, dtype=np.int32).reshape(-1, 3) for size in sizes]
    vertices = [triangles.reshape(-1, 3) for triangles in corners]
    return PlacedMeshes(range(parts), vertices, faces, slides=slides).facing(1.0)


def overlap(low: np.ndarray, high: np.ndarray, bounds: np.ndarray) -> bool:
    """Whether bounds overlap, number by number."""
    return all(low[k] < bounds[1][k] and bounds[0][k] < high[k] for k in range(2))


@pytest.mark.parametrize("chunk", [1, 20, 1_000_000])
@pytest.mark.parametrize("slides", [False, True])
def test_triangles_near_other_parts(slides: bool, chunk: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Counts and triangles are those within the bounds of the other part, in pieces and at once."""
    monkeypatch.setattr(sweeps, "_CHUNK", chunk)
    monkeypatch.setattr(scene, "_CHUNK", chunk)
    ours, theirs = scattered(1, 7, slides=slides), scattered(2, 5, slides=slides)
    ends = [*ours.starts[1:].tolist(), len(ours.low)]
    expected = {
        (other, own): [
            k for k in range(ours.starts[own], ends[own]) if overlap(ours.low[k], ours.high[k], theirs.bounds[other])
        ]
        for other, own in product(range(len(theirs.parts)), range(len(ours.parts)))
    }
    counts = ours.counts_near(theirs)
    assert {key: int(counts[key]) for key in expected} == {key: len(rows) for key, rows in expected.items()}
    assert 0 < counts.sum() < len(theirs.parts) * len(ours.low)
    others, own = (np.array(rows) for rows in zip(*expected, strict=True))
    pairs, triangles = ours.near(own, theirs, others)
    found = [triangles[pairs == pair].tolist() for pair in range(len(expected))]
    assert found == list(expected.values())


def test_meeting_triangles_belong_to_one_pair_of_parts() -> None:
    """Of each pair of parts all pairs of triangles whose bounds overlap are found, and no other."""
    still, moving = scattered(3, 6, slides=True), scattered(4, 6, slides=True)
    s, m = np.nonzero(moving.counts_near(still) * still.counts_near(moving).T)
    near_still, near_moving = still.near(s, moving, m), moving.near(m, still, s)
    found = set(zip(*(column.tolist() for column in meeting(still, moving, near_still, near_moving)), strict=True))
    expected = {
        (pair, i, j)
        for (pair, i), (other, j) in product(
            *(zip(*map(np.ndarray.tolist, near), strict=True) for near in (near_still, near_moving))
        )
        if pair == other and overlap(still.low[i], still.high[i], np.array([moving.low[j], moving.high[j]]))
    }
    assert found == expected
    assert expected


@pytest.mark.parametrize("slides", [False, True])
def test_parts_without_triangles_that_look_along(slides: bool) -> None:
    """No parts, and parts beyond reach, give no triangles."""
    none = PlacedMeshes([], [], [], slides=slides)
    ours = PlacedMeshes([3], [np.eye(3)], [np.array([[0, 1, 2]], dtype=np.int32)], slides=slides)
    far = PlacedMeshes([4], [np.eye(3) + 5.0], [np.array([[0, 1, 2]], dtype=np.int32)], slides=slides)
    for others in (none, far):
        assert not ours.within_reach(others).facing(1.0).parts
        assert ours.facing(1.0).counts_near(others.within_reach(ours).facing(1.0)).size == 0
